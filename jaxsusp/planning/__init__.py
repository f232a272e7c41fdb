"""Fig. 2: from a task to a verified plan, and plans on disk.

`planner` is the figure's loop, `steps` its five steps; `through` lays waypoints on a real curve and
checks it, `plan` is what comes of it, and `verification` looks at a finished one anew.
"""
