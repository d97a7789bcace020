# %% [markdown]
# # The J-integral as a check
#
# How does one check a code where no solution is known? By what must hold of any solution. The J-integral of Rice (1968)
# is the energy that flows towards the crack tip. Taken around the outside of the specimen it needs nothing but the load
# and the slopes of the loaded ends; taken along the interface it is the area under the traction law. Both must be the
# same number, at every step, whatever the shape of the law and however long the process zone.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from verify.checks.mechanics.columns import law_of, loading
from verify.checks.mechanics.j_integral import j_deviation
from verify.methods.solve import solve
from verify.scene import load_scene

scene = load_scene("dcb-czm1", ["discretization.dofs=1120"])
steps = solve(scene, "nurbs").steps
width, G_c = scene.specimen.width, scene.interface.toughness

# %% [markdown]
# ## From the outside
#
# The only parts of the boundary that contribute are the two loaded faces. With the mean slope $s = du_y/dX$ of each,
# the load $P$, and the strain energy density $W$ on the faces:
#
# $$ J = \frac{P}{b} \bigl( |s_1| + |s_2| \bigr) - \sum_{\mathrm{faces}} \int W \, dY . $$
#
# ## From the inside
#
# Along the interface $J$ is the work of the tractions up to the gap $g_{\mathrm{tip}}$ at the end of the precrack:
#
# $$ J = \int_0^{g_{\mathrm{tip}}} p(g) \, dg , $$
#
# and once that gap is beyond $g_u$ the area is all there is: $J = G_{\mathrm{Ic}}$, while the crack grows, for ever.


# %%
def outside(steps):
    return (
        steps["load"] * (abs(steps["face_slope_top"]) + abs(steps["face_slope_bottom"])) / width - steps["face_energy"]
    )


def inside(steps, law):
    return law.area(steps["tip_opening"])


law = law_of(scene)
growing = steps["tip_opening"] > law.g_open
J = outside(steps)
print(f"J / G_Ic while the crack grows: {J[growing].min() / G_c:.4f} to {J[growing].max() / G_c:.4f}")
print(f"worst |inside - outside| / G_Ic of all {J.size} steps: {np.abs(J - inside(steps, law)).max() / G_c:.2%}")

# %% [markdown]
# It even holds before anything cracks, while the law is climbed and descended: that is why it catches a wrong law, a
# wrong quadrature and a wrong load alike.
#
# ## What breaks it
#
# *A formula for small rotations.* The slope that counts is $du_y/dX$, the sine of the rotation for an arm that does not
# stretch, not the angle itself. Nor can the crack length be measured and put into beam theory: $J = P^2 a^2 / (b E I)$
# has no place for the compliance of the process zone.

# %%
E, h = scene.material.young, scene.specimen.arm_thickness
EI = E * width * h**3 / 12
angle = np.arcsin(abs(steps["face_slope_top"]))
formulas = {
    "outside (exact)": J,
    "2 P angle": 2 * steps["load"] * angle / width,
    "P^2 a^2 / b E I": (steps["load"] * steps["crack_length"]) ** 2 / (width * EI),
}
for name, value in formulas.items():
    print(f"{name:16} at the end of the run: {value[-1] / G_c - 1:+.2%}")

# %% [markdown]
# *Unloading.* The area under the law is what loading costs. A point that unloads follows its secant, not the law, and
# $J$ loses its meaning there, not by rounding but by a lot. When the crack goes on it is back.

# %%
programme = load_scene("dcb-czm1", ["discretization.dofs=1120", "load.opening=[1.5, 0.8, 2.2]"])
there_and_back = solve(programme, "nurbs").steps
up = loading(there_and_back)
off = np.abs(outside(there_and_back) - inside(there_and_back, law)) / G_c
print(f"loading: at most {off[up].max():.2%} off; unloading and reloading: up to {off[~up].max():.0%}")

# %% [markdown]
# *A mesh that is too coarse.* The law is obeyed at the integration points only. Between them, with one or two
# elements in the zone, the tractions are whatever the polynomials make of them, and $J$ shows it.

# %%
coarse = load_scene("dcb-czm1", ["discretization.dofs=280"])
meshes = {f"{method}, {s.discretization.dofs} unknowns": (s, solve(s, method).steps)
          for method in ("nurbs", "lagrange") for s in (coarse, scene)}  # fmt: skip
for name, (s, of_mesh) in meshes.items():
    print(f"{name:24} {j_deviation(s, of_mesh):.2%}")

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), constrained_layout=True)
left.plot(
    steps["opening"], inside(steps, law) / G_c, color="#00916a", linewidth=5, alpha=0.35, label="area under the law"
)
for (name, value), line in zip(formulas.items(), ("-", "--", ":"), strict=True):
    left.plot(steps["opening"], value / G_c, line, color="#1b2330", linewidth=1.2, label=name)
left.set(xlabel="opening (mm)", ylabel="J / G_Ic", ylim=(0, 1.2), title="which J")
left.legend(frameon=False, fontsize=8)
for name, (_, of_mesh) in meshes.items():
    right.plot(of_mesh["opening"], (outside(of_mesh) - inside(of_mesh, law)) / G_c, linewidth=1, label=name)
right.set(xlabel="opening (mm)", ylabel="(outside - inside) / G_Ic", title="which mesh")
right.legend(frameon=False, fontsize=8)
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)

# %% [markdown]
# So $J$ is a check that any code can make of itself without a reference, in one line. Its tolerance is a matter of the
# mesh, and what is a matter of neither mesh nor code, the two wrong formulas, stands out.

# %%
deviation = j_deviation(scene, steps)
assert deviation < 0.005 < abs(formulas["2 P angle"][-1] / G_c - 1)
