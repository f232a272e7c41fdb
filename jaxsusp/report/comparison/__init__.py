"""What people see of a comparison: Table 1, Figs. 7, 11 and 12 of the paper, and statistics."""
