"""What a person chooses from; light to import, so that a mistyped choice is answered at once."""

BUDGETS = ("iterations", "evaluations", "time")
"""What all algorithms of a comparison get equally much of."""

FILE, PARTS = "compare.nc", "compare.parts"
"""In the folder of a comparison: all of it, and what is finished of one that is not complete."""
