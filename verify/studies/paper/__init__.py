"""Figures 6 to 9 of the paper: which runs they need, what came of them, and which of its statements hold.

R. Dimitri, L. De Lorenzis, G. Zavarise, A T-spline-based approach for interface debonding using cohesive zone models,
AIMETA 2013. Figures 6 to 8: a double cantilever beam with two laws on two meshes, by three bases, with 2 to 8 points an
element. Figure 9: a strip peeled off a substrate with four bond lengths, by three bases with equal unknowns.
"""
