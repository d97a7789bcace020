"""Right runs break no check, and wrong ones do: scene x method x identity, solved anew; some of them are recorded."""

from __future__ import annotations

import json
from collections.abc import Mapping

import numpy as np
import pytest
from recorded_runs import CLOSING, NET, PEEL, RUNS, SMALL, STOCKY, recorded, told

from iga.laws.law import History, Law
from iga.system.system import rounding
from tests.verify.checks.faults import changed, failed, judged
from verify.checks.mechanics import balance
from verify.checks.mechanics.peel_growth import away_from_flush_end, growing
from verify.checks.mechanics.penetration import penetration
from verify.curves.curve import point_distances
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.solve import prepare, solve
from verify.scene.load import load_scene

slow = pytest.mark.slow
#: Runs that are solved anew in the fast tests as well: every basis, unloading, contact, sliding, finite rotations.
QUICK = ("pressed", "stocky", "closing-peel", "slid", "unloaded")

#: A stocky specimen of carbon and epoxy; a strip on a substrate of 10, whose process zone stresses the flush end.
ORTHOTROPIC = (
    "dcb-czm1",
    "specimen={kind='dcb', length=50.0, arm_thickness=4.0, precrack=16.0, width=20.0, plane='strain'}",
    "material={E1=150e3, E2=8e3, G12=3e3, nu12=0.3, nu23=0.5}",
    "interface={strength=30.0, toughness=0.4}",
    "discretization.dofs=900",
)
THICK = (
    "peel-60", "specimen.strip_length=60", "specimen.strip_thickness=4", "specimen.substrate_length=50",
    "specimen.bond_length=40", "strip.young=70e3", "strip.poisson=0.3", "substrate.young=10e3",
    "substrate.poisson=0.3", "interface.strength=20", "interface.toughness=1", "interface.ductility=10",
    "interface.penalty=1e5", "load.opening=3", "discretization.steps=100",
)  # fmt: skip
LONG = (
    "dcb-czm1-linear", "specimen.length=114.06236909598474", "specimen.arm_thickness=1",
    "specimen.precrack=56.228538432247156", "material.young=1e5", "material.poisson=0.3244093595137369",
    "interface.toughness=0.48117285123914466", "interface.strength=0.1628493795958447",
    "interface.ductility=2.017008049533789", "interface.penalty=1e5", "load.opening=36.77040374733115",
    "discretization.steps=80",
)  # fmt: skip
TIED = (
    "dcb-czm1", "specimen.length=13.357", "specimen.arm_thickness=1", "specimen.precrack=4.198",
    "specimen.plane='strain'", "material.young=33.8e3", "material.poisson=0.02", "interface.strength=181.4",
    "interface.toughness=35.13", "interface.ductility=35.6", "load.opening=1.976", "discretization.steps=40",
)  # fmt: skip
SLENDER = "dcb-czm1", "specimen.arm_thickness=0.05", "load.opening=8", "discretization.steps=40"
VERY_SLENDER = "dcb-czm1-linear", "specimen.arm_thickness=0.02", "load.opening=20", "discretization.steps=40"
#: Ligaments as long as 0.8 to 3.4 process zones, on contact that is much stiffer than the bond.
LIGAMENTS = [
    (f"specimen.length={4.0 + ligament}", f"interface.penalty={penalty}")
    for ligament, penalty in ((0.7, 1e6), (0.7, 1e8), (1.5, 1e7), (3.0, 1e6))
]

