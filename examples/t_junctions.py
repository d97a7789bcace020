# %% [markdown]
# # What T-junctions buy
#
# The same specimen on meshes of 280 unknowns: T-splines, NURBS and Lagrange elements. All meshes follow one rule along
# the specimen, with short elements where the crack will run. Only T-splines can halve those elements at the bond and
# nowhere else, and only they can follow the crack. Run it with `./debond exec python examples/t_junctions.py`.

# %%
from pathlib import Path

import matplotlib.pyplot as plt

from verify.curves.curve import curve_error
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.solve import solve
from verify.scene import load_scene

few = load_scene("dcb-czm1", ["discretization.dofs=280"])
moving = load_scene("dcb-czm1", ["discretization.dofs=700", "discretization.adaptive=true"])
results = {method: solve(few, method) for method in ("tspline", "nurbs", "lagrange")}
results["adaptive"] = solve(moving, "tspline")

# %% [markdown]
# A fine independent solution is the reference: DOLFINx where it is installed, and else the beam on a cohesive
# interface. They are within 0.1 % of each other.

# %%
reference = solve(load_scene("dcb-czm1"), "dolfinx" if dolfinx_installed() else "beam")
error = {
    name: curve_error((result.opening, result.load), (reference.opening, reference.load), few.load.opening[-1])
    for name, result in results.items()
}
for name, result in results.items():
    print(f"{name:9} {result.dofs:4} unknowns, {error[name]:.2%} from {reference.method}")

# %% [markdown]
# With as many unknowns the T-spline is the closest, but not by much: the arms are thin and bend, which takes whole
# columns of functions, and a T-junction adds a function to the row at the bond alone. A mesh that follows the process
# zone does far better: it needs short elements over about two process zones and not over the whole path.
#
# The curves, and beside them the meshes: lines of the T-mesh, T-junctions (dots), the sides of Bezier elements that the
# T-junctions extend to (thin), and the process zone. The specimen is drawn about three times too thick.

# %%
style = {"tspline": ("T-spline", "#7a3fc0", 1.8), "nurbs": ("NURBS", "#0072b2", 1.2),
         "lagrange": ("Lagrange", "#d55e00", 0.9), "adaptive": ("adaptive T-spline", "#1b2330", 1.2)}  # fmt: skip
figure = plt.figure(figsize=(11, 4.2), constrained_layout=True)
left, right = figure.subfigures(1, 2, width_ratios=(1, 1.35))
axes = left.subplots()
name = {"dolfinx": "DOLFINx", "beam": "cohesive beam"}[reference.method]
axes.plot(reference.opening, reference.load, color="#00916a", linewidth=5, alpha=0.35, label=f"{name}, fine")
for method in ("lagrange", "nurbs", "tspline", "adaptive"):
    result, (name, colour, width) = results[method], style[method]
    label = f"{name}, {result.dofs} unknowns: {100 * error[method]:.2f} % off"
    dashes = "--" if method == "adaptive" else "-"
    axes.plot(result.opening, result.load, dashes, color=colour, linewidth=width, label=label)
axes.set(xlabel="opening (mm)", ylabel="load (N)", xlim=(0, 3), ylim=(0, None))
axes.legend(frameon=False, fontsize=8, loc="lower right")

shown = [("tspline", results["tspline"].snapshots[-1])] + [("adaptive", s) for s in results["adaptive"].snapshots[1:]]
for axes, (method, at) in zip(right.subplots(len(shown), sharex=True), shown, strict=True):
    X, damage = at.X_euvi, at.damage_q
    for element in X:
        axes.plot(*element[[0, -1, -1, 0, 0], [0, 0, -1, -1, 0]].T, color="#7a3fc0", linewidth=0.4)
    axes.plot(*at.line_nki.transpose(2, 1, 0), color="#1b2330", linewidth=0.7)
    axes.plot(*at.junction_ni.T, "o", color="#b3261e", markersize=3)
    zone = at.s_q[(damage > 0) & (damage < 1)]
    axes.fill_between([zone.min(), zone.max()], -0.2, 0.2, color="#e6b400", alpha=0.6, linewidth=0)
    axes.set(ylim=(-0.25, 0.25), yticks=[])
    counts = f"{len(X)} elements, {len(at.junction_ni)} T-junctions"
    axes.set_title(f"{style[method][0]}, opening {at.opening:.1f} mm: {counts}", fontsize=8)
    axes.spines[["left", "right", "top"]].set_visible(False)
axes.set(xlabel="position along the specimen (mm)")
picture = Path(__file__).with_suffix(".png")
figure.savefig(picture, dpi=110)
print(f"picture: {picture.name}")

# %% [markdown]
# In numbers: the mesh that moves is the only one here whose curve can be used, and the order of the others is the one
# that their shortest elements promise.

# %%
assert error["tspline"] < 0.8 * error["nurbs"] < 0.2 * error["lagrange"]
assert error["adaptive"] < 0.001
