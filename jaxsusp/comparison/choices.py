"""What a person chooses from; light to import, so that a mistyped choice is answered at once."""

BUDGETS = ("iterations", "evaluations", "time")
"""What all algorithms of a comparison get equally much of."""

FILE, PARTS = "compare.nc", "compare.parts"
"""In the folder of a comparison: all of it, and what is finished of one that is not complete."""

MANIFEST = "compare.json"
"""In the folder of a long study, whose parts stay where they are: the list of them."""

LONG = 1000
"""Runs above which a comparison is a long study."""

CHUNK, CHUNKS = 250, 200
"""Runs that are computed at a time, at least; and in how many chunks, at most, where nothing else
is asked for."""

CURVE = 51
"""Iterations that are kept of every history of a long study."""
