"""Cases of bonds that slide: snap-back, reversed slip, friction under pressure, unequal arms, unequal stiffnesses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from verify.checks.mechanics import mixed
from verify.curves.curve import curve_error, envelope
from verify.curves.of_run import cubics
from verify.result import Result
from verify.scene.bond.mixed import mixed_bond
from verify.studies.hard.case import Case, Finding, Number, Trial, Trials, Variant, no_judge, variant, variants
from verify.studies.hard.criteria import dissipated_by_damage, distance, point_areas
from verify.studies.hard.programmes import judge_unload
from verify.verdict import Check

#: A mesh on which a run takes seconds; published values, which need the whole programme and a fine mesh, are left out.
_SMALL = ("published=[]", "discretization.dofs=1500")
#: Rounding, over the largest damage or energy.
_ROUNDED = 1e-9


def of_a_bond(judge: Callable[[Trials], Iterator[Finding]] = no_judge) -> Callable[[Trials], Iterator[Finding]]:
    """The criteria of a case, and for every run: damage does not heal, and energy of friction is not regained."""

    def both(trials: Trials) -> Iterator[Finding]:
        for trial in trials.values():
            yield from _never_back(trial)
        yield from judge(trials)

    return both


def _never_back(trial: Trial) -> Iterator[Finding]:
    """Damage of every point never falls from one snapshot to the next, nor dissipated energy from step to step.

    The part of damage alone is not checked: with friction it may fall, as the springs of friction store more while
    damage grows.
    """
    steps, taken = trial.result.steps, trial.result.snapshots
    if len(taken) > 1:
        back = max(float(np.max(a.damage_q - b.damage_q)) for a, b in zip(taken[:-1], taken[1:], strict=True))
        yield Check("no-healing", trial.name, max(back, 0.0), _ROUNDED, "exact", "The damage of no point ever falls.")
    if steps["load"].size > 1:
        whole = float(np.max(np.abs(steps["external_work"])))
        for name in ("dissipated_energy", "friction_energy"):
            back = max(0.0, -float(np.min(np.diff(steps[name])))) / whole
            meaning = "It never comes back: largest fall from step to step, over the external work."
            yield Check(name.replace("_", "-"), trial.name, back, _ROUNDED, "exact", meaning)


_snap_back = variants("enf-as4peek", {"precrack-0.49": ("specimen.precrack=25.0",)}, *_SMALL)


def _judge_snap_back(trials: Trials) -> Iterator[Finding]:
    """Below a = 3^(-1/3) L the deflection at which a crack of length a grows falls with a."""
    for name, trial in trials.items():
        d = trial.result.opening
        fallen = float(np.max(np.maximum.accumulate(d) - d))
        meaning = "The deflection falls while the crack grows: 0 where it does, by a hundredth of the programme."
        yield Check("snaps-back", name, 0.0 if fallen > 0.01 * d.max() else 1.0, 0.0, "exact", meaning)
        yield from _paid(trial)


def _paid(trial: Trial) -> Iterator[Finding]:
    """Energy dissipated by damage against that of the law. In pure sliding a point with damage d has dissipated
    ``G_IIc (l - l0) / (lf - l0)``, ``l = l0 lf / (lf - d (lf - l0))``, with the jumps l0 and lf of onset and failure,
    independent of pressure and friction."""
    bond, found = mixed_bond(trial.scene), trial.result.snapshots
    if bond is None or not found or found[-1].opening < max(trial.scene.load.opening):
        yield Check("crack-cost", trial.name, float("nan"), 0.0, "exact", "The run has come to its last opening.")
        return
    first, critical = float(bond.onset_norm(1.0)), float(bond.critical(1.0))
    last, snapshot, scene = 2.0 * critical / first, found[-1], trial.scene
    bonded = snapshot.s_q > scene.specimen.free_length
    d_q = snapshot.damage_q
    jump_q = first * last / (last - d_q * (last - first))
    paid = float((point_areas(trial) * bonded * (d_q > 0.0)) @ (critical * (jump_q - first) / (last - first)))
    spent = float(dissipated_by_damage(trial.result.steps)[-1])
    meaning = "What damage has taken, over G_IIc times the new crack and its part in the zone."
    yield Check("crack-cost", trial.name, spent / paid - 1.0 if paid else float("nan"), 0.01, "exact", meaning)


_stiff = variants(
    "mmb50-as4peek",
    {f"stiffness-1e{n}": (f"interface.stiffness=1e{n}", f"interface.shear_stiffness=1e{n}") for n in (5, 7)},
    "published=[]",
    "discretization.dofs=800",
    "load.opening=7.0",
)


def _judge_stiff(trials: Trials) -> Iterator[Finding]:
    away = distance(trials["stiffness-1e7"].result, trials["stiffness-1e5"].result)
    yield Number("distance", "stiffness-1e7", away, "Distance of the curves of a stiff and a soft interface.")


_reverses = variants(
    "moments",
    {"one-way": ("load.opening=0.8",), "to-and-fro": ("load.opening=[0.65, -0.65, -0.8]",)},
    *_SMALL,
    "specimen.moments=[1.0, 1.0]",
)


def _reversed() -> Sequence[Variant]:
    ways = {"enf": "[4.0, -1.0, 4.0]", "enf-far": "[4.0, -3.0, 4.0]"}
    rollers = [variant(name, "enf-as4peek", f"load.opening={way}", *_SMALL) for name, way in ways.items()]
    return [*_reverses(), *rollers]


def _judge_reversed(trials: Trials) -> Iterator[Finding]:
    """With two equal arms that slide and small displacements the load is an odd function of the opening, also with
    constant damage.

    An end-notched flexure on two supports below the lower arm opens when it is pulled up: its precrack is not closed.
    """
    slid, one_way = trials["to-and-fro"].result, trials["one-way"].result
    d, P = slid.opening, slid.load
    there = np.flatnonzero(np.abs(np.abs(d) - 0.65) <= 1e-9)
    at = [i for i in there if d[i] > 0.0][:1] + [i for i in there if d[i] < 0.0][-1:]
    odd = P[at[0]] / P[at[1]] + 1.0 if len(at) == 2 else float("nan")
    yield Check("odd", "to-and-fro", odd, 1e-6, "exact", "As far on the other side, the load is the same.")
    away = -P[-1] / one_way.load[-1] - 1.0
    yield Check("same-end", "to-and-fro", away, 0.002, "regression", "Its end is that of the way without turns.")
    yield from _pulled_up(trials["enf"])


def _pulled_up(trial: Trial) -> Iterator[Finding]:
    """Below zero no crack grows: the load is linear on each side of zero, and returns to its value on reloading."""
    d, P = trial.result.opening, trial.result.load
    turns = np.flatnonzero(np.abs(d - 4.0) <= 1e-9)
    low = np.flatnonzero(d < -0.02)
    if turns.size < 2 or not low.size:
        yield Check("legs", trial.name, float("nan"), 0.0, "exact", "All legs of the programme were run.")
        return
    straight = float(np.ptp(P[low] / d[low]) / np.max(P[low] / d[low]))
    yield Check("secant", trial.name, straight, 1e-6, "exact", "Pulled up, the load is proportional to the deflection.")
    back = P[turns[-1]] / P[turns[0]] - 1.0
    yield Check("return", trial.name, back, 1e-6, "exact", "Reloaded to where it unloaded, the load is what it was.")


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
_pressed = variants(
    "enf-as4peek",
    {f"friction-{mu}": (f"interface.friction={mu}",) for mu in (0.0, 0.3)},
    *_SMALL,
    _SPECIMEN,
    "load.opening=5.0",
)


def _judge_pressed(trials: Trials) -> Iterator[Finding]:
    for trial in trials.values():
        yield from _paid(trial)
    smooth, rough = (trials[f"friction-{mu}"].result for mu in (0.0, 0.3))
    yield Check("smooth", "friction-0.0", _part(smooth), _ROUNDED, "exact", "Without friction none takes energy.")
    higher = float(np.max(rough.load) > np.max(smooth.load))
    yield Check("holds", "friction-0.3", 1.0 - higher, 0.0, "exact", "Friction raises the peak: 0 where it does.")
    yield Number("friction", "friction-0.3", _part(rough), "What friction takes, over all that is dissipated.")


def _part(result: Result) -> float:
    steps = result.steps
    return float(steps["friction_energy"][-1] / max(abs(steps["dissipated_energy"][-1]), 1e-300))


_OTHER = "{E1=60e3, E2=8e3, G12=4e3, nu12=0.3, nu23=0.45}"
_OWN = "{E1=122.7e3, E2=10.1e3, G12=5.5e3, nu12=0.25, nu23=0.45}"


def _unequal() -> Sequence[Variant]:
    """A specimen bent by moments, the same specimen upside down, and one bent on rollers."""
    ways = {"upright": ("3.0, 1.56", _OWN, _OTHER, "1.0, 0.1", "upper"),
            "upside-down": ("1.56, 3.0", _OTHER, _OWN, "-0.1, -1.0", "lower")}  # fmt: skip
    turned = [
        variant(
            name,
            "moments",
            *_SMALL,
            f"specimen.arm_thickness=[{h}]",
            f"material=[{upper}, {lower}]",
            f"specimen.moments=[{moments}]",
            f"discretization.slave={slave}",
            "load.opening=0.3",
        )
        for name, (h, upper, lower, moments, slave) in ways.items()
    ]
    rollers = ("specimen.arm_thickness=[3.0, 1.56]", f"material=[{_OWN}, {_OTHER}]", "load.opening=4.0")
    return [*turned, variant("rollers", "enf-as4peek", *_SMALL, *rollers)]


def _judge_unequal(trials: Trials) -> Iterator[Finding]:
    upright, turned = (cubics(trials[name].result) for name in ("upright", "upside-down"))
    end = min(float(np.max(envelope(*curve)[0])) for curve in (upright, turned))
    away = curve_error(turned, upright, end)
    yield Check("same-curve", "upside-down", away, 0.002, "regression", "Upside down the curve is the same.")
    first, second = (
        trials[name].result.load[1] / trials[name].result.opening[1] for name in ("upright", "upside-down")
    )
    meaning = "Upside down the stiffness is the same, as far as the condition of the system allows."
    yield Check("same-stiffness", "upside-down", second / first - 1.0, 1e-6, "exact", meaning)


_unload = variants(
    "enf-as4peek",
    {"monotone-linear": ("load.opening=6.0",), "to-zero-linear": ("load.opening=[4.0, 0.0, 4.0, 6.0]",)},
    "published=[]",
    "discretization.dofs=2400",  # fine enough for Lagrange elements to meet the tolerance on the envelope
)

#: Ks / K, and sqrt(K Ks): with a lower one the toughness would be used up before the strength is reached.
_RATIOS, _STIFFNESS = (1e-3, 1e-1, 1e1, 1e3), 1.2e5
_ratio = variants(
    "mmb50-as4peek",
    {
        f"ratio-{r:g}": (
            f"interface.stiffness={_STIFFNESS / r**0.5}",
            f"interface.shear_stiffness={_STIFFNESS * r**0.5}",
        )
        for r in _RATIOS
    },
    *_SMALL,
)


def _one_to_ten() -> Sequence[Variant]:
    # on such a mesh the indentation of narrower rollers would spoil the slope at the load, and so J of the loads
    thin = "specimen.arm_thickness=[0.4, 4.0]"
    bent = variant("moments", "moments", *_SMALL, thin, "specimen.moments=[1.0, 500.0]", "load.opening=0.3")
    return [variant("rollers", "enf-as4peek", *_SMALL, thin, "specimen.roller=3.0"), bent]


def _judge_one_to_ten(trials: Trials) -> Iterator[Finding]:
    trial = trials["moments"]
    gap = mixed.moments_gap(trial.scene, trial.result.steps)
    meaning = "J is that of the end moments on both arms."
    yield Check("moments", "moments", float("nan") if gap is None else gap, 0.003, "analytical", meaning)


SLIDING_CASES = (
    Case(
        "enf-snap-back",
        "A short precrack in bending: the deflection falls by itself as the bond slides apart.",
        _snap_back,
        of_a_bond(_judge_snap_back),
    ),
    Case(
        "mmb-stiff",
        "A stiff interface in mixed mode on a coarse mesh: tractions fade within an element.",
        _stiff,
        of_a_bond(_judge_stiff),
    ),
    Case(
        "slip-reverses",
        "The slip turns round under load, and where the arms are pulled up the bond opens instead.",
        _reversed,
        of_a_bond(_judge_reversed),
    ),
    Case(
        "pressed-shear",
        "The arms are pressed together where the bond slides, with friction and without.",
        _pressed,
        of_a_bond(_judge_pressed),
    ),
    Case(
        "unequal-stiffness",
        "Arms of two thicknesses and two materials: slip and opening at once.",
        _unequal,
        of_a_bond(_judge_unequal),
    ),
    Case("unload-slip", "Unloaded at full slip, and loaded again.", _unload, of_a_bond(judge_unload)),
    Case(
        "stiffness-ratio",
        "The bond is a thousand times as stiff on sliding as on opening, and the other way round.",
        _ratio,
        of_a_bond(),
    ),
    Case("arms-1-10", "One arm is ten times as thick as the other.", _one_to_ten, of_a_bond(_judge_one_to_ten)),
)
