"""Isogeometric solver for debonding interfaces; needs NumPy and SciPy only."""
