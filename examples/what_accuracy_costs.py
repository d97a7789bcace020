# %% [markdown]
# # What accuracy costs
#
# Which discretisation is the fastest? The question has no answer before it says how accurate. Take three of them up a
# ladder of meshes, time every run, measure every error, and read the answer off two straight lines: how fast the error
# falls and how fast the time grows. `./debond cost` does it for all methods; here it is in miniature.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from verify.curves.curve import curve_error, dense
from verify.methods.solve import solve
from verify.scene import load_scene

# %% [markdown]
# ## The ladder
#
# Cubic NURBS, cubic Lagrange elements, and quadratic ones. All runs take the same number of steps, so that time
# compares meshes and not step control. Between two steps the curve is drawn by a cubic with the exact slopes of both
# (`verify.curves.curve.dense`), lest the error of a straight line is taken for that of the mesh.

# %%
ladder = {"cubic NURBS": ("nurbs", 3), "cubic Lagrange": ("lagrange", 3), "quadratic Lagrange": ("lagrange", 2)}
sizes = (280, 560, 1120, 2240)


def run(method, degree, dofs):
    mesh = [f"discretization.degree={degree}", f"discretization.dofs={dofs}", "discretization.steps=100"]
    return solve(load_scene("dcb-czm1", ["load.opening=1.0", *mesh]), method)


def curve(result):
    return dense(result.opening, result.load, result.steps["load_slope"], result.steps["heading"])


runs = {name: [run(*which, dofs) for dofs in sizes] for name, which in ladder.items()}

# %% [markdown]
# ## Against what?
#
# An error needs a reference that is better than the best of them. The cohesive beam is a theory of its own and differs
# by more than the finest meshes do, so a finer mesh it is; and since that one is of NURBS, its own uncertainty must be
# known, lest it flatters them. Each mesh has twice as many unknowns as the one before. If the distance from one to the
# next falls by a factor $r$, what is still missing on the last is that distance over $r - 1$.

# %%
reference = run("nurbs", 3, 2 * sizes[-1])
chain = [curve(result) for result in (*runs["cubic NURBS"], reference)]
steps = [curve_error(coarse, fine) for coarse, fine in zip(chain[:-1], chain[1:], strict=True)]
ratio = (steps[0] / steps[-1]) ** (1 / (len(steps) - 1))
uncertainty = steps[-1] / (ratio - 1)
print("from mesh to mesh: " + ", ".join(f"{step:.3%}" for step in steps))
print(f"a factor of {ratio:.1f} each: the reference itself is good to {uncertainty:.3%}")

# %% [markdown]
# ## Two straight lines
#
# In a diagram with logarithmic axes error and time are straight lines over the unknowns, and their slopes are numbers
# to remember. The meshes are refined along the specimen alone, so that the unknowns grow as one over the element
# length, and the slope of the error is the observed order.

# %%
line = {}
for name, results in runs.items():
    dofs = np.array([result.dofs for result in results])
    error = np.array([curve_error(curve(result), chain[-1]) for result in results])
    seconds = np.array([result.seconds["total"] for result in results])
    order, growth = -np.polyfit(np.log(dofs), np.log(error), 1)[0], np.polyfit(np.log(dofs), np.log(seconds), 1)[0]
    line[name] = dofs, error, seconds, order, growth
    print(f"{name}: observed order {order:.1f}, time as unknowns to the {growth:.1f}")
    for n, e, s in zip(dofs, error, seconds, strict=True):
        print(f"  {n:5} unknowns  {e:7.3%}  {s:5.2f} s")

# %% [markdown]
# Cubic polynomials can approximate a smooth field to the fourth order, and quadratic ones to the third. Neither does.
# Where damage begins and where it ends the law has a kink, those places travel, and no mesh has its nodes there: the
# field is not smooth, and all three come down at about the second order. What the bases differ in is the constant in
# front: where on the ladder the line begins.
#
# ## What accuracy costs
#
# Eliminate the unknowns and a question gets an answer: so much time for such an error. Times are those of this machine
# in this hour, of one run each; only their ratios travel, and not far.

# %%
wanted = 0.001
for name, (_, error, seconds, order, growth) in line.items():
    at = np.exp(np.interp(-np.log(wanted), -np.log(error), np.log(seconds)))
    half = 2 ** (growth / order)
    print(f"{name:18} about {at:.1f} s for {wanted:.1%}; half the error takes {half:.1f} times as long")

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), sharey=True, constrained_layout=True)
for (name, (dofs, error, seconds, *_)), colour in zip(line.items(), ("#0072b2", "#d55e00", "#7a3fc0"), strict=True):
    left.loglog(dofs, error, "o-", color=colour, label=name)
    right.loglog(seconds, error, "o-", color=colour, label=name)
left.loglog(sizes, 2.0 * error[1] * (sizes[1] / np.array(sizes)) ** 2, "--", color="#999999", label="second order")
left.set(xlabel="unknowns", ylabel="error of the curve")
right.set(xlabel="seconds")
for axes in (left, right):
    axes.axhspan(1e-5, uncertainty, color="#999999", alpha=0.2, linewidth=0)
left.set_ylim(5e-5, None)
left.legend(frameon=False, fontsize=8)
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)

# %% [markdown]
# The grey band is what the reference itself does not know. Errors below it are not errors but guesses, and a study
# that shows points there without the band promises more than it holds.

# %%
orders = [order for *_, order, _ in line.values()]
print("observed orders: " + ", ".join(f"{order:.1f}" for order in orders))
assert uncertainty < 0.0002 and all(1.3 < order < 2.7 for order in orders)
