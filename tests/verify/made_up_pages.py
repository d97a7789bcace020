"""Every kind of page that a command writes, from made-up runs and studies, by the code that writes it for users."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import product
from math import nan
from pathlib import Path

import made_up_point_laws
import made_up_studies
import made_up_tests
import numpy as np
import pytest
from iga_files import SMALL
from made_up_costs import SCENE, a_row, against
from made_up_runs import ENVIRONMENT, made_up, scene_report

from iga.bases.names import BASES
from tests.verify.studies.certified.test_certified_study import answered
from tests.verify.studies.hard.test_hard import FAKE, faulty, stub
from verify import report
from verify.checks.foreign_curves import Curve
from verify.checks.identities import run_checks
from verify.cli import main
from verify.curves.read import Reading
from verify.methods.solve import solve
from verify.pages.style import METHOD_NAMES
from verify.reduction.coupon import coupon
from verify.reduction.reduce import Value, reduce
from verify.reduction.scheme import Settings
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies import pairs_page, uncertainty_page
from verify.studies.certified.study import judged as certified_judged
from verify.studies.certified.study import planned as certified_planned
from verify.studies.cost import page as cost_page
from verify.studies.cost.row import Row
from verify.studies.cost.study import Study as CostStudy
from verify.studies.effects import Study as EffectsStudy
from verify.studies.found import found_in
from verify.studies.hard import page as hard_page
from verify.studies.hard.one import Verdict, run_case
from verify.studies.law import laws
from verify.studies.law import page as law_page
from verify.studies.law.judge import judge
from verify.studies.law.laws import built_in, of_function
from verify.studies.law.paths import paths
from verify.studies.reduce import page as reduce_page
from verify.studies.reduce.bias import biases
from verify.studies.reduce.fit import Fit
from verify.studies.validation import page as validation_page
from verify.studies.validation.study import judged as validation_judged
from verify.studies.validation.study import planned as validation_planned
from verify.studies.vary import Study as VaryStudy
from verify.verdict import Check, Run, SceneReport


def meshes(given: SceneReport) -> SceneReport:
    """The scene with two coarser NURBS meshes, and with fields of two runs alone, as they take long to draw."""
    fine = given.runs[0]
    coarse = (
        replace(fine, label=f"NURBS {n}", folder=f"{fine.folder}-{n}", result=made_up("nurbs", wobble, 1.0, n, n // 18))
        for n, wobble in ((978, 1.6e-3), (489, 3.2e-3))
    )
    bare = [replace(run, result=replace(run.result, snapshots=())) for run in (given.runs[1], *given.runs[3:], *coarse)]
    return replace(given, runs=(fine, given.runs[2], *bare))


def verification(out: Path) -> Path:
    """One scene with everything and a check that fails, and the studies of all other commands."""
    made_up_studies.cost(out / "cost")
    made_up_studies.effects(out / "effects")
    made_up_studies.vary(out / "vary")
    made_up_studies.hard(out / "hard")
    given = meshes(scene_report())
    failing = Check("peak-load", "lagrange / dolfinx", 0.02, 5e-3, "cross-code", "Two codes find the same peak.")
    runs = tuple(replace(run, key="0123456789abcdef" * 2) for run in given.runs)
    runs += (Run("T-spline", "tspline", None, "not run: no mesh has so few unknowns"),)
    given = replace(given, runs=runs, checks=(*given.checks, failing))
    path = out / "report.html"
    rows = ladders() + (a_row("lagrange", nan, 0.1, 732, 2),)
    prices = (
        CostStudy(SCENE, rows, ("There was no time for more.",), against()),
        CostStudy(given.scene, rows[5:9], (), against()),
    )
    report.write(report.Findings((given,), ENVIRONMENT, included=found_in(out), prices=prices), path)
    return path


def peel(out: Path) -> Path:
    """A coarse peel test by two bases, with T-junctions."""
    scene = load_scene("peel-80", ("discretization.dofs=1100", "load.opening=2.0", "discretization.steps=10"))
    found = {method: solve(scene, method) for method in ("nurbs", "tspline")}
    runs = tuple(Run(METHOD_NAMES[method], method, one, "", f"peel-80/{method}") for method, one in found.items())
    checks = tuple(check for one in found.values() for check in run_checks(scene, one))
    report.write(report.Findings((SceneReport(scene, runs, checks),), ENVIRONMENT), out / "report.html")
    return out / "report.html"


def ladders() -> tuple[Row, ...]:
    """Runs of every method with a mesh, with few steps and with many."""
    sizes = (300, 500, 900, 1700, 3200)
    at = {"nurbs": (3, 6.0), "tspline": (3, 4.0), "lagrange": (3, 30.0), "dolfinx": (2, 9.0)}
    return tuple(
        a_row(method, size * n**-1.2, 1e-3 * n**1.1 * (4.0 if method == "dolfinx" else 1.0), n, degree, asked)
        for (method, (degree, size)), n, asked in product(at.items(), sizes, ("20", "80"))
    )


def cost(out: Path) -> Path:
    """Ladders of every method, one run that stopped."""
    rows = [*ladders(), a_row("beam", 5e-4, 0.1, 0, 0), a_row("lagrange", nan, 0.1)]
    cost_page.write(CostStudy(SCENE, tuple(rows), ("lefm: only a limit",), against()), out / "report.html")
    return out / "report.html"


def effects(out: Path) -> Path:
    """Every effect, of which one could not be switched."""
    sizes = {"finite kinematics": 0.0035, "contact": -0.0061, "irreversible damage": 0.0, "symmetry": 1.2}
    changes = ("curve_change", "peak_change", "end_change", "dissipated_change", "work_change")
    rows = [
        made_up_studies.pair(name, "on", "off", time_ratio=2.0, **dict.fromkeys(changes, size))
        for name, size in sizes.items()
    ]
    rows.append(made_up_studies.pair("search", "on", "off", status="search = on: stopped"))
    study = EffectsStudy(SCENE, tuple(rows), ("moments: left out: the scene has none",), method="nurbs")
    pairs_page.write(study, out / "report.html")
    return out / "report.html"


def vary(out: Path) -> Path:
    """The scene without viscosity, with some, and a run that stopped."""
    sizes = {"0": 0.0, "0.0001": 1e-3, "0.001": 1e-2, "0.01": 0.1}
    rows = [
        made_up_studies.pair(
            "interface.viscosity", value, "0", curve_change=off, peak_change=0.5 * off, seconds=3.0 - 10.0 * off
        )
        for value, off in sizes.items()
    ]
    rows.append(made_up_studies.pair("interface.viscosity", "0.1", "0", status="viscosity = 0.1: stopped: no way"))
    pairs_page.write(VaryStudy(SCENE, tuple(rows), (), method="nurbs"), out / "report.html")
    return out / "report.html"


def validation(out: Path) -> Path:
    """A statement that shows an error of the model, others that do not or cannot; an input that is not linear."""
    stated = ("specimen.arm_thickness=0.01", "interface.toughness=0.05", "data.load=0.005", "data.opening=0.01")
    scene = load_scene("dcb-czm1", [f"uncertainty.{one}" for one in stated])
    plan = validation_planned("dcb-czm1", scene, "nurbs", (), (0.5, 9.0))
    d = np.linspace(0.0, 3.0, 301)

    def of(job: Job) -> Outcome:
        number = plan.jobs.index(job)
        load = (1.0 + 0.01 * np.sin(3.0 * number)) * d * np.exp(-1.5 * d)
        return Outcome(job, Result("nurbs", {"opening": d, "load": load}, elements=240 - 60 * min(number, 2)))

    data = Curve("lab", out / "lab.csv", Reading(), Result("lab", {"opening": d, "load": d * np.exp(-1.6 * d)}))
    study = validation_judged(plan, data, {job: of(job) for job in plan.jobs})
    validation_page.write(study, out / "report.html")
    return out / "report.html"


def certified(out: Path) -> Path:
    """Values that are certified, and others that are not; pairs that are kept make a difference."""
    plan = certified_planned("dcb-czm1", load_scene("dcb-czm1"), (0.5, 1e-3))
    uncertainty_page.write(certified_judged(plan, answered(plan, 3e-4, 2e-3)), out / "report.html")
    return out / "report.html"


def hard(out: Path) -> Path:
    """A case that holds on one basis, fails on another, and ends a third."""
    solvers = {"nurbs": stub, "tspline": faulty(external_work=0.1)}
    verdicts = {
        ("fake", basis): run_case(FAKE, basis, out / "fake" / basis, solvers[basis])
        if basis in solvers
        else Verdict("fake", basis, why="signal 9")
        for basis in BASES
    }
    hard_page.write([FAKE], verdicts, out)
    return out / "report.html"


def law(out: Path) -> Path:
    """A law with a defect and a tangent that is another one's."""
    bond = made_up_point_laws.BONDS["as4-peek"]
    wrong, right = made_up_point_laws.law_of(bond, "sqrt2-compressed-shear"), built_in(bond)

    def both(g: float, s: float, state: tuple | None, dt: float) -> tuple:
        mine, other = state or (None, None)
        p, t, mine = wrong(g, s, mine, dt)
        *_, other, tangent = right(g, s, other, dt)
        return p, t, (mine, other), tangent

    ways = paths(bond)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(laws, "PROBED", 1)  # of each path one tangent alone
        found = judge(bond, ways, {way.name: of_function(both, way) for way in ways})
    law_page.write(found, SCENE, "a_module_with_a_long_name_of_its_own:and_a_function", out / "law.html")
    return out / "law.html"


