"""Data reduction of delamination tests: a curve, crack lengths and a specimen in, toughness with its interval out."""
