"""Any delamination specimen: arms that are pulled apart, a strip on a clamped base, or arms on supports."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.problem.arms import Outline, arms_on_supports
from fem_reference.problem.bond_law import BondLaw
from fem_reference.problem.loads import Load, Support
from fem_reference.problem.material import Rectangle, Rectangles
from fem_reference.problem.problem import Debonding
from fem_reference.problem.specimen import (
    LOWER,
    UPPER,
    Body,
    Held,
    Hook,
    Specimen,
    finer_at_first,
    point,
)


@dataclass(frozen=True, kw_only=True)
class Problem(Debonding):
    """A specimen by its bodies.

    Parameters
    ----------
    bodies : upper and lower; both begin at X = 0.
    bonded : X of the tip of the bond, next to the load, and of its far end.
    bond : its traction law.
    on_base : whether the base of the lower body is clamped, and the upper one is pulled up at its right end; else both
        are pulled apart at X = 0.
    loads, supports, loaded_at : where there are loads, they act with the supports on patches of two arms of one length,
        whose bond begins on the left, and ``loaded_at`` is the X from which a crack is measured.
    """

    bodies: Rectangles
    bonded: tuple[float, float]
    bond: BondLaw
    on_base: bool = False
    loads: tuple[Load, ...] = ()
    supports: tuple[Support, ...] = ()
    loaded_at: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self.specimen()

    @property
    def law(self) -> BondLaw:
        return self.bond

    def specimen(self) -> Specimen:
        if self.loads:
            return arms_on_supports(self, self.bodies, self.bonded, Outline(self.loads, self.supports, self.loaded_at))
        return (strip_on_base if self.on_base else free_arms)(self, self.bodies, self.bonded)


@dataclass(frozen=True)
class PressedEnd:
    """The mesh at the loaded end of arms that are pressed together, where load and contact balance each other.

    longest : length of the elements at the end, in arm thicknesses; the stresses there fade within about one thickness.
    layers : least number of elements through an arm; one element of degree 2 is 0.5 % too stiff there.
    """

    longest: float = 0.25
    layers: int = 2


PRESSED_END = PressedEnd()

#: Ratio of the thickness of a layer of the substrate to that of the layer above. The stresses of the process zone decay
#: with the depth over the length of the zone; a smaller ratio costs unknowns where they have decayed.
LAYER_RATIO = 2.0


def free_arms(problem: Debonding, bodies: Rectangles, bonded: tuple[float, float]) -> Specimen:
    """Two equally long arms, pulled apart at X = 0; of equal solids whose bond only opens the upper one alone.

    Supports at the far end of the bond: each arm is held in x at one point, the lower one also in y.

    Raises
    ------
    ValueError : arms that differ with finite kinematics. The specimen then turns until the loads are in line, which the
        tie would prevent.
    """
    upper, lower = bodies
    if upper != lower and problem.kinematics == "finite":
        raise ValueError('kinematics: must be "linear" for arms that differ in DOLFINx, got "finite"')
    L, tip = upper.length, bonded[0]
    layers = max(problem.layers, PRESSED_END.layers) if problem.presses else problem.layers
    above, below = (np.linspace(0.0, body.thickness, layers + 1) for body in bodies)
    X = problem.cells.X if problem.cells else problem.lines((tip, L))
    longest = PRESSED_END.longest * min(upper.thickness, lower.thickness)
    mirrored = problem.solid and upper == lower and not problem.law.slides
    pair = (_body(upper, above, problem.plane), _body(lower, -below[::-1], problem.plane))
    modelled, end = pair[:1] if mirrored else pair, problem.middle(L, 0.0)
    ends = Held(UPPER, end, (0,)), Held(LOWER, end, (0, 1))
    return Specimen(
        bodies=modelled,
        X=finer_at_first(X, longest) if problem.presses and not problem.cells else X,
        bond=bonded,
        facing=(0.0, L),
        touching=problem.presses,
        loads=(1.0, -1.0),
        held=(*ends[: len(modelled)], *problem.held_across(modelled)),
        hooks=() if mirrored else _tie(problem, bodies),
        loaded_at=0.0,
        cells=problem.cells,
        Z=problem.Z,
    )


def _tie(problem: Debonding, bodies: Rectangles) -> tuple[Hook, Hook]:
    """A spring of stiffness E1 w between u_x of the outer far corners of the two arms.

    The supports are hinges at one point, so that the whole specimen could rotate about it. The spring prevents that
    and carries no force: nothing else could balance its moment about the hinge, since the loads have no moment as
    long as one loaded face is above the other.
    """
    upper, lower = bodies
    root = float(np.sqrt(upper.moduli.E1 * problem.width))
    far = upper.length
    return (
        Hook(UPPER, problem.middle(far, upper.thickness), root),
        Hook(LOWER, problem.middle(far, -lower.thickness), -root),
    )


def strip_on_base(problem: Debonding, bodies: Rectangles, bonded: tuple[float, float]) -> Specimen:
    """A strip whose right end is pulled up; left ends flush.

    The base of the substrate is clamped, the strip is held in x at one point of its unloaded end.

    Raises
    ------
    ValueError : a solid.
    """
    if problem.solid:
        raise ValueError('plane: must be "stress" or "strain" for a strip on a base, got "solid"')
    strip, substrate = bodies
    X = problem.lines((bonded[0], substrate.length, strip.length))
    strip_Y = np.linspace(0.0, strip.thickness, problem.layers + 1)
    bonded_elements = np.count_nonzero(X[1:] <= bonded[0])
    substrate_Y = -layers_below(substrate.thickness, bonded[0] / bonded_elements)[::-1]
    base = (0.0, substrate.length), (-substrate.thickness,) * 2
    return Specimen(
        bodies=(_body(strip, strip_Y, problem.plane), _body(substrate, substrate_Y, problem.plane)),
        X=X,
        bond=bonded,
        facing=(min(substrate.length, strip.length), 0.0),
        touching=problem.presses,
        loads=(1.0, 0.0),
        held=(Held(UPPER, point(0.0, 0.0), (0,)), Held(LOWER, base, (0, 1))),
        hooks=(),
        loaded_at=strip.length,
    )


def layers_below(thickness: float, first: float) -> np.ndarray:
    """Boundaries (n + 1,) from 0 to ``thickness`` of the fewest layers whose first is no thicker than ``first``."""
    n = max(1, int(np.ceil(np.log2(thickness / first * (LAYER_RATIO - 1.0) + 1.0) / np.log2(LAYER_RATIO) - 1e-9)))
    tops = (LAYER_RATIO ** np.arange(n + 1) - 1.0) / (LAYER_RATIO**n - 1.0)
    return thickness * tops


def _body(body: Rectangle, Y: np.ndarray, plane: str) -> Body:
    return Body(body.length, Y, body.moduli.stiffness_IJ(plane))
