# %% [markdown]
# # Verify your own code
#
# Every code for cohesive zones begins as forty lines that run and look right. Here are such forty: one arm of a double
# cantilever beam, Euler and Bernoulli's beam in Hermite elements on bilinear springs. They know nothing of this
# package. How right are they, and would a mistake be noticed?

# %%
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from verify.curves.read import Reading
from verify.methods.solve import solve
from verify.scene import load_scene
from verify.testing import assert_curves_close

# %% [markdown]
# The two arms open alike, so that the gap is twice the deflection of one: $g = 2 w$. The arm obeys
# $E I \, w'''' = - b \, p(2 w)$ where it is bonded and is free where it is not. At the loaded end the deflection is
# prescribed, half the opening, and what that takes is the load.


# %%
@dataclass(frozen=True)
class Law:
    strength: float = 4.0
    toughness: float = 0.1
    ductility: float = 12.5

    def __call__(self, g):
        """Traction and its slope; the penalty keeps closed points closed."""
        g_u = 2 * self.toughness / self.strength
        g_max = g_u / self.ductility
        rising, falling = self.strength / g_max, self.strength / (g_max - g_u)
        parts = [g < 0, g < g_max, g < g_u]
        return np.select(parts, [1e5 * g, rising * g, falling * (g - g_u)]), np.select(parts, [1e5, rising, falling])


def my_solver(law, openings, gap_per_deflection=2.0, elements=280):
    """Load of a DCB: length 14, arms 0.2 thick, precrack 4, width 1, E = 120 GPa."""
    E, h, width, precrack, length = 120e3, 0.2, 1.0, 4.0, 14.0
    EI, L = E * width * h**3 / 12, length / elements
    bending = EI / L**3 * np.array([[12, 6 * L, -12, 6 * L], [6 * L, 4 * L**2, -6 * L, 2 * L**2],
                                    [-12, -6 * L, 12, -6 * L], [6 * L, 2 * L**2, -6 * L, 4 * L**2]])  # fmt: skip
    s, weight = (np.array([-1, 1]) / np.sqrt(3) + 1) / 2, L / 2
    H_qa = np.stack([1 - 3 * s**2 + 2 * s**3, L * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, L * (s**3 - s**2)], -1)
    dofs_ea = 2 * np.arange(elements)[:, None] + np.arange(4)
    bonded_eq = L * (np.arange(elements)[:, None] + s) > precrack
    rows, columns = (np.broadcast_to(i, (elements, 4, 4)) for i in (dofs_ea[:, :, None], dofs_ea[:, None, :]))
    w, load = np.zeros(2 * elements + 2), []
    for opening in openings:
        w[0] = opening / 2
        for _ in range(50):
            p_eq, dp_eq = law(gap_per_deflection * w[dofs_ea] @ H_qa.T)
            slope_eq = gap_per_deflection * width * weight * bonded_eq * dp_eq
            K = bending + np.einsum("eq,qa,qb->eab", slope_eq, H_qa, H_qa)
            f = w[dofs_ea] @ bending + width * weight * (bonded_eq * p_eq) @ H_qa
            force = np.bincount(dofs_ea.ravel(), f.ravel())
            if np.linalg.norm(force[1:]) <= 1e-6 * abs(force[0]):
                break
            K = coo_matrix((K.ravel(), (rows.ravel(), columns.ravel()))).tocsc()
            w[1:] -= spsolve(K[1:, 1:], force[1:])
        else:
            raise RuntimeError(f"no convergence at opening {opening:g}")
        load.append(force[0])
    return np.array(load)


openings = np.linspace(0.0, 3.0, 301)
mine = my_solver(Law(), openings)
print(f"peak {mine.max():.4f} N, end {mine[-1]:.4f} N")

# %% [markdown]
# ## Against something independent
#
# `dcb-czm1-linear` is this very problem, and `beam` a solution of it that shares no line with the code above: a beam
# that shears, with its zones followed to rounding. What is left between the two is what Euler and Bernoulli leave out,
# shear, besides the mesh. Say beforehand how close the curves ought to be, then ask.

# %%
expected = solve(load_scene("dcb-czm1-linear"), "beam")
assert_curves_close((openings, mine), expected, curve=0.002, peak=0.002, energy=0.002)
print("within 0.2 % of the cohesive beam: curve, peak and work")

# %% [markdown]
# ## Would it notice?
#
# A check that nothing can fail checks nothing. Two mistakes, one coarse and one fine: the gap taken as the deflection
# of one arm, so that every piece of crack is paid for twice; and an initial slope of the law that is too soft, as if
# the ductility were 2. Neither stops the run, and neither curve looks wrong by itself.

# %%
mistakes = {
    "gap of one arm only": my_solver(Law(), openings, gap_per_deflection=1.0),
    "initial slope too soft": my_solver(Law(ductility=2.0), openings),
}
for name, load in mistakes.items():
    try:
        assert_curves_close((openings, load), expected, curve=0.002, peak=0.002, energy=0.002)
    except AssertionError as error:
        print(f"{name}: {str(error).splitlines()[0]}")
    else:
        raise RuntimeError(f"{name} was not noticed")

figure, axes = plt.subplots(figsize=(7, 3.6), constrained_layout=True)
axes.plot(expected.opening, expected.load, color="#00916a", linewidth=5, alpha=0.35, label="cohesive beam")
axes.plot(openings, mine, color="#1b2330", linewidth=1.2, label="my code")
for name, load in mistakes.items():
    axes.plot(openings, load, "--", linewidth=1.2, label=name)
axes.set(xlabel="opening (mm)", ylabel="load (N)", xlim=(0, 3), ylim=(0, None))
axes.legend(frameon=False, fontsize=8)
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)

# %% [markdown]
# ## A file from somewhere else
#
# Other people's curves come as files: half the opening, moving down, in kilonewtons, under names of their own. A
# `Reading` says which column is what and how it is scaled; `./debond compare` takes the same from the command line.
# In `examples/regression_test` the comparison is a test that pytest finds.

# %%
table = {"U2": -openings / 2, "RF2": -mine / 1000}
lower_face = Reading(opening="U2", load="RF2", opening_scale=-2, load_scale=-1e3)
assert_curves_close(table, (openings, mine), actual_as=lower_face, curve=1e-9)

# %% [markdown]
# ## What is left is physics
#
# If the rest is shear, it cannot go away with the mesh. It does not: twice as many elements move the peak far
# less than what separates it from the beam that shears.

# %%
finer = my_solver(Law(), np.linspace(0.0, 1.0, 101), elements=560)
by_mesh = abs(mine.max() / finer.max() - 1)
by_shear = mine.max() / expected.load.max() - 1
print(f"the mesh is worth {by_mesh:.3%} of the peak, the shear {by_shear:.3%}")
assert by_mesh < 0.2 * by_shear < 0.002
