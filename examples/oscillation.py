# %% [markdown]
# # Why C0 oscillates and C2 does not
#
# Two meshes of cubic polynomials with the same number of unknowns. In one, Lagrange elements, the functions are merely
# continuous from element to element; in the other, NURBS, so are their first two derivatives. On a coarse mesh one
# load curve wriggles three times as much as the other. Is it the smoothness? Count before you believe.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from verify.curves.curve import load_at, oscillation, peak
from verify.methods.mesh_choice import spline_mesh
from verify.methods.solve import solve
from verify.methods.zone_resolution import element_length, expected
from verify.scene import load_scene

coarse = load_scene("dcb-czm2", ["discretization.dofs=280"])
runs = {method: solve(coarse, method) for method in ("nurbs", "lagrange")}
beam = solve(coarse, "beam")
exact = beam.opening, beam.load

# %% [markdown]
# ## What the same unknowns buy
#
# In one direction a cubic spline with simple knots costs one function an element and three more at the end: its
# smoothness has used up all the others. A cubic Lagrange element costs three. Equal unknowns are therefore three times
# as many elements for the spline, and it is elements that must fit into the process zone.

# %%
for method, run in runs.items():
    length, zone = element_length(coarse, method), expected(coarse, method)
    print(
        f"{method:9} {run.dofs} unknowns, elements of {length:.2f} mm at the bond, {zone.elements:.1f} in the zone; "
        f"oscillation {oscillation((run.opening, run.load), exact)['rms']:.1%}"
    )

# %% [markdown]
# ## Where the waves come from
#
# Divide the load by the smooth one of the cohesive beam and plot it over the crack length. There are waves, and they
# can be counted. A point of the integration rule holds until its own gap has gone through the whole law; then it lets
# go, and it is the next point's turn. One point, one wave: on the splines there are as many maxima as points, two an
# element. The Lagrange elements are so long that the two points of one go almost together, which makes one deep wave an
# element, with a shoulder.


# %%
def waves(run):
    """Crack length and load over the exact load while the crack grows, and how many maxima that has."""
    grows = (run.opening > 1.3 * peak(exact)[0]) & (np.diff(run.steps["crack_length"], prepend=0.0) > 0.0)
    crack = run.steps["crack_length"][grows]
    ratio = run.load[grows] / load_at(exact, run.opening[grows])
    inner = ratio[1:-1]
    return crack, ratio, int(np.sum((inner > ratio[:-2]) & (inner >= ratio[2:])))


points = spline_mesh(coarse).points
for method, run in runs.items():
    crack, _, maxima = waves(run)
    passed = (crack[-1] - crack[0]) / element_length(coarse, method)
    print(f"{method:9} the crack passes {passed * points:.1f} points in {passed:.1f} elements: {maxima} maxima")

# %% [markdown]
# ## Smoothness or length?
#
# Now take the length away as a reason: Lagrange elements as short as those of the splines, for which they need two and
# a half times the unknowns. If C0 were to blame, they would go on oscillating as before.

# %%
shorter = load_scene("dcb-czm2", ["discretization.dofs=720"])
runs["lagrange, as short"] = solve(shorter, "lagrange")
wiggle = {name: oscillation((run.opening, run.load), exact)["rms"] for name, run in runs.items()}
print(f"elements of {element_length(shorter, 'lagrange'):.2f} mm: oscillation {wiggle['lagrange, as short']:.1%}")

# %% [markdown]
# And take the points away: six instead of two in every element of the coarse meshes.

# %%
for method in ("nurbs", "lagrange"):
    many = solve(load_scene("dcb-czm2", ["discretization.dofs=280", "discretization.interface_points=6"]), method)
    wiggle[f"{method}, 6 points"] = oscillation((many.opening, many.load), exact)["rms"]
    print(f"{method:9} with 6 points an element: oscillation {wiggle[f'{method}, 6 points']:.1%}")

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), constrained_layout=True)
left.plot(*exact, color="#00916a", linewidth=5, alpha=0.35, label="cohesive beam")
colours = {"lagrange": "#d55e00", "nurbs": "#0072b2", "lagrange, as short": "#1b2330"}
for name, colour in colours.items():
    run = runs[name]
    left.plot(run.opening, run.load, color=colour, linewidth=1, label=f"{name}, {run.dofs} unknowns")
    crack, ratio, _ = waves(run)
    right.plot(crack, ratio, color=colour, linewidth=1)
left.set(xlabel="opening (mm)", ylabel="load (N)", xlim=(0, 3), ylim=(0, None))
left.legend(frameon=False, fontsize=8)
right.set(xlabel="crack length (mm)", ylabel="load / exact load")
figure.savefig(Path(globals().get("__file__", "oscillation.py")).with_suffix(".png"), dpi=110)

# %% [markdown]
# So the title is true of equal unknowns and wrong about the reason. With elements of one length C0 and C2 oscillate
# alike; what smoothness does is to make short elements cheap. And before anybody buys a finer mesh: more points in the
# elements that are there already take most of the oscillation away, of either basis, for next to nothing.

# %%
per_element, per_unknown = (wiggle[name] / wiggle["nurbs"] for name in ("lagrange, as short", "lagrange"))
print(f"Lagrange over NURBS: {per_unknown:.1f} at equal unknowns, {per_element:.1f} at equal elements")
assert per_unknown > 2.0 and 0.7 < per_element < 1.3
