"""Beyond the six scenarios: fresh scenes, so that nothing is tuned to known ones."""
