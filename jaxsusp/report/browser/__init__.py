"""A page that shows scenes and plans in motion: one HTML file that needs nothing else."""
