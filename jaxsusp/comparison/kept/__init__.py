"""Comparisons on disk: what is finished of one, all of it, the many files of a long study."""
