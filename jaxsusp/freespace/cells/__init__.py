"""The workspace in cells: what is forbidden or clear as a whole, and how narrow it gets."""
