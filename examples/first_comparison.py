# %% [markdown]
# # One specimen, four solutions
#
# A double cantilever beam is opened by 3 mm. An isogeometric solver, DOLFINx (where it is installed), a beam on a
# cohesive interface and linear elastic fracture mechanics solve it without sharing a line of code. Run it with
# `./debond exec python examples/first_comparison.py`.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import verify
from verify.methods.dolfinx import dolfinx_installed

scene = verify.load_scene("dcb-czm1")
methods = ["nurbs", "beam", "lefm"] + ["dolfinx"] * dolfinx_installed()
results = {method: verify.solve(scene, method) for method in methods}

# %% [markdown]
# How far are the load-opening curves apart? The beam is a theory of its own, not a mesh: what is left between it and
# the spline solution is the error of both. LEFM is another model, the limit of an infinitely strong interface, so the
# distance to it is no error at all.

# %%
nurbs, beam = results["nurbs"], results["beam"]
distance = verify.compare(nurbs, beam).curve_error
print(f"NURBS against the beam: {distance:.3%} of the load over the whole curve")

# %% [markdown]
# The deformed arms, coloured by the bending stress, and the curves.

# %%
style = {"nurbs": ("NURBS", "#0072b2", "-"), "dolfinx": ("DOLFINx", "#009e73", "--"),
         "beam": ("cohesive beam", "#cc79a7", ":"), "lefm": ("LEFM limit", "#999999", "--")}  # fmt: skip
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 3.6), width_ratios=(1, 1.5), constrained_layout=True)
for method, result in results.items():
    label, colour, line = style[method]
    width = 1.0 if method == "lefm" else 2.0
    left.plot(result.opening, result.load, line, color=colour, linewidth=width, label=label)
left.set(xlabel="opening (mm)", ylabel="load (N)", xlim=(0, 3), ylim=(0, None))
left.legend(frameon=False)

last = nurbs.snapshots[-1]
x = last.X_euvi + last.u_euvi
limit = np.abs(last.stress_euv).max()
for grid, stress in zip(x, last.stress_euv, strict=True):
    shade = right.pcolormesh(*grid.T, stress.T, cmap="RdBu_r", vmin=-limit, vmax=limit, shading="gouraud")
right.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal", title=f"opening {last.opening:.3g} mm")
figure.colorbar(shade, ax=right, label="stress along the arm (MPa)", orientation="horizontal", shrink=0.7)
picture = Path(__file__).with_suffix(".png")
figure.savefig(picture, dpi=110)
print(f"picture: {picture.name}")

# %% [markdown]
# Two theories and two programs, one curve: that is what the rest of this package does for every scene and every pair of
# methods. What it would take to be wrong by more is that both make the same mistake.

# %%
assert distance < 0.002
