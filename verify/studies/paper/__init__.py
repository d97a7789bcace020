"""Figures 6, 7 and 8 of the paper: which runs they need, what came of them, and which of its statements hold.

R. Dimitri, L. De Lorenzis, G. Zavarise, A T-spline-based approach for interface debonding using cohesive zone models,
AIMETA 2013: a double cantilever beam with two laws on two meshes, by three bases, with 2 to 8 points an element.
"""
