# %% [markdown]
# # The process zone, and when a mesh is too coarse
#
# A cohesive law needs room. Between the place where the bond has reached its strength and the place where it has let
# go altogether lies the process zone, and its length is the most important number of a cohesive model: elements longer
# than that cannot see what happens in it.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from verify.curves.curve import oscillation, peak
from verify.methods.solve import prepare, solve
from verify.methods.zone_resolution import ENOUGH, element_length, expected, measured, warnings
from verify.scene import load_scene
from verify.scene.process_zone import bulk_length, slender_length

# %% [markdown]
# ## How long it is
#
# Modulus, toughness and strength make one length (Hillerborg, Modeer, Petersson 1976):
#
# $$ l_b = \frac{E' G_{\mathrm{Ic}}}{p_{\max}^2} . $$
#
# It is meant for a body that is large. An arm that is thin bends out of the way first, and its thickness $h$ comes in
# (Williams and Hadavinia 2002; Yang and Cox 2005):
#
# $$ l_s = M \, \Bigl( \frac{E' G_{\mathrm{Ic}}}{p_{\max}^2} \Bigr)^{1/4} h^{3/4} , \qquad M \approx 1 . $$
#
# A real arm yields in both ways, so that its zone is shorter than either; this package takes
# $1/l = 1/l_b + 1/l_s$, a choice that comes to both limits. By how much Hillerborg's length misleads here:

# %%
for name in ("dcb-czm1-linear", "dcb-czm2-linear"):
    scene = load_scene(name)
    zone = measured(solve(scene, "beam"))
    print(
        f"{name}: bulk {bulk_length(scene):.0f} mm, thin arm {slender_length(scene):.2f} mm, "
        f"both {expected(scene, 'nurbs').length:.2f} mm, measured on the cohesive beam {zone:.2f} mm"
    )

# %% [markdown]
# With 750 mm in mind one would have meshed this specimen, 14 mm long, with a handful of elements. The right number is
# under a millimetre.
#
# ## One mesh, ever stronger interfaces
#
# Now leave the mesh alone, 700 unknowns, and make the interface stronger. The toughness stays, so the same energy is
# needed for the same crack; only the zone shrinks, as $p_{\max}^{-1/2}$. The cohesive beam needs no mesh and says what
# the answer should be.

# %%
strengths = (3.0, 4.0, 7.0, 18.0, 32.0)
elements, too_high, wiggle, curves = [], [], [], {}
for strength in strengths:
    scene = load_scene("dcb-czm1-linear", [f"interface.strength={strength}", "discretization.dofs=700"])
    beam, nurbs = solve(scene, "beam"), solve(scene, "nurbs")
    exact, coarse = (beam.opening, beam.load), (nurbs.opening, nurbs.load)
    elements.append(expected(scene, "nurbs").elements)
    too_high.append(peak(coarse)[1] / peak(exact)[1] - 1)
    wiggle.append(oscillation(coarse, exact)["rms"])
    curves[strength] = exact, coarse
    print(
        f"strength {strength:2g}: {elements[-1]:.1f} elements of {element_length(scene, 'nurbs'):.2f} mm in the zone"
        f", peak {too_high[-1]:+.1%}, oscillation {wiggle[-1]:.1%}"
    )

# %% [markdown]
# Three elements are the least that are usually asked for (Turon, Davila, Camanho, Costa 2007). Below that the load is
# too high, since a point between others that are still whole is pulled open only by bending a whole element, and then
# the curve wriggles: every element that lets go is an event of its own.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), constrained_layout=True)
for strength, colour in ((4.0, "#0072b2"), (32.0, "#d55e00")):
    exact, coarse = curves[strength]
    left.plot(*exact, color=colour, linewidth=4, alpha=0.3)
    left.plot(*coarse, color=colour, linewidth=1, label=f"strength {strength:g} MPa")
left.set(xlabel="opening (mm)", ylabel="load (N)", xlim=(0, 3), ylim=(0, None), title="thick: beam; thin: 700 unknowns")
left.legend(frameon=False)
right.semilogy(elements, wiggle, "o-", color="#1b2330", label="oscillation")
right.semilogy(elements, np.abs(too_high), "s--", color="#7a3fc0", label="error of the peak")
right.axvline(ENOUGH, color="#999999", linewidth=1)
right.set(xlabel="elements in the process zone", ylabel="relative")
right.legend(frameon=False)
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)

# %% [markdown]
# ## Told beforehand
#
# None of this needs a run. `./debond solve` looks at the zone before it starts, and says what would resolve it:

# %%
scene = load_scene("dcb-czm1-linear", ["interface.strength=32", "discretization.dofs=700"])
print("\n".join(warnings(prepare(scene, "nurbs"))))

# %% [markdown]
# Nothing happens at exactly three. With three elements or more the curve can be trusted, with fewer than two it cannot,
# and in between it is a matter of luck where the points lie:

# %%
spanned, rms = np.array(elements), np.array(wiggle)
trusted, lost = rms[spanned >= ENOUGH].max(), rms[spanned < 2].min()
print(f"oscillation: at most {trusted:.1%} with three elements or more, at least {lost:.1%} with fewer than two")
assert trusted < 0.005 < 0.01 < lost
