"""What people see of a comparison: Table 1 and Figs. 8 to 11 of the paper, and statistics."""
