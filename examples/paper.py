# %% [markdown]
# # The figures of the paper
#
# R. Dimitri, L. De Lorenzis and G. Zavarise (*A T-spline-based approach for interface debonding using cohesive zone
# models*, AIMETA 2013) compare T-splines, NURBS and Lagrange elements with equal unknowns, by eye. Here their runs are
# repeated, their figures are drawn, and their statements are tested by numbers: confirmed, confirmed in part, or not
# confirmed, and by how much. `./debond exec python examples/paper.py --out paper` takes about ten minutes on two cores
# for 196 runs. They are kept in the folder, so that a second time draws only. `--quick` takes one law, one mesh and one
# rule, in some seconds, as on the page of the documentation.

# %%
import argparse
import csv
from dataclasses import replace
from itertools import pairwise, product
from os import cpu_count
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np

from verify.curves.curve import curve_error, envelope, oscillation, peak
from verify.curves.of_run import peak_load
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.names import METHODS
from verify.methods.solve import prepare
from verify.methods.zone_resolution import ENOUGH, element_length, expected, measured
from verify.runs.jobs import Job, run_all
from verify.scene import load_scene
from verify.theory import lefm

parser = argparse.ArgumentParser(description="Figures 6 to 9 of the paper, and whether its statements hold.")
parser.add_argument("--out", type=Path, default=Path(__file__).with_suffix(""), help="folder of figures and runs")
parser.add_argument("--quick", action="store_true", help="one law, one mesh and one rule")
options = parser.parse_args()

# %% [markdown]
# ## The runs
#
# Figures 6 and 7 are double cantilever beams with two laws, 280 and 1956 unknowns, two Gauss points an element and a
# penalty of 1e5. Figure 8 takes up to eight points. The paper says that the penalty has no influence, so every beam is
# solved with a smaller one as well. Figure 9 is a strip that is peeled off a substrate, with bonds of four lengths.

# %%
BASES = {"tspline": "T-splines", "nurbs": "NURBS", "lagrange": "Lagrange elements"}
LAWS = {"dcb-czm1": "CZM 1", "dcb-czm2": "CZM 2"}
BONDS = {"peel-60": "60 mm", "peel-80": "80 mm", "peel-100": "100 mm", "peel-120": "120 mm"}
MESHES, POINTS, PENALTIES = (280, 1956), tuple(range(2, 9)), (1e5, 1e3)
if options.quick:
    LAWS, BONDS, MESHES, POINTS, PENALTIES = {"dcb-czm1": "CZM 1"}, {}, (280,), (2,), (1e5,)
SCENES = {name: load_scene(name) for name in (*LAWS, *BONDS)}


class Case(NamedTuple):
    """A run; the default numbers are those of Figure 9."""

    basis: str
    scene: str
    dofs: int = 3700
    points: int = 2
    penalty: float = 1e3


def job(scene, method, *settings):
    """A run; its folder is named by the method and the values of its settings."""
    name = "-".join([method, *(setting.partition("=")[2] for setting in settings)])
    return Job(scene, SCENES[scene], method, name, settings, fields=False)


def of(case):
    """The run of a case."""
    mesh = f"discretization.dofs={case.dofs}", f"discretization.interface_points={case.points}"
    return job(case.scene, case.basis, *mesh, f"interface.penalty={case.penalty}")


