"""What a person chooses from; light to import, so that a mistyped choice is answered at once."""

ENDS = ("given", "placed")
"""Whether the cables' ends are the scenario's (moved by the plain rule of its drive mode where they
move), or chosen by the planner."""

TAUT = "taut"
"""The algorithm that searches nothing: rounded taut ways, as they are."""

COORDINATIONS = ("alternation", "joint")
"""How ends that stay are placed with the load."""

SHORTEST = "shortest"
"""The duration of a motion that is as fast as its limits allow; beside a number of seconds."""

AHEAD = "jaxsusp compiles ahead"
"""The name of the thread that does while other work is done; who leaves does not wait for it."""