#: Scene with overrides, method, and identities that may be unresolved.
RIGHT: list[tuple[tuple[str, ...], str, str]] = [
    (CLOSING, "nurbs", ""),
    ((*CLOSING, "effects.symmetry=true"), "tspline", ""),
    ((*CLOSING, "discretization.interface_rule=lumped"), "nurbs", ""),
    ((*CLOSING, "discretization.adaptive=true"), "tspline", ""),
    ((*CLOSING, "discretization.slave=lower", "discretization.mismatch=1.37"), "nurbs", ""),
    ((*CLOSING, "effects.kinematics=finite", "load.opening=[-0.002, 0.5]"), "nurbs", ""),
    (CLOSING, "dolfinx", ""),
    (PEEL, "tspline", ""),
    ((*PEEL, "discretization.dofs=3700"), "dolfinx", ""),
    (("dcb-czm1-linear", "discretization.steps=40", "load.opening=[0.6, 0.05, 0.0, 0.8]"), "nurbs", ""),
    ((*PEEL, "load.opening=[0.6, 0.05, 0.0, 0.8]"), "nurbs", ""),
    (("dcb-czm1-linear", "load.opening=[1.0, 0.0, 0.6, -0.05, 1.5]"), "nurbs", ""),
    ((*ORTHOTROPIC, "effects.kinematics=finite", "load.opening=1.2"), "nurbs", "j-integral"),
    ((*ORTHOTROPIC, "effects.kinematics=finite", "load.opening=[0.3, 0.03, 0.5]"), "nurbs", "j-integral"),
    ((*ORTHOTROPIC, "effects.kinematics=finite", "load.opening=[0.3, 0.03, 0.5]"), "lagrange", "j-integral"),
    ((*STOCKY, "effects.kinematics=finite", "load.opening=[0.3, 0.05, 0.9]"), "tspline", "j-integral"),
    (("dcb-czm1", "discretization.dofs=900", "load.opening=[2.0, 0.4, 4.0]"), "nurbs", "j-integral"),
    (("enf-as4peek", "load.opening=[3.5, 0.35]"), "nurbs", ""),
    (("slb", "load.opening=[2.0, 0.2]"), "nurbs", ""),
    (("peel-60", "discretization.dofs=2400"), "tspline", ""),
    (("peel-60", "discretization.dofs=2400"), "nurbs", ""),
    (("peel-soft", "discretization.steps=15"), "nurbs", "j-integral"),
    (THICK, "beam", ""),
    (THICK, "nurbs", ""),
    (("dcb-czm1", "discretization.dofs=300", "interface.strength=7.5"), "lagrange", "j-integral dissipation"),
    (SLENDER, "dolfinx", "j-integral"),
    (SLENDER, "nurbs", "j-integral"),
    (VERY_SLENDER, "dolfinx", "j-integral"),
    (LONG, "lagrange", "j-integral dissipation"),
    (("dcb-czm1", "interface.penalty=1e10", "discretization.steps=40"), "dolfinx", "j-integral"),
    (TIED, "nurbs", "j-integral"),
    (TIED, "tspline", "j-integral"),
    *(
        ((*SMALL, "load.opening=0.6", *words), method, "j-integral")
        for method in ("beam", "nurbs", "tspline", "lagrange", "dolfinx")
        for words in LIGAMENTS
    ),
]

#: Column -> checks that one of must find it ten times beyond their tolerances off.
COLUMNS: Mapping[str, tuple[str, ...]] = {
    "interface_force": ("interface-force",),
    "interface_moment": ("moment-balance",),
    "reaction_y": ("reactions",),
}


@slow
@pytest.mark.parametrize(("words", "method", "coarse"), RIGHT)
def test_a_right_run_breaks_nothing_and_every_planted_fault_does(words, method, coarse):
    if method == "dolfinx" and not dolfinx_installed():
        pytest.skip("DOLFINx is not installed")
    scene = load_scene(words[0], words[1:])
    run = solve(scene, method)
    found = judged(scene, run)
    assert run.complete and {check.state for check in found.values()} <= {"holds", "unresolved"}, found
    assert {name for name, check in found.items() if check.state == "unresolved"} <= set(coarse.split())
    peak = abs(run.load).max()
    for column, (check,) in COLUMNS.items():
        if check in found and "support_1" not in run.steps:  # on rollers the reactions are those of each
            lever = scene.specimen.free_length if check == "moment-balance" else 1.0
            wrong = changed(run, column, shift=10.0 * found[check].tolerance * lever * peak)
            assert failed(scene, wrong) - failed(scene, run) == {check}
    if "j-integral" in found:
        gross = changed(run, ("face_slope_top", "face_slope_bottom"), 100.0)
        assert judged(scene, gross)["j-integral"].state == "broken"
    if "penetration" in found:
        assert judged(scene, changed(run, "penetration", 100.0))["penetration"].state in ("broken", "holds")