def reduction(out: Path) -> Path:
    """A noisy test with a toe and a machine, a scheme that is missing, and a fit that cannot tell the strength."""
    scene = load_scene("dcb-as4peek")
    found = reduce(made_up_tests.recorded("dcb", made_up_tests.NOISY), coupon(scene), Settings(machine=1e-4))
    values = {"strength": (80.0, 70.0), "toughness": (0.969, 2e-3), "modulus": (1.2e5, 300.0), "toe": (0.01, 2e-3)}
    fit = Fit({name: Value(*value) for name, value in values.items()}, 0.01, 0.012, 1e-3, 30, *np.ones((2, 2)))
    name = "a_file_with_a_long_name_from_a_machine_in_the_laboratory_001.csv"
    reduce_page.write(found, biases(found, scene), scene, name, out / "reduce.html", (fit,))
    return out / "reduce.html"


def comparison(out: Path) -> Path:
    """Two curves, one with a peak that is off."""
    d = np.linspace(0.0, 3.0, 60)
    for name, scale in (("a very long name of a curve of another program", 1.01), ("b", 1.0)):
        lines = [f"{x},{scale * x * np.exp(-x)}" for x in d.tolist()]
        (out / f"{name}.csv").write_text("\n".join(["opening,load", *lines]) + "\n")
    files = [str(path) for path in sorted(out.glob("*.csv"))]
    assert main(["compare", *files, "--peak-tol", "1e-4", "--at", "0.5,1", "--out", str(out)]) == 1
    return out / "comparison.html"


def mesh(out: Path) -> Path:
    """The picture of a file with a hanging node, with its control points."""
    (out / "small.iga").write_text(SMALL)
    assert main(["mesh", str(out / "small.iga"), "--control", "--out", str(out / "small.svg")]) == 0
    return out / "small.svg"


#: Name -> what writes the page into an empty folder, and says where it is.
PAGES: Mapping[str, Callable[[Path], Path]] = {
    "verify": verification,
    "peel": peel,
    "cost": cost,
    "effects": effects,
    "vary": vary,
    "validation": validation,
    "certified": certified,
    "hard": hard,
    "law": law,
    "reduce": reduction,
    "compare": comparison,
    "mesh": mesh,
}
