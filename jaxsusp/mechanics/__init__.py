"""Sect. 2: arms (Eq. 1), statics (4-7), the stability factor (18), and the four drive modes."""
