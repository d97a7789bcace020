"""The bridging law of a DCB by its curve, corrected by what beam theory misses on the curve of the law itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from verify.methods.solve import solve
from verify.reduction.bridging import FallingLaw, falling, from_onset, seen
from verify.reduction.corrections import smooth
from verify.reduction.data import of_steps
from verify.reduction.reduce import Reduction, reduce
from verify.scene.laws import TABULAR
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.studies.reduce.fit import FITTED_BY, FITTING, moduli
from verify.support.progress import Progress
from verify.support.refusal import Refusal

#: Corrections of J, end opening, modulus and elastic part, each by a solution: at least and at most, and the stiffness
#: over that of the test, less one, with which they end. The third changes a law by less than 1 %.
CORRECTIONS, SAME_STIFFNESS = (3, 7), 2e-3
#: Where damage of the tip begins, in parts of the first resolved opening: the first two tries, and bounds.
BEGINS = (0.05, 0.15, 0.01, 0.7)
#: Order of the arms, with which they are as stiff as a plane; thick ones of order 1 are 1.8 % stiffer.
AS_A_PLANE = 3
#: Opening at which a law ends, over the first resolved one, below which it is no more than a tip.
NO_MORE_THAN_A_TIP = 4.0
#: Part of the toughness that is resolved from which what is beyond the last end opening is said.
UNSEEN = 0.02


@dataclass(frozen=True)
class Bridging:
    """A law with the scene that has it, end openings and J (n,) of the test, corrected, and the curves of both.

    ``misfit`` and ``noise`` are standard deviations of the load, in parts of the largest.
    """

    law: FallingLaw
    scene: Scene
    w: np.ndarray
    J: np.ndarray
    measured: tuple[np.ndarray, np.ndarray]
    solved: tuple[np.ndarray, np.ndarray]
    misfit: float
    noise: float
    name = "bridging"
    title = "Bridging law"

    @property
    def sentences(self) -> tuple[str, ...]:
        """The law, what of it is not known, and how far its curve is from the test."""
        from verify.pages.text import Units  # here, as it needs a package for pages

        law, units = self.law, Units.of(self.scene.units)
        length, stress, toughness = (f" {one}" if one else "" for one in (units.length, units.stress, units.toughness))
        first, (below, above) = f"{law.first:.3g}{length}", law.toughness
        said = [
            f"toughness {below:.4g}{toughness} up to an end opening of {first}, and {above:.4g}{toughness} beyond it, "
            f"by a stress that falls from {law.traction(law.first):.3g}{stress} to 0 at {law.opens:.3g}{length}",
            f"the curve of the law is {100 * self.misfit:.2g} % of the peak off the test, root mean square; the noise "
            f"is {100 * self.noise:.2g} %",
        ]
        if law.tip > 0.0:
            said.append(
                f"the tip cannot be resolved below {first}: a triangle stands for {law.tip:.4g}{toughness}, and its "
                f"strength, {2.0 * law.tip / law.first:.3g}{stress}, is the least that it can have"
            )
        if law.opens < NO_MORE_THAN_A_TIP * law.first:
            said.append(
                f"what bridges is gone at {law.opens / law.first:.2g} times the first resolved end opening: it cannot "
                "be told from the tip, and the sum of both is what is known"
            )
        if (beyond := law.above(law.last)) > UNSEEN * above:
            said.append(
                f"the test ends at an end opening of {law.last:.3g}{length} with bridges in the whole crack: "
                f"{beyond:.3g}{toughness} beyond it is a guess"
            )
        return tuple(said)

    @property
    def content(self) -> dict[str, Any]:
        """For reduce.json."""
        law = self.law
        return {
            "below": law.toughness[0],
            "above": law.toughness[1],
            "stress": float(law.traction(law.first)),
            "first_opening": law.first,
            "last_opening": law.last,
            "table": law.table,
            "misfit": self.misfit,
            "noise": self.noise,
        }


@np.errstate(all="ignore")  # where nothing is open yet, the ratios are not known, and not used
def bridged(found: Reduction, scene: Scene) -> Bridging:
    """The law of a test, by the cohesive beam.

    Beam theory errs in J and end opening where the zone is long. It errs alike on the curve that the beam draws with
    the law, whose J and end opening are known: their ratios correct those of the test, and the law is found anew.

    Raises
    ------
    Refusal : another kind, no growth, too few resolved rows, or a law with which the beam stops.
    """
    if found.coupon.kind != "dcb":
        raise Refusal(f"--bridging: must be for dcb, got the kind {found.coupon.kind!r}")
    if not found.grown.any():
        raise Refusal("--bridging: needs rows on which the crack grows, got none")
    found = from_onset(found)
    test = seen(found)
    J, w, E = test.J, test.w, test.modulus
    rows = np.flatnonzero(~found.unloads & (np.arange(w.size) <= np.flatnonzero(test.grows)[-1]))
    d, peak = test.opening, float(test.load.max())
    rise = rows[: np.argmax(test.load[rows] >= 0.5 * peak)]
    tried: list[tuple[float, float]] = []  # where damage begins, stiffness over that of the test, less one
    with Progress("bridging", CORRECTIONS[1] + 1) as progress:
        for count in range(CORRECTIONS[1] + 1):
            at = test.counted(w, J, found.rows.source)
            law = falling(w[at], J[at], _begins(tried))
            made = _scene(scene, law, E / found.coupon.young, 1.02 * float(d[rows].max()))
            load, of_J, of_w, of_E, stiff = _of_beam(made, found, d, rise)
            progress.advance(count + 1, f"{count + 1} solutions")
            if count == CORRECTIONS[1] or count >= CORRECTIONS[0] and abs(stiff) < SAME_STIFFNESS:
                break
            J, w, E = test.J * of_J, test.w * of_w, test.modulus * E / of_E
            tried.append((law.begins, stiff))
    misfit = float(np.sqrt(np.mean((load - test.load)[rows] ** 2))) / peak
    noise = smooth(found.rows).uncertainty / peak
    return Bridging(law, made, w[at], J[at], (d, test.load), (d[rows], load[rows]), misfit, noise)


def _begins(tried: Sequence[tuple[float, float]]) -> float:
    """Where damage of the tip begins next, on the line over its logarithm through the last try that was too stiff and
    the last that was too soft, or through the first two.

    A tip that yields early is stiff at first, and its modulus makes up for the yielding.
    """
    if len(tried) < 2:
        return BEGINS[len(tried)]
    sides = [[one for one in tried if (one[1] > 0.0) == stiff] for stiff in (True, False)]
    (a, of_a), (b, of_b) = [one[-1] for one in sides] if all(sides) else tried[:2]
    last, off = tried[-1]
    steep = max((of_a - of_b) / np.log(b / a) if a != b else 0.0, abs(off))  # no further than by a factor e
    return float(np.clip(last * np.exp(off / steep), *BEGINS[2:]))


def _scene(scene: Scene, law: FallingLaw, stiffer: float, opening: float) -> Scene:
    """The scene with a law, a modulus so many times its own, up to an opening."""
    raw = {
        **scene.model_dump(),
        "name": f"{scene.name}-bridging",
        "published": [],
        "interface": {"law": TABULAR, "table": law.table},
    }
    settings = f"load.opening={opening!r}", f"discretization.steps={FITTING.steps}", f"beam.order={AS_A_PLANE}"
    return parse_scene(raw, [*moduli(raw, stiffer), *settings, f"{FITTED_BY}.in_a_zone={FITTING.in_a_zone}"])


def _of_beam(
    scene: Scene, found: Reduction, opening: np.ndarray, rise: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    """Of the curve of the beam, at openings (n,): the load, J and end opening over what the reduction of the test sees
    of them, the modulus that it sees, and its stiffness over that of the test on the rows ``rise``, less one."""
    run = solve(scene, FITTED_BY)
    if not run.complete:
        raise Refusal(f"--bridging: the beam with the law that was found {run.status}")
    known, w, measured = of_steps(FITTED_BY, run.steps, found.coupon), run.steps["tip_opening"], found.rows
    assert known.J is not None
    shown = replace(known, J=None if measured.J is None else known.J, end=None if measured.end is None else w)
    model = seen(reduce(shown, found.coupon, found.settings))
    onward = np.append(True, model.opening[1:] > np.maximum.accumulate(model.opening)[:-1])
    columns = model.load, known.J / model.J, w / model.w
    load, of_J, of_w = (np.interp(opening, model.opening[onward], one[onward]) for one in columns)
    P = measured.load[rise]
    stiff = float(np.interp(measured.opening[rise] + found.toe, run.opening, run.load) @ P / (P @ P)) - 1.0
    return load, of_J, of_w, model.modulus, stiff
