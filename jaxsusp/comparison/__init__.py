"""Sect. 4.2: algorithms compared in one call, computed in units, kept on disk, and resumed."""
