"""COCO's suite bbob, 24 functions without any suspension: an outside measure of the optimisers."""
