"""Sect. 2: arms (Eq. 1), cables (2, 3), statics (4-7) and the stability factor (18)."""
