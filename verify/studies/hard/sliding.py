"""Cases of bonds that slide: snap-back, reversed slip, friction under pressure, unequal arms, unequal stiffnesses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from verify.curves.curve import curve_error, envelope
from verify.curves.of_run import cubics
from verify.result import Result
from verify.scene.bond.mixed import mixed_bond
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.frame import corners
from verify.studies.hard import programmes
from verify.studies.hard.case import Case, Finding, Number, Trial, Trials, judged_by, runs
from verify.studies.hard.criteria import ROUNDED, cost_of_damage, distance, point_areas
from verify.verdict import Check

#: A mesh on which a run takes seconds; published values, which need the whole programme and a fine mesh, are left out.
_SMALL = ("published=[]", "discretization.dofs=1500")


@judged_by(
    "enf-snap-back",
    "A short precrack in bending: the deflection falls by itself as the bond slides apart.",
    runs("enf-as4peek", {"precrack-0.49": ("specimen.precrack=25.0",)}, *_SMALL),
)
def snap_back(trials: Trials) -> Iterator[Finding]:
    """Below a = 3^(-1/3) L the deflection at which a crack of length a grows falls with a."""
    for name, trial in trials.items():
        d = trial.result.opening
        fallen = float(np.max(np.maximum.accumulate(d) - d))
        meaning = "The deflection falls while the crack grows: 0 where it does, by a hundredth of the programme."
        yield Check("snaps-back", name, float(not fallen > 0.01 * d.max()), 0.0, "exact", meaning)
        yield _paid(trial)


def _paid(trial: Trial) -> Check:
    """Energy dissipated by damage against that of the law in pure sliding, independent of pressure and friction."""
    bond, found, steps = mixed_bond(trial.scene), trial.result.snapshots, trial.result.steps
    if bond is None or not found or found[-1].opening < max(trial.scene.load.opening):
        return Check("crack-cost", trial.name, float("nan"), 0.0, "exact", "The run has come to its last opening.")
    onset, critical = float(bond.onset_norm(1.0)), float(bond.critical(1.0))
    areas = point_areas(trial) * (found[-1].s_q > trial.scene.specimen.free_length)
    paid = cost_of_damage(areas, found[-1].damage_q, critical, 2.0 * critical / onset**2)
    spent = float(steps["dissipated_energy"][-1] - steps["friction_energy"][-1])
    meaning = "What damage has taken, over G_IIc times the new crack and its part in the zone."
    return Check("crack-cost", trial.name, spent / paid - 1.0 if paid else float("nan"), 0.01, "exact", meaning)


@judged_by(
    "mmb-stiff",
    "A stiff interface in mixed mode on a coarse mesh: tractions fade within an element.",
    runs(
        "mmb50-as4peek",
        {f"stiffness-1e{n}": (f"interface.stiffness=1e{n}", f"interface.shear_stiffness=1e{n}") for n in (5, 7)},
        "published=[]",
        "discretization.dofs=800",
        "load.opening=7.0",
    ),
)
def stiff(trials: Trials) -> Iterator[Finding]:
    away = distance(trials["stiffness-1e7"].result, trials["stiffness-1e5"].result)
    yield Number("distance", "stiffness-1e7", away, "Distance of the curves of a stiff and a soft interface.")


def _reversed() -> dict[str, Scene]:
    ways = {"one-way": "0.8", "to-and-fro": "[0.65, -0.65, -0.8]"}
    bent = {name: (f"load.opening={way}", "specimen.moments=[1.0, 1.0]") for name, way in ways.items()}
    rollers = {"enf": ("load.opening=[4.0, -1.0, 4.0]",), "enf-far": ("load.opening=[4.0, -3.0, 4.0]",)}
    return runs("moments", bent, *_SMALL)() | runs("enf-as4peek", rollers, *_SMALL)()


@judged_by(
    "slip-reverses",
    "The slip turns round under load, and where the arms are pulled up the bond opens instead.",
    _reversed,
)
def reverses(trials: Trials) -> Iterator[Finding]:
    """With two equal arms that slide and small displacements the load is an odd function of the opening, also with
    constant damage.

    An end-notched flexure on two supports below the lower arm opens when it is pulled up: its precrack is not closed.
    Below zero no crack grows: the load is linear on each side of zero, and returns to its value on reloading.
    """
    slid, one_way, pulled = (trials[name] for name in ("to-and-fro", "one-way", "enf"))
    P, at = slid.result.load, corners(slid.result.opening, slid.scene.load.opening)
    odd = P[at[0]] / P[at[1]] + 1.0 if len(at) > 1 else float("nan")
    yield Check("odd", "to-and-fro", odd, 1e-6, "exact", "As far on the other side, the load is the same.")
    away = -P[-1] / one_way.result.load[-1] - 1.0
    yield Check("same-end", "to-and-fro", away, 0.002, "regression", "Its end is that of the way without turns.")
    d, P = pulled.result.opening, pulled.result.load
    at, low = corners(d, pulled.scene.load.opening), np.flatnonzero(d < -0.02)
    if len(at) < 3:
        yield Check("legs", "enf", float("nan"), 0.0, "exact", "All legs of the programme were run.")
        return
    straight = float(np.ptp(P[low] / d[low]) / np.max(P[low] / d[low]))
    yield Check("secant", "enf", straight, 1e-6, "exact", "Pulled up, the load is proportional to the deflection.")
    back = P[at[2]] / P[at[0]] - 1.0
    yield Check("return", "enf", back, 1e-6, "exact", "Reloaded to where it unloaded, the load is what it was.")


#: Force that presses the arms of an end-notched flexure together around the tip, over the load.
_PRESSED = 5.0
_LOADS = (
    '{body="upper", side="top", share=-1.0, at=[50.5, 51.5]}',
    f'{{body="upper", side="top", share={-_PRESSED}, at=[36.0, 46.0]}}',
    f'{{body="lower", side="bottom", share={_PRESSED}, at=[36.0, 46.0]}}',
)
_SUPPORTS = '{body="lower", side="bottom", at=[0.0, 0.5]}, {body="lower", side="bottom", at=[101.5, 102.0]}'
_SPECIMEN = (
    'specimen={kind="delamination", length=102.0, arm_thickness=1.56, precrack=39.3, width=25.4, plane="strain", '
    f"loads=[{', '.join(_LOADS)}], supports=[{_SUPPORTS}]}}"
)


@judged_by(
    "pressed-shear",
    "The arms are pressed together where the bond slides, with friction and without.",
    runs(
        "enf-as4peek",
        {f"friction-{mu}": (f"interface.friction={mu}",) for mu in (0.0, 0.3)},
        *_SMALL,
        _SPECIMEN,
        "load.opening=5.0",
    ),
)
def pressed(trials: Trials) -> Iterator[Finding]:
    yield from map(_paid, trials.values())
    smooth, rough = (trials[f"friction-{mu}"].result for mu in (0.0, 0.3))
    yield Check("smooth", "friction-0.0", _part(smooth), ROUNDED, "exact", "Without friction none takes energy.")
    lower = float(not np.max(rough.load) > np.max(smooth.load))
    yield Check("holds", "friction-0.3", lower, 0.0, "exact", "Friction raises the peak: 0 where it does.")
    yield Number("friction", "friction-0.3", _part(rough), "What friction takes, over all that is dissipated.")


def _part(result: Result) -> float:
    steps = result.steps
    return float(steps["friction_energy"][-1] / max(abs(steps["dissipated_energy"][-1]), 1e-300))


_OTHER = "{E1=60e3, E2=8e3, G12=4e3, nu12=0.3, nu23=0.45}"
_OWN = "{E1=122.7e3, E2=10.1e3, G12=5.5e3, nu12=0.25, nu23=0.45}"


def _unequal() -> dict[str, Scene]:
    """A specimen bent by moments, the same specimen upside down, and one bent on rollers."""
    ways = {"upright": ("3.0, 1.56", f"{_OWN}, {_OTHER}", "1.0, 0.1", "upper"),
            "upside-down": ("1.56, 3.0", f"{_OTHER}, {_OWN}", "-0.1, -1.0", "lower")}  # fmt: skip
    keys = "specimen.arm_thickness=[{}]", "material=[{}]", "specimen.moments=[{}]", "discretization.slave={}"
    turned = {name: [key.format(value) for key, value in zip(keys, way, strict=True)] for name, way in ways.items()}
    rollers = ("specimen.arm_thickness=[3.0, 1.56]", f"material=[{_OWN}, {_OTHER}]", "load.opening=4.0")
    bent = runs("moments", turned, *_SMALL, "load.opening=0.3")()
    return bent | {"rollers": load_scene("enf-as4peek", (*_SMALL, *rollers))}


@judged_by("unequal-stiffness", "Arms of two thicknesses and two materials: slip and opening at once.", _unequal)
def unequal(trials: Trials) -> Iterator[Finding]:
    upright, turned = (trials[name].result for name in ("upright", "upside-down"))
    end = min(float(np.max(envelope(*cubics(one))[0])) for one in (upright, turned))
    away = curve_error(cubics(turned), cubics(upright), end)
    yield Check("same-curve", "upside-down", away, 0.002, "regression", "Upside down the curve is the same.")
    first, second = (one.load[1] / one.opening[1] for one in (upright, turned))
    meaning = "Upside down the stiffness is the same, as far as the condition of the system allows."
    yield Check("same-stiffness", "upside-down", second / first - 1.0, 1e-6, "exact", meaning)


unload_slip = Case(
    "unload-slip",
    "Unloaded at full slip, and loaded again.",
    runs(
        "enf-as4peek",
        {"monotone-linear": ("load.opening=6.0",), "to-zero-linear": ("load.opening=[4.0, 0.0, 4.0, 6.0]",)},
        "published=[]",
        "discretization.dofs=2400",  # fine enough for Lagrange elements to meet the tolerance on the envelope
    ),
    programmes.unload.judge,
)

#: Ks / K, and sqrt(K Ks): with a lower one the toughness would be used up before the strength is reached.
_RATIOS, _STIFFNESS = (1e-3, 1e-1, 1e1, 1e3), 1.2e5

ratio = Case(
    "stiffness-ratio",
    "The bond is a thousand times as stiff on sliding as on opening, and the other way round.",
    runs(
        "mmb50-as4peek",
        {
            f"ratio-{r:g}": (
                f"interface.stiffness={_STIFFNESS / r**0.5}",
                f"interface.shear_stiffness={_STIFFNESS * r**0.5}",
            )
            for r in _RATIOS
        },
        *_SMALL,
    ),
)


def _one_to_ten() -> dict[str, Scene]:
    # on such a mesh the indentation of narrower rollers would spoil the slope at the load, and so J of the loads
    common = (*_SMALL, "specimen.arm_thickness=[0.4, 4.0]")
    bent = load_scene("moments", (*common, "specimen.moments=[1.0, 500.0]", "load.opening=0.3"))
    return {"rollers": load_scene("enf-as4peek", (*common, "specimen.roller=3.0")), "moments": bent}


one_to_ten = Case("arms-1-10", "One arm is ten times as thick as the other.", _one_to_ten)
