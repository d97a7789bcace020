"""Every check finds a fault of ten times its tolerance, alone or first; a check without a planted fault fails here.

First is the check that is furthest beyond its tolerance. Faults are planted in the columns of cheap runs, consistently
with all that the fault itself leaves right, and some in the solver itself.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import verify
from iga import cohesive
from tests.verify.test_peel_checks import made_up as made_up_peel
from verify.checks import growing, run_checks
from verify.compare import ROUNDING, checks, compare
from verify.crosschecks import cross_checks, published_names
from verify.foreign import checks_of
from verify.methods import solve
from verify.plane_errors import Errors
from verify.plane_rates import FAMILIES, Convergence, rate_checks
from verify.plane_study import Level, _checks
from verify.result import Result
from verify.scene import Scene, load_scene
from verify.verdict import Check

DCB = load_scene("dcb-czm1-linear", ["discretization.steps=60"])
PEEL = load_scene("peel-60")
BENCHMARK = load_scene("alfano-crisfield")

#: Ten times the tolerance of a check.
SIZE = 10.0


def beam() -> Result:
    """The beam satisfies all identities to rounding; it lacks reactions and moments, which are zero here."""
    result = solve(DCB, "beam")
    zero = np.zeros_like(result.load)
    names = ("load_moment", "interface_moment", "reaction_x", "reaction_y")
    return replace(result, steps={**result.steps, **dict.fromkeys(names, zero)})


@pytest.fixture(scope="module")
def runs() -> Mapping[str, Result]:
    return {"dcb": beam(), "peel": made_up_peel(PEEL)}


def scaled(result: Result, factors: Mapping[str, float]) -> Result:
    steps = {name: factors.get(name, 1.0) * column for name, column in result.steps.items()}
    return replace(result, steps=steps)


def shifted(result: Result, column: str, by: float) -> Result:
    return replace(result, steps={**result.steps, column: result.steps[column] + by})


def dearer(result: Result, by: float) -> Result:
    """A crack that costs more than G_Ic, with the work that it takes."""
    lost = by * result.steps["dissipated_energy"]
    return shifted(shifted(result, "dissipated_energy", lost), "external_work", lost)


def turned(result: Result, by: float) -> Result:
    """A loaded end that is turned too far, and holds the energy that J gains by it."""
    more = by * result.load * np.abs(result.steps["face_slope_top"])
    return shifted(scaled(result, {"face_slope_top": 1.0 + by}), "face_energy", more)


def short_of_load(result: Result, by: float) -> Result:
    """An upright strip on which less than G_Ic w pulls, and end faces that hold what J lacks; balances as they were."""
    G, grows = PEEL.interface.toughness, growing(PEEL, result.steps)
    load = np.where(grows, (1.0 - by) * G, result.load)
    part = np.divide(load, result.load, out=np.ones_like(load), where=result.load > 0.0)
    acting = ("load", "interface_force", "load_moment", "interface_moment", "clamp_moment", "interface_pull")
    limp = replace(result, steps=result.steps | {name: part * result.steps[name] for name in (*acting, "anchor_pull")})
    upright = np.where(grows, 1.0, result.steps["face_slope_top"])
    energy = np.where(grows, load - G, result.steps["face_energy"])
    return replace(limp, steps={**limp.steps, "face_slope_top": upright, "face_energy": energy})


#: Check of one run -> specimen, and the fault in its columns by the tolerance.
IN_A_RUN: Mapping[str, tuple[str, Callable[[Result, float], Result]]] = {
    "completed": ("dcb", lambda run, size: scaled(run, {"opening": 1.0 - size})),
    "j-integral": ("dcb", lambda run, size: scaled(run, {"face_slope_top": 1.0 + 2.0 * size})),
    "growth-load": ("peel", short_of_load),
    "growth-angle": ("peel", turned),
    "energy-ledger": ("dcb", lambda run, size: scaled(run, {"external_work": 1.0 / (1.0 - size)})),
    "interface-force": ("dcb", lambda run, size: scaled(run, {"interface_force": 1.0 + size})),
    "moment-balance": (
        "dcb",
        lambda run, size: shifted(run, "interface_moment", size * DCB.specimen.free_length * np.max(run.load)),
    ),
    "clamp-moment": ("peel", lambda run, size: scaled(run, {"clamp_moment": 1.0 + 20.0 * size})),
    "lengthwise": ("peel", lambda run, size: shifted(run, "anchor_pull", size * np.max(run.load))),
    "reactions": ("dcb", lambda run, size: shifted(run, "reaction_y", size * np.max(run.load))),
    "dissipation": ("dcb", dearer),
}


def of_run(kind: str, result: Result) -> tuple[Check, ...]:
    return run_checks({"dcb": DCB, "peel": PEEL}[kind], result)


def first(found: Iterable[Check]) -> str:
    """The broken check that is furthest beyond its tolerance; empty where all hold."""
    broken = [check for check in found if check.state == "broken"]
    return max(broken, key=lambda check: abs(check.value) / check.tolerance).name if broken else ""


@pytest.mark.parametrize("name", IN_A_RUN)
def test_a_fault_in_a_run(name: str, runs: Mapping[str, Result]) -> None:
    kind, plant = IN_A_RUN[name]
    right = {check.name: check for check in of_run(kind, runs[kind])}
    assert first(right.values()) == "" and right[name].state == "holds"
    assert first(of_run(kind, plant(runs[kind], SIZE * right[name].tolerance))) == name


def curve(method: str, factor: float = 1.0) -> Result:
    """A load that rises, and falls along an unloaded crack."""
    opening = np.linspace(0.0, max(DCB.load.opening), 3001)
    load = np.minimum(opening, np.maximum(opening, 1e-9) ** -0.5)
    return Result(method, {"opening": opening, "load": factor * load})


def after_the_peak(result: Result, by: float) -> Result:
    late = result.opening > 1.2
    return replace(result, steps={**result.steps, "load": np.where(late, 1.0 - 2.0 * by, 1.0) * result.load})


def spike(result: Result, by: float) -> Result:
    top = np.arange(result.load.size) == np.argmax(result.load)
    return replace(result, steps={**result.steps, "load": np.where(top, 1.0 + by, 1.0) * result.load})


def short(result: Result, by: float) -> Result:
    kept = result.opening <= (1.0 - by) * result.opening[-1]
    steps = {name: column[kept] for name, column in result.steps.items()}
    steps["opening"] = np.append(steps["opening"][:-1], (1.0 - by) * result.opening[-1])
    return replace(result, steps=steps)


def louder(result: Result, by: float) -> Result:
    return scaled(result, {"load": 1.0 + by})


def against_the_beam(plant: Callable[[Result], Result]) -> tuple[Check, ...]:
    """Two codes with the same fault agree with each other."""
    both = {method: replace(plant(curve(method)), method=method) for method in ("nurbs", "dolfinx")}
    return cross_checks(DCB, {**both, "beam": curve("beam")})


def against_dolfinx(plant: Callable[[Result], Result]) -> tuple[Check, ...]:
    return cross_checks(DCB, {"nurbs": plant(curve("nurbs")), "dolfinx": curve("dolfinx")})


def from_elsewhere(*methods: str) -> Callable[[Callable[[Result], Result]], tuple[Check, ...]]:
    others = {method: curve(method) for method in methods}
    return lambda plant: checks_of(DCB, "mine", plant(curve("mine")), others)


def compared(plant: Callable[[Result], Result]) -> tuple[Check, ...]:
    a, b = plant(curve("a")), curve("b")
    b = unloads(b, 0.0) if np.any(np.diff(a.opening) < 0.0) else b
    return tuple(checks(compare((a.opening, a.load), (b.opening, b.load)), 0.005, 0.005, 0.005))


def wave(result: Result, by: float) -> Result:
    """Loads too large at first and too small then, behind the peak: peak and work are what they were."""
    up, down = ((result.opening > a) & (result.opening < b) for a, b in ((1.3, 2.0), (2.0, 3.0)))
    lost = np.trapezoid(result.load * up, result.opening) / np.trapezoid(result.load * down, result.opening)
    return replace(result, steps={**result.steps, "load": (1.0 + by * (up - lost * down)) * result.load})


def unloads(result: Result, by: float) -> Result:
    """The curve with a way down from the opening 1.5 to 0.2 and back, whose load on the way down is too small."""
    there, after = result.opening <= 1.5, result.opening > 1.5
    top, way = np.interp(1.5, result.opening, result.load), np.linspace(1.5, 0.2, 200)
    down, up = top * way / 1.5 * (1.0 - 20.0 * by), top * way[::-1] / 1.5
    columns = ((result.opening, way, way[::-1]), (result.load, down, up))
    steps = {
        name: np.concatenate([column[there], first, second, column[after]])
        for name, (column, first, second) in zip(("opening", "load"), columns, strict=True)
    }
    return replace(result, steps=steps)


#: Check between curves -> who judges, the tolerance, and the fault.
BETWEEN: Mapping[str, tuple[Callable, float, Callable[[Result, float], Result]]] = {
    "beam-curve": (against_the_beam, 0.002, louder),
    "curve": (against_dolfinx, 0.005, after_the_peak),
    "peak": (against_dolfinx, 0.005, spike),
    "beam-curve of a foreign curve": (from_elsewhere("beam"), 0.002, louder),
    "curve of a foreign curve": (from_elsewhere("nurbs"), 0.005, after_the_peak),
    "peak of a foreign curve": (from_elsewhere("nurbs"), 0.005, spike),
    "end": (from_elsewhere("nurbs"), ROUNDING, short),
    "end of a comparison": (compared, ROUNDING, short),
    "curve-error": (compared, 0.005, wave),
    "peak-load": (compared, 0.005, spike),
    "energy": (compared, 0.005, unloads),
}


@pytest.mark.parametrize("name", BETWEEN)
def test_a_fault_of_a_curve(name: str) -> None:
    judged, tolerance, plant = BETWEEN[name]
    right = {check.name: check for check in judged(lambda result: result)}
    check = name.split(" of ")[0]
    assert first(right.values()) == "" and right[check].tolerance == tolerance
    assert first(judged(lambda result: plant(result, SIZE * tolerance))) == check


@pytest.mark.parametrize("number", range(len(BENCHMARK.published)))
def test_a_load_that_nobody_published(number: int) -> None:
    known, name = BENCHMARK.published[number], published_names(BENCHMARK)[number]
    opening = np.linspace(0.0, max(BENCHMARK.load.opening), 101)

    def judged(load: float) -> dict[str, Check]:
        run = Result("nurbs", {"opening": opening, "load": np.where(opening > 0.0, load, 0.0)})
        return {check.name: check for check in cross_checks(BENCHMARK, {"nurbs": run})}

    assert judged(np.mean(known.value))[name].state == "holds"
    assert judged(known.value[1] * (1.0 + SIZE * known.tolerance))[name].state == "broken"


def level(displacement: float, energy: float, rate: float) -> Level:
    return Level("", 1, 1, Errors(displacement, energy, energy), rate, rate - 1.0)


def of_plate(patch: float = 1e-14, last: float = 1e-5, energy: float = 1e-4, rate: float = 4.0) -> tuple[Check, ...]:
    levels = (level(1e-3, 1e-2, np.nan), level(1e-4, 1e-3, rate), level(last, energy, rate))
    return tuple(_checks("plate", Errors(patch, patch, patch), levels, 4))


def of_bases(rate: float = 4.0) -> tuple[Check, ...]:
    return rate_checks((Convergence(FAMILIES[0], (1, 2), (Errors(2.0**rate, 8.0, 8.0), Errors(1.0, 1.0, 1.0))),))


#: Check of a plane problem -> what it finds of a fault of ten tolerances.
IN_THE_PLANE: Mapping[str, Callable[[float], tuple[Check, ...]]] = {
    "patch-test": lambda size: of_plate(patch=size),
    "nested-energy": lambda size: of_plate(energy=1e-3 * (1.0 + size)),
    "exact-field": lambda size: of_plate(last=size),
    "rate": lambda size: of_plate(rate=4.0 - size),
    "rate of a basis": lambda size: of_bases(4.0 - size),
}


@pytest.mark.parametrize("name", IN_THE_PLANE)
def test_a_fault_in_the_plane(name: str) -> None:
    check, right = name.split(" of ")[0], of_bases() if "basis" in name else of_plate()
    assert first(right) == ""
    tolerance = next(one.tolerance for one in right if one.name == check)
    assert first(IN_THE_PLANE[name](SIZE * tolerance)) == check


# --- faults of the solver itself


@pytest.fixture
def small() -> Scene:
    return load_scene("dcb-czm1", ["discretization.dofs=1200", "discretization.steps=40", "load.opening=1.2"])


def test_a_law_of_a_larger_area(small: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """g_u 6 % too large, in traction and energies alike: the ledger closes, the cost of the crack is J's to tell."""
    assert first(run_checks(small, solve(small, "nurbs"))) == ""
    larger = property(lambda law: 1.06 * 2.0 * law.toughness / law.strength)
    monkeypatch.setattr(cohesive.BilinearLaw, "g_u", larger)
    assert first(run_checks(small, solve(small, "nurbs"))) == "j-integral"


