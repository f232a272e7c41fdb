"""What people see of a plan: tables, Figs. 8 to 10 of the paper, films, and their folder."""
