# %% [markdown]
# # A verdict in a notebook
#
# `verify` without a command and without a folder: a scene, two methods that share no line of code, the identities that
# any solution must keep, and a curve of another code in units of its own. In a notebook results, checks, comparisons
# draw themselves: end a cell with `result`, `checks` or `found`.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import verify

scene = verify.load_scene("dcb-czm1", ["load.opening=2.0", "discretization.dofs=1120"])
result, beam = verify.solve(scene, "nurbs"), verify.solve(scene, "beam")
print(result, beam, sep="\n")

# %% [markdown]
# ## What must hold of one run
#
# No reference is needed for these: energy is stored or dissipated, forces and moments balance, and the J-integral is
# the area under the traction law. A check holds, is broken, or is unresolved where the mesh cannot judge.

# %%
checks = verify.run_checks(scene, result)
for check in checks:
    print(f"{check.state:10} {check.name:16} {check.value:9.1e}  (<= {check.tolerance:.0e})")

# %% [markdown]
# ## Against another theory
#
# The beam on a cohesive interface has a closed form between the ends of its zones. The distance is the relative L2
# distance of the loads over the opening.

# %%
found = verify.compare(result, beam)
print(found)
at, P_a, P_b = found.worst
print(f"they differ most at an opening of {at:.2f} mm: {P_a:.4f} N and {P_b:.4f} N")

# %% [markdown]
# ## Another code
#
# Its history file has the displacement of one face, downwards, and the reaction in kilonewtons. Here it is made up: the
# same curve with a load that is 3 % too high.

# %%
history = np.stack([-result.opening / 2.0, -1.03e-3 * result.load], 1)
columns = verify.Reading(opening=1, load=2, opening_scale=-2.0, load_scale=-1e3)
file = Path(__file__).with_name("history.csv")
np.savetxt(file, history, delimiter=",")
other = verify.read_curve(file, columns)
told = verify.compare(other, beam)
print(f"within 1 % of the beam: NURBS {found.agrees(curve=0.01)}, the other code {told.agrees(curve=0.01)}")
try:
    verify.assert_curves_close(file, beam, actual_as=columns, curve=0.01, peak=0.01)
except AssertionError as error:
    print(error)
file.unlink()

figure, axes = plt.subplots(figsize=(6, 3.4), constrained_layout=True)
axes.plot(beam.opening, beam.load, color="#999999", linewidth=4, alpha=0.5, label="cohesive beam")
axes.plot(result.opening, result.load, color="#0072b2", label="NURBS")
axes.plot(*other, ":", color="#d55e00", label="another code")
axes.set(xlabel="opening (mm)", ylabel="load (N)", xlim=(0, 2), ylim=(0, None))
axes.legend(frameon=False)
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)

# %% [markdown]
# All checks of the run hold, two theories agree, and the code that is 3 % off is found out.

# %%
assert [check.name for check in checks if check.state != "holds"] == []
assert found.curve_error < 0.005 < 0.02 < told.curve_error
