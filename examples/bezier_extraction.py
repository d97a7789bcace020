# %% [markdown]
# # Bezier extraction by hand
#
# A spline function lives on several elements at once, and a finite element program would rather look at one element at
# a time. Bezier extraction is the bridge: on every single element the splines are combinations of the same few
# Bernstein polynomials, and a small matrix, the extraction operator $C^e$, says which:
#
# $$ N_a(\xi) = \sum_b C^e_{ab} \, B_b(\xi) . $$
#
# Once the matrices are there, B-splines, NURBS, T-splines and even Lagrange elements look the same to whatever comes
# later. This page makes $C^e$ with nothing but knot insertion and holds it against the solver's own.

# %%
from math import comb
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.interpolate import BSpline

from iga.bases.bspline import KnotVector, bezier_extraction
from iga.bases.lagrange import lagrange_extraction

p = 3
knots = np.array([0, 0, 0, 0, 1, 2, 3.5, 4, 4, 4, 4], dtype=float)
n = len(knots) - p - 1
print(f"degree {p}, {n} functions, elements between {np.unique(knots)}")

# %% [markdown]
# ## One knot more
#
# Inserting a knot $x$ changes nothing about a curve, but gives it one control point more. The new points lie on the
# sides of the old control polygon (Boehm 1980): with $x$ in the span $[t_k, t_{k+1})$
#
# $$ \bar P_i = \alpha_i P_i + (1 - \alpha_i) P_{i-1}, \qquad
# \alpha_i = \min \Bigl( 1, \max \bigl( 0, \frac{x - t_i}{t_{i+p} - t_i} \bigr) \Bigr) . $$
#
# As a matrix: $\bar P = T P$, two numbers a row, and every row adds up to one.


# %%
def insert(knots, x):
    """The longer knot vector, and T with new points = T @ old points."""
    n = len(knots) - p - 1
    T = np.zeros((n + 1, n))
    for i in range(n + 1):
        if i + p < len(knots) and knots[i + p] <= x:
            alpha = 1.0  # the function ends before x: its point stays
        elif knots[i] >= x:
            alpha = 0.0  # it begins after x: its point moves up by one
        else:
            alpha = (x - knots[i]) / (knots[i + p] - knots[i])
        if alpha > 0.0:
            T[i, i] = alpha
        if alpha < 1.0:
            T[i, i - 1] = 1.0 - alpha
    return np.sort(np.append(knots, x)), T


_, T = insert(knots, 1.5)
print(np.array_str(T, precision=3, suppress_small=True))

# %% [markdown]
# ## Until the elements come apart
#
# A knot that is there $p$ times is a place where the control polygon touches the curve: left and right of it nothing
# but the point itself is shared. With every inner knot inserted up to multiplicity $p$ each element has $p + 1$ control
# points of its own, and the functions that belong to them are the Bernstein polynomials. The product of all the $T$
# gives these Bezier points from the spline's, $Q = T P$. The curve is the same, so the functions go the other way,
# $N = T^\mathsf{T} B$, and the columns of $T^\mathsf{T}$ that belong to one element are its extraction operator.

# %%
fine, T = knots, np.eye(n)
for x in np.unique(knots)[1:-1]:
    while np.sum(fine == x) < p:
        fine, step = insert(fine, x)
        T = step @ T
print(f"{len(fine) - p - 1} Bezier points from {n} control points")

element = 1
C = T.T[element : element + p + 1, element * p : element * p + p + 1]
print("C of the second element:")
print(np.array_str(C, precision=4, suppress_small=True))


# %% [markdown]
# Read by columns: each adds up to one, because splines and Bernstein polynomials both do. Read by rows: the first one
# is the function that dies out on this element, the last one the function that is only just born there. In the picture
# the lines are combinations of Bernstein polynomials; the circles are SciPy's values by the recursion of Cox and de
# Boor, which knows nothing of extraction.
# %%
def bernstein(s):
    return np.stack([comb(p, b) * s**b * (1 - s) ** (p - b) for b in range(p + 1)], -1)


x0, x1 = np.unique(knots)[element : element + 2]
s = np.linspace(0.0, 1.0, 41)
combined = bernstein(s) @ C.T
direct = BSpline.design_matrix(x0 + s * (x1 - x0), knots, p).toarray()[:, element : element + p + 1]
print(f"largest difference on the element: {np.abs(combined - direct).max():.1e}")

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.2), width_ratios=(1.6, 1), constrained_layout=True)
x = np.linspace(knots[0], knots[-1], 401)
left.plot(x, BSpline.design_matrix(x, knots, p).toarray(), color="#9aa4b2", linewidth=1)
left.axvspan(x0, x1, color="#0072b2", alpha=0.08, linewidth=0)
left.set_prop_cycle(None)
left.plot(x0 + s * (x1 - x0), combined, linewidth=2.2)
left.set_prop_cycle(None)
left.plot(x0 + s[::5] * (x1 - x0), direct[::5], "o", fillstyle="none", markersize=5)
left.set(xlabel="parameter", title="all B-splines, the four of one element")
right.plot(s, bernstein(s), linewidth=2.2)
right.set(xlabel="within the element", title="the same Bernstein polynomials on each")
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)

# %% [markdown]
# ## The solver's own, and one of another kind
#
# `iga.bases.bspline.bezier_extraction` makes all operators at once without inserting anything, as values of the
# splines' polar forms. Both ways must come to the same numbers. Lagrange elements pass through the same seam: their
# operator is one and the same for all elements, the inverse of the Bernstein polynomials at the nodes. In the solver
# nothing that comes after this point knows which of the bases it is working with.

# %%
elements = len(np.unique(knots)) - 1
by_hand = np.stack([T.T[e : e + p + 1, e * p : e * p + p + 1] for e in range(elements)])
nodes = np.linspace(0.0, 1.0, p + 1)
nodal = lagrange_extraction(p) @ bernstein(nodes).T
difference = np.abs(by_hand - bezier_extraction(KnotVector(p, knots))).max()
print(f"by hand against iga: {difference:.1e}; Lagrange functions at their nodes:\n{nodal.round(12)}")
assert np.abs(nodal - np.eye(p + 1)).max() < 1e-12
assert difference < 1e-14
