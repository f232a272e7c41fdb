"""What people see of a plan: tables, curves, scenes, films, and the folder they are written to."""