@slow
@pytest.mark.parametrize("name", json.loads(NET.read_text()) if NET.exists() else ())
def test_packaged_scenes_give_the_recorded_curves(name):
    """Of every method that solves them, between steps that rounding moves: on another machine the recorded tree differs
    by 7e-4 of the peak in a load behind it. Steps of splines end on the peak."""
    for method, then in json.loads(NET.read_text())[name].items():
        now, ends_there = told(name, method), method in ("nurbs", "tspline", "lagrange")
        assert now[0] == then[0] and now[1] == pytest.approx(then[1], rel=1e-6 if ends_there else 1e-3), method
        assert now[2:4] == pytest.approx(then[2:4], rel=1e-3, abs=1e-3 * then[2]), method
        assert now[4:] == pytest.approx(then[4:], rel=1e-3, abs=1e-3 * then[1], nan_ok=True), method


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in QUICK else slow) for name in RUNS])
def test_recorded_runs_are_those_of_today(name):
    (scene, *words), method = RUNS[name]
    then, now = recorded(name), solve(load_scene(scene, words), method)
    assert (now.status, now.dofs, now.elements) == (then.status, then.dofs, then.elements)
    assert now.steps.keys() == then.steps.keys()
    size = float(np.abs(then.opening).max()), float(np.abs(then.load).max())
    assert point_distances((now.opening, now.load), (then.opening, then.load), size).max() < 1e-3
    same = now.opening.shape == then.opening.shape and np.allclose(now.opening, then.opening, atol=1e-6 * size[0])
    if method == "beam" or not same:  # steps are chosen anew where rounding changes
        return
    for column, values in then.steps.items():
        rounding = 1e-6 * float(np.max(np.abs(values))) + 1e-8 * size[1]  # a balance is what Newton leaves
        np.testing.assert_allclose(now.steps[column], values, rtol=1e-6, atol=rounding, err_msg=column)


@slow
@pytest.mark.parametrize(("words", "method"), [(CLOSING, "nurbs"), (PEEL, "tspline"), (CLOSING, "dolfinx")])
def test_faces_without_contact_beyond_the_bond_are_found(words, method, monkeypatch):
    """Planted in the solvers: of all checks this one alone sees the bodies pass through each other."""
    if method == "dolfinx" and not dolfinx_installed():
        pytest.skip("DOLFINx is not installed")
    scene = load_scene(words[0], words[1:])
    monkeypatch.setattr("iga.specimen.specimen.touches", lambda problem: False)
    monkeypatch.setattr("fem_reference.problem.delamination.Problem.presses", False)
    run = solve(scene, method)
    assert penetration(scene, run.steps) > 10.0 and failed(scene, run) == {"penetration"}


@slow
@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_a_bond_that_keeps_an_opening(kinematics, monkeypatch):
    """Its points unload 3 % steeper than along their secants, in the solver itself."""
    respond = Law.respond

    def steep(self: Law, jump: np.ndarray, past: History, *more):
        p, slope, (k, _) = respond(self, jump, past, *more)
        g, stiff = jump[:, 0], self.kept(k)[0] * self.stiffness[0]
        unloads = (g > 0.0) & (g < k) & (k > self.g_max)
        p[unloads, 0], slope[unloads, 0, 0] = (stiff * (1.03 * g - 0.03 * k))[unloads], 1.03 * stiff[unloads]
        return p, slope, History(k)

    monkeypatch.setattr(Law, "respond", steep)
    scene = load_scene(STOCKY[0], [*STOCKY[1:], f"effects.kinematics={kinematics}"])
    assert judged(scene, solve(scene, "nurbs"))["secant"].state == "broken"


#: Specimens whose faces bulge into each other on long elements: overrides, method, unknowns.
BULGING: Mapping[str, tuple[str, ...]] = {
    "thin": ("load.opening=[1.2, 0.3, 2.0, 0.0, 3.0]", "effects.kinematics=linear"),
    "stiff contact": (
        "specimen={kind='dcb', length=40.0, arm_thickness=1.0, precrack=12.0}",
        "material={young=70e3, poisson=0.3}",
        "interface={strength=12.0, toughness=0.15, penalty=1e6}",
        "load.opening=[1.2, 0.0, 2.0]",
        "effects.kinematics=linear",
    ),
    "orthotropic": (
        "specimen={kind='dcb', length=50.0, arm_thickness=1.5, precrack=16.0, width=20.0, plane='strain'}",
        "material={E1=150e3, E2=8e3, G12=3e3, nu12=0.3, nu23=0.5}",
        "interface={strength=30.0, toughness=0.3}",
        "load.opening=[1.0, -0.002, 2.0]",
        "effects.kinematics=linear",
    ),
    "far turned": ("load.opening=[1.5, 0.0, 2.5, 0.0]",),
}


