"""Fig. 2, step 5: finished plans checked by other means than the fitness."""
