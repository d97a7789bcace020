# %% [markdown]
# # The solver in a notebook
#
# `iga` alone: numbers in, arrays out. A double cantilever beam is opened on meshes of three bases, its load compared
# with a closed form, and the traction in the bond with its law. Every cell of this page is one of a notebook.

# %%
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import iga

beam = iga.Dcb(
    length=14.0, arm_thickness=0.2, precrack=4.0, E1=120e3, nu12=0.2,  # mm, MPa
    strength=4.0, toughness=0.1, opening=2.0, kinematics="linear", dofs=1120, snapshot_openings=(1.0,),
)  # fmt: skip
runs = {basis: iga.solve(replace(beam, basis=basis)) for basis in iga.BASES}
for basis, run in runs.items():
    print(f"{basis}: {run}")

# %% [markdown]
# ## Against a closed form
#
# Each arm of thickness $h$ and width $b$ is a cantilever as long as the crack, $a$. While the crack grows, the energy
# that it sets free is the toughness:
#
# $$ G_{\mathrm{Ic}} = \frac{12 P^2 a^2}{b^2 E h^3} , \qquad \delta = \frac{8 P a^3}{b E h^3} . $$
#
# The length of the crack drops out of both together, and with it the compliance of the cantilevers' roots:
#
# $$ P = b \sqrt{\frac{8 c^3}{E h^3 \delta}} , \qquad c = \sqrt{\frac{G_{\mathrm{Ic}} E h^3}{12}} . $$

# %%
E, h, G_c, b = beam.E1, beam.arm_thickness, beam.toughness, beam.width
c = np.sqrt(G_c * E * h**3 / 12.0)


def growing(opening):
    """Load while the crack grows."""
    return b * np.sqrt(8.0 * c**3 / (E * h**3 * opening))


off = {}
for basis, run in runs.items():
    crack = run.steps["crack_length"]
    grows = crack > beam.precrack + 5 * h  # the process zone has formed
    off[basis] = np.max(np.abs(run.load[grows] / growing(run.opening[grows]) - 1.0))
    print(f"{basis}: at most {off[basis]:.2%} off from a crack of {crack[grows][0]:.1f} mm on")

# %% [markdown]
# ## In the bond
#
# A snapshot has the fields of one opening: gap, traction and damage along the bond, and stress on a grid of points in
# every element. The traction climbs to the strength and falls to zero over the process zone; its area under the law is
# the toughness.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.4), constrained_layout=True)
opening = np.linspace(0.4, 2.0, 100)
for (basis, run), line in zip(runs.items(), ("-", "--", ":"), strict=True):
    left.plot(run.opening, run.load, line, label=basis)
left.plot(opening, growing(opening), color="#999999", linewidth=4, alpha=0.5, label="closed form", zorder=0)
left.set(xlabel="opening (mm)", ylabel="load (N)", xlim=(0, 2), ylim=(0, None))
left.legend(frameon=False)

field = runs["nurbs"].snapshots[0]
gap = np.linspace(0.0, 1.2 * beam.law.g_u, 200)
right.plot(gap, beam.law.envelope(gap), color="#999999", linewidth=4, alpha=0.5, label="traction law")
seen = (field.gap_q > 0.0) & (field.gap_q < gap[-1])
right.plot(field.gap_q[seen], field.traction_q[seen], "o", markersize=3, label=f"bond at {field.opening:.1f} mm")
right.set(xlabel="gap (mm)", ylabel="traction (MPa)")
right.legend(frameon=False)
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)

# %% [markdown]
# Splines keep to the closed form. What is left of it is shear, which beam theory leaves out, and the mesh.

# %%
assert off["nurbs"] < 0.01 and off["tspline"] < 0.01