def test_a_width_that_energies_do_not_have(small: Scene) -> None:
    """A run of a specimen that is 10 % wider: its forces balance, and J and its crack do not belong to this one."""
    wide = solve(load_scene("dcb-czm1", ["specimen.width=1.1", "load.opening=1.2", "discretization.steps=40"]), "nurbs")
    assert first(run_checks(small, wide)) == "j-integral"


def test_a_contact_that_is_left_out(small: Scene) -> None:
    """Without contact the far ends run through each other; what is compared is another problem, and the curve tells."""
    short = ["discretization.dofs=1200", "specimen.length=5.5", "load.opening=0.6", "discretization.steps=40"]
    scene = load_scene("dcb-czm1", short)
    loose = solve(load_scene("dcb-czm1", [*short, "effects.contact=false"]), "nurbs")
    assert first(cross_checks(scene, {"nurbs": loose, "beam": solve(scene, "beam")})) == "beam-curve"


# --- no check without a fault

PLANTED = {name.split(" of ")[0] for name in (*IN_A_RUN, *BETWEEN, *IN_THE_PLANE)}
#: Of a run that ended without a result, and the prefix of values that others published.
ELSEWHERE = {"completed", "published"}


def named_in(source: Path) -> set[str]:
    """Names of checks that a module spells out: first in a ``Check``, or in a row of a table of checks."""
    names = set()
    for node in ast.walk(ast.parse(source.read_text())):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Check":
            arguments = node.args[:1]
        elif source.name in ("checks.py", "compare.py") and isinstance(node, ast.Tuple) and len(node.elts) == 4:
            arguments = node.elts[:1]
        else:
            continue
        names |= {one.value for one in arguments if isinstance(one, ast.Constant) and isinstance(one.value, str)}
    return names


def test_every_check_has_its_fault() -> None:
    modules = [path for path in Path(verify.__file__).parent.glob("*.py") if "Check(" in path.read_text()]
    named = set().union(*(named_in(path) for path in modules))
    assert {"j-integral", "curve", "patch-test", "curve-error", "end"} <= named, "names are found"
    for name in sorted(named):
        assert name in PLANTED | ELSEWHERE, f"plant a fault for {name}"


def test_every_check_that_a_run_has_has_its_fault(runs: Mapping[str, Result]) -> None:
    found = [*of_run("dcb", runs["dcb"]), *of_run("peel", runs["peel"]), *against_the_beam(lambda result: result)]
    for check in found:
        assert check.kind == "regression" or check.name in PLANTED, f"plant a fault for {check.name}"