def fine(scene, penalty):
    """Runs on two fine meshes. The finer one is the converged curve; the distance of the other shows its error."""
    beam = scene in LAWS
    if dolfinx_installed():
        method, key, size = "dolfinx", "dolfinx.elements", SCENES[scene].dolfinx.elements
        own = f"dolfinx.degree={3 if beam else 2}"
    else:
        method, key, size = "nurbs", "discretization.dofs", 8000
        own = f"effects.symmetry={str(beam).lower()}"  # one arm of a beam, which has half of the unknowns
    sizes = (size // 4, size // 2) if options.quick else (size, 2 * size)
    return [job(scene, method, own, f"interface.penalty={penalty}", f"{key}={n}") for n in sizes]


beams = [Case(*one) for one in product(BASES, LAWS, MESHES, POINTS, PENALTIES)]
strips = [Case(*one) for one in product(BASES, BONDS)]
problems = dict.fromkeys((case.scene, case.penalty) for case in (*beams, *strips))
plan = [*(one for problem in problems for one in fine(*problem)), *map(of, (*beams, *strips))]
results = {one.job: one.result for one in run_all(plan, options.out, cpu_count() or 1)}

# %% [markdown]
# ## Two numbers for a curve
#
# The *error* is the distance of the load curve from the converged one, relative L2 over the opening. The *oscillation*
# is the root mean square of load / converged load - 1 on the propagation branch, without its mean. A run that stopped
# has neither and takes part in no comparison. All numbers go to `runs.csv`.


# %%
def curve(result):
    return result.opening, result.load


def numbers(one, other):
    return {"error": curve_error(one, other), "oscillation": oscillation(one, other)["rms"]}


converged, unsure = {}, {}
for scene, penalty in problems:
    coarse, finer = (curve(results[one]) for one in fine(scene, penalty))
    converged[scene, penalty], unsure[scene, penalty] = finer, numbers(coarse, finer)
    print(f"{scene}, penalty {penalty:g}: a coarser mesh is {curve_error(coarse, finer):.3%} from the converged curve")

runs = {case: results[of(case)] for case in (*beams, *strips) if results[of(case)] and results[of(case)].complete}
found = {case: numbers(curve(run), converged[case.scene, case.penalty]) for case, run in runs.items()}
for case in {*beams, *strips} - {*runs}:
    print(f"{case} stopped")
table = [[*case, *found[case].values(), peak_load(run)] for case, run in runs.items()]
with open(options.out / "runs.csv", "w", newline="") as file:
    csv.writer(file).writerows([[*Case._fields, "error", "oscillation", "peak"], *table])

# %% [markdown]
# ## The figures
#
# Heavy lines are what a test in displacement control would show of a path, thin ones the path itself, through its
# snap-backs. Broad and grey is the converged curve, and dashed the limit of LEFM by simple beam theory.


# %%
def limit(scene):
    """The curve of LEFM: opening and load."""
    rows = lefm.solve(replace(prepare(SCENES[scene], "lefm").problem, theory="simple")).rows
    return np.array([[row["opening"], row["load"]] for row in rows]).T


def figure(number, panels):
    """Rows of a panel a basis: titles with cases, each of which may have a label and a look of its own."""
    sheet, grid = plt.subplots(len(panels) // 3, 3, figsize=(11, 3 * len(panels) // 3), sharex=True, squeeze=False)
    for axes, (title, cases) in zip(grid.flat, panels.items(), strict=True):
        for case, look in cases:
            axes.plot(*converged[case.scene, case.penalty], color="0.75", linewidth=3.5, zorder=1)
            axes.plot(*limit(case.scene), "--", color="0.5", linewidth=0.8, zorder=1)
            if case in runs:
                look = {"color": METHODS[case.basis].look.colours[0], **look}
                axes.plot(*envelope(*curve(runs[case])), linewidth=1.5, **look)
                axes.plot(*curve(runs[case]), linewidth=0.5, **{**look, "label": None})
        end = max(max(SCENES[case.scene].load.opening) for case, _ in cases)
        axes.set(title=title, xlim=(0, end), ylim=(0, None), xlabel="opening (mm)", ylabel="load (N)")
        if "label" in look:
            axes.legend(frameon=False, fontsize=8)
    sheet.tight_layout()
    sheet.savefig(options.out / f"figure-{number}.png", dpi=110)


panels = [(f"{BASES[basis]}, {LAWS[law]}", basis, law) for law, basis in product(LAWS, BASES)]
for number, dofs in enumerate(MESHES, 6):
    figure(number, {title: [(Case(*which, dofs, 2, 1e5), {})] for title, *which in panels})
shades = {n: {"label": f"{n} points", "alpha": n / POINTS[-1]} for n in POINTS[::2]}
if len(shades) > 1:
    sweep = shades.items()
    figure(8, {title: [(Case(*which, MESHES[0], n, 1e5), look) for n, look in sweep] for title, *which in panels})
if BONDS:
    look = {bond: {"label": BONDS[bond], "color": f"C{k}"} for k, bond in enumerate(BONDS)}
    figure(9, {BASES[basis]: [(Case(basis, bond), look[bond]) for bond in BONDS] for basis in BASES})

# %% [markdown]
# ## The statements
#
# Most of them say that one run is better than another. Such a comparison decides nothing where the two differ by less
# than the two meshes of the converged curve do.


# %%
def say(text, comparisons, shown="{:.3g}"):
    """Print a statement with its verdict: the comparisons in which it holds, median and range of their numbers."""
    yes, no, unknown = ([holds for _, holds in comparisons].count(answer) for answer in (True, False, None))
    if comparisons:
        verdict = "confirmed in part" if yes and no else "confirmed" if yes else "not confirmed" if no else "undecided"
        low, middle, high = map(shown.format, np.quantile([value for value, _ in comparisons], (0, 0.5, 1)))
        print(f"{verdict:18} {text}: {yes} hold, {no} do not, {unknown} undecided; {middle}, from {low} to {high}")


def those(cases, **values):
    """The cases with these values whose runs are complete."""
    return [case for case in cases if case in runs and all(getattr(case, key) == v for key, v in values.items())]


def pairs(cases, **other):
    """Every case, and that with ``other`` values, where both runs are complete."""
    return [(case, case._replace(**other)) for case in those(cases) if case._replace(**other) in runs]


def better(text, measure, cases, **other):
    """That cases have a smaller error or oscillation than those with ``other`` values, and by what factor."""
    comparisons = []
    for case, worse in pairs(cases, **other):
        low, high = found[case][measure], found[worse][measure]
        blind = max(unsure[one.scene, one.penalty][measure] for one in (case, worse))
        comparisons.append((high / low, high > low if abs(high - low) > blind else None))
    say(text, comparisons)


def unseen(text, distances):
    """That curves coincide within the width of a line."""
    say(f"{text}: less than 1 % apart", [(distance, distance < 0.01) for distance in distances], "{:.2%}")


def apart(cases, **other):
    """Distances of the curves of cases from those with ``other`` values."""
    return [curve_error(curve(runs[a]), curve(runs[b])) for a, b in pairs(cases, **other)]


in_figures = those(beams, points=2, penalty=1e5)
zones = [expected(of(c).solved, c.basis).elements for c in those(in_figures, scene="dcb-czm1", dofs=280)]
said = f"280 unknowns just resolve the process zone of CZM 1: 1 to {ENOUGH} elements in it"
say(said, [(n, 1 <= n < ENOUGH) for n in zones])
measures = {"error": "closer", "oscillation": "smoother"}.items()
groups = {"equal unknowns": in_figures, "2 to 8 points": beams, "equal unknowns on a strip": strips}
for (basis, other), (where, cases), (measure, more) in product(pairwise(BASES), groups.items(), measures):
    said = f"{BASES[basis]} are {more} than {BASES[other]} at {where}"
    better(said, measure, those(cases, basis=basis), basis=other)
better("More strength, more oscillation", "oscillation", those(in_figures, scene="dcb-czm1"), scene="dcb-czm2")
for basis, (measure, more) in product(("nurbs", "lagrange"), measures):
    better(f"8 points instead of 2 make {BASES[basis]} {more}", measure, those(beams, basis=basis, points=8), points=2)
with_more = [case for case in those(beams, basis="tspline") if case.points > 2]
unseen("T-splines hardly change with more points", apart(with_more, points=2))
problem = [curve_error(converged[law, 1e3], converged[law, 1e5]) for law in LAWS if (law, 1e3) in converged]
unseen("The penalty has no visible influence", [*apart(those(beams, penalty=1e3), penalty=1e5), *problem])
for measure, more in measures:
    better(f"1956 unknowns make every basis {more}", measure, those(in_figures, dofs=1956), dofs=280)
for where, cases in {"beams of 1956 unknowns": those(in_figures, dofs=1956), "strips": those(strips)}.items():
    unseen(f"Every basis draws the converged curve of {where}", [found[case]["error"] for case in cases])

# %% [markdown]
# ## What the paper does not say
#
# With the moduli of the strip as they are printed, in MPa, no such mesh resolves the process zone; read as GPa they do.
# A longer bond leaves a shorter lever arm and so gives a larger peak load, which stays below that of a clamped plate.

# %%
zones = [measured(runs[c]) / element_length(SCENES[c.scene], c.basis) for c in those(strips)]
say(f"With moduli in GPa {ENOUGH} elements or more are in the zone", [(n, n >= ENOUGH) for n in zones])
zones = [expected(load_scene("peel-as-printed"), basis).elements for basis in BASES] if BONDS else []
say(f"With the moduli as printed, in MPa, there are fewer than {ENOUGH}", [(n, n < ENOUGH) for n in zones])
tops = {case: peak_load(runs[case]) for case in those(strips)}
longer = [one for a, b in pairwise(BONDS) for one in pairs(those(strips, scene=a), scene=b)]
ratios = [tops[long] / tops[short] for short, long in longer]
say("A longer bond has a larger peak load", [(ratio, ratio > 1) for ratio in ratios])
parts = [top / peak(limit(case.scene))[1] for case, top in tops.items()]
say("The peak load stays below that of a clamped plate", [(part, part < 1) for part in parts])

# %% [markdown]
# The numbers of 280 unknowns are what the paper is about: T-splines put them where the crack runs.

# %%
of_figure_6 = {basis: found[Case(basis, "dcb-czm1", 280, 2, 1e5)]["error"] for basis in BASES}
print(", ".join(f"{BASES[basis]} {error:.1%}" for basis, error in of_figure_6.items()), "off with 280 unknowns")
tspline, nurbs, lagrange = of_figure_6.values()
assert tspline < 0.015 < nurbs < 0.03 < lagrange
