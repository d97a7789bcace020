"""Rounding and noise of a curve, the curve without them, and its farthest point."""