@slow
@pytest.mark.parametrize(
    ("name", "method", "dofs", "planted", "state"),
    [
        ("thin", "lagrange", 900, "", "unresolved"),
        ("thin", "lagrange", 500, "", "unresolved"),
        ("thin", "nurbs", 300, "", "unresolved"),
        ("stiff contact", "lagrange", 400, "", "unresolved"),
        ("orthotropic", "lagrange", 400, "", "unresolved"),
        ("far turned", "lagrange", 700, "", "unresolved"),
        ("thin", "nurbs", 1956, "effects.contact=false", "broken"),
        ("thin", "nurbs", 1956, "interface.penalty=1e4", "broken"),
        ("thin", "lagrange", 900, "effects.contact=false", "broken"),
        ("thin", "lagrange", 900, "interface.penalty=1e4", "broken"),
        ("thin", "lagrange", 300, "effects.contact=false", "broken"),
    ],
)
def test_faces_of_long_elements_bulge_into_each_other_and_a_fault_of_the_contact_is_none_of_the_mesh(
    name, method, dofs, planted, state
):
    def found(dofs: int):
        words = [*BULGING[name], f"discretization.dofs={dofs}"]
        run = solve(load_scene("dcb-czm1", [*words, *planted.split()]), method)
        return judged(load_scene("dcb-czm1", words), run)["penetration"]

    check = found(dofs)
    assert check.state == state
    if state == "unresolved":
        resolved = int(check.unresolved.rpartition("discretization.dofs = ")[2].split()[0])
        assert resolved > dofs and found(resolved).state == "holds"


@slow
@pytest.mark.parametrize("words", [CLOSING, (*PEEL, "discretization.dofs=3700")])
def test_both_codes_press_alike(words):
    if not dolfinx_installed():
        pytest.skip("DOLFINx is not installed")
    scene = load_scene(words[0], words[1:])
    ours, theirs = (solve(scene, method) for method in ("nurbs", "dolfinx"))
    for opening in scene.load.opening:
        loads = [run.load[np.flatnonzero(run.opening == opening)[0]] for run in (ours, theirs)]
        assert loads[0] == pytest.approx(loads[1], rel=0.005)


@slow
def test_a_zone_that_the_flush_end_feels_is_no_steady_growth():
    scene = load_scene(THICK[0], THICK[1:])
    run = solve(scene, "nurbs")
    last = np.flatnonzero(growing(scene, run.steps))[-1]
    assert not away_from_flush_end(scene, run.steps)[last]
    assert run.load[last] * abs(run.steps["face_slope_top"][last]) < 0.95 * scene.interface.toughness
    for factor in (0.9, 1.1):
        wrong = changed(changed(run, "face_slope_top", factor), "tip_opening", 2.0)
        assert "growth-angle" in failed(scene, wrong), "ten times the tolerance"


@slow
def test_near_incompressibility_leaves_as_much_as_newton_accepts(monkeypatch):
    """The floor of Newton, at which `iga` takes a residual for rounding, grows with 1 / (1 - 2 nu)."""
    seen: list[float] = []

    def seeing(system, u_d, response) -> float:
        seen.append(rounding(system, u_d, response))
        return seen[-1]

    monkeypatch.setattr("iga.path.newton.rounding", seeing)
    for nu in (0.3, 0.4999):
        changes = ["specimen.plane=strain", f"material.poisson={nu}", "discretization.dofs=700", "load.opening=1"]
        scene, _ = load_scene("dcb-czm1", changes), seen.clear()
        run = solve(scene, "nurbs")
        floor = max(seen) / abs(run.load).max()
        assert floor < balance.force_tolerance(prepare(scene, "nurbs"), run) < 5.0 * floor
