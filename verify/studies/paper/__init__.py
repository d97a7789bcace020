"""Figures 6 to 9 of the paper: their runs, the measures of these, and whether the statements of the paper hold.

R. Dimitri, L. De Lorenzis, G. Zavarise, A T-spline-based approach for interface debonding using cohesive zone models,
AIMETA 2013. Figures 6 to 8: a double cantilever beam with two laws, two meshes, three bases, and 2 to 8 points
per element. Figure 9: a strip peeled off a substrate with four bond lengths, by three bases with equal unknowns.
"""
