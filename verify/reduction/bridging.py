"""The law by which fibres bridge the crack of a DCB, from J over the end opening: traction = dJ/dw.

Suo, Bao, Fan (1992), J. Mech. Phys. Solids 40, 1-16; Sorensen, Jacobsen (1998), Composites A 29, 1443-1451.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import nnls

from verify.reduction.corrections import noise_of
from verify.reduction.coupon import Coupon
from verify.reduction.reduce import Reduction, reduce
from verify.reduction.scheme import Setting
from verify.reduction.schemes import cbbm
from verify.support.refusal import Refusal


@dataclass(frozen=True)
class Bridges:
    """How a law is found.

    sigmas : an end opening that was measured counts as resolved from so many standard deviations of its noise on
    ramps : number of falling lines among which the law is sought; more resolve a kink, and follow noise
    rows : fewest rows with a resolved end opening
    """

    sigmas: float = 4.0
    ramps: int = 40
    rows: int = 10


BRIDGES = Bridges()


@dataclass(frozen=True)
class Seen:
    """What beam theory makes of the rows (n,) of a reduced test: J and the end opening w, and the flexural modulus.

    ``grows`` are rows behind the linear part on which the crack grows; w is resolved above ``least``.
    """

    opening: np.ndarray
    load: np.ndarray
    J: np.ndarray
    w: np.ndarray
    grows: np.ndarray
    least: np.ndarray
    modulus: float

    def counted(self, w: np.ndarray, J: np.ndarray, source: str) -> np.ndarray:
        """Rows (n,) of growth behind the last one on which an end opening ``w`` is not resolved, or J is none.

        Raises
        ------
        Refusal : too few.
        """
        index, known = np.arange(w.size), (w > self.least) & np.isfinite(w) & (J > 0.0) & np.isfinite(J)
        found = self.grows & (index > np.max(index[self.grows & ~known], initial=-1))
        if (count := np.count_nonzero(found)) < BRIDGES.rows:
            rule = f"must have {BRIDGES.rows} rows with a resolved end opening or more"
            raise Refusal(f"{source}: {rule}, got {count}; record more, or measure it (--end-opening)")
        return found


@np.errstate(all="ignore")
def seen(found: Reduction) -> Seen:
    """J by the rotations, else by the compliance; w as it was measured, else of both arms as cantilevers of the
    equivalent crack.

    Without growth these open by what makes up for the rotation at the tip, which is taken off, and below which nothing
    is resolved.
    """
    of, rows = found.coupon, found.smoothed
    by_compliance = cbbm(Setting(of, found.settings, found.part, rows))
    E, P = by_compliance.constants["E_f"], rows.load
    J = by_compliance.release(rows)[0] if rows.J is None else rows.J
    if rows.end is None:
        least = end_opening(of, P, np.full(P.size, of.precrack), E)
        w = end_opening(of, P, by_compliance.crack(rows), E) - least
    else:
        w, least = rows.end, np.full(P.size, BRIDGES.sigmas * noise_of(rows.end))
    index, last = np.arange(P.size), np.max(np.flatnonzero(found.grown), initial=-1)
    grows = (index > found.part.rows[-1]) & (index <= last) & ~found.unloads & (J > 0.0)
    return Seen(rows.opening, P, J, w, grows, least, E)


def end_opening(of: Coupon, P: np.ndarray, a: np.ndarray, E: float) -> np.ndarray:
    """Opening (n,) at the end of the precrack a_0 of arms that are cantilevers of L = a + chi h from the load on:

    w = 2 P (L - a_0)^2 (2 L + a_0) / (6 E I), I = b h^3 / 12.
    """
    L, a0 = a + of.correction, of.precrack
    return 4.0 * P * (L - a0) ** 2 * (2.0 * L + a0) / (E * of.width * of.h**3)


def from_onset(found: Reduction) -> Reduction:
    """The reduction with the limits of its linear part in parts of the load at the first resolved end opening.

    What bridges may let the load grow on to many times that at which the tip breaks.
    """
    low, high = found.settings.window
    for _ in range(2):  # the first line may end where the tip is broken, and see the opening late
        one, rows = seen(found), found.smoothed
        share = float(rows.load[: np.argmax(one.counted(one.w, one.J, rows.source)) + 1].max() / rows.load.max())
        settings = replace(found.settings, machine=0.0, window=(low * share, high * share))
        found = reduce(replace(found.rows, opening=found.rows.opening + found.toe), found.coupon, settings)
    return found


@dataclass(frozen=True)
class FallingLaw:
    """A traction that falls: of a tip whose toughness is J at the opening 0, and of lines,

        sigma(w) = sum of stress_i (1 - w / end_i),  J(w) = tip + sum of stress_i (w - w^2 / (2 end_i)),  up to end_i.

    ``first`` and ``last`` are the end openings between which it is known; the shortest lines may belong to the tip,
    whose damage begins at the part ``begins`` of ``first``.
    """

    tip: float
    stress: np.ndarray
    end: np.ndarray
    first: float
    last: float
    begins: float

    def traction(self, w: ArrayLike) -> np.ndarray:
        """Of the lines (...,) at end openings."""
        return np.maximum(1.0 - np.asarray(w, dtype=float)[..., None] / self.end, 0.0) @ self.stress

    def above(self, w: float) -> float:
        """Toughness above an end opening."""
        return 0.5 * float(self.stress @ (np.maximum(self.end - w, 0.0) ** 2 / self.end))

    @property
    def toughness(self) -> tuple[float, float]:
        """Below the first end opening, and above it."""
        return self.tip + self.above(0.0) - self.above(self.first), self.above(self.first)

    @property
    def opens(self) -> float:
        """Opening from which nothing is left."""
        return float(np.max(self.end[self.stress > 0.0], initial=self.first))

    @property
    def table(self) -> tuple[tuple[float, float], ...]:
        """Corners of a tabular law, with a triangle up to ``first`` for J at the opening 0."""
        begins, ends = self.begins * self.first, self.end[self.stress > 0.0]
        at = np.unique([begins, self.first, *ends])
        traction = self.traction(at) + np.where(at == begins, 2.0 * self.tip / self.first, 0.0)
        return (*zip(at[:-1].tolist(), traction[:-1].tolist(), strict=True), (float(at[-1]), 0.0))


def falling(w: np.ndarray, J: np.ndarray, begins: float = 0.05) -> FallingLaw:
    """The law by least squares of relative errors of J over end openings, no stress negative (Lawson and Hanson 1974).

    Its lines end from twice the first opening on: shorter ones cannot be told from the tip.
    """
    first, last = float(w.min()), float(w.max())
    end = np.geomspace(2.0 * first, 2.0 * max(last, 2.0 * first), BRIDGES.ramps)
    up_to = np.minimum(w[:, None], end)
    parts = np.concatenate([np.ones((w.size, 1)), up_to - 0.5 * up_to**2 / end], axis=1) / J[:, None]
    size = np.linalg.norm(parts, axis=0)
    found = nnls(parts / size, np.ones(w.size))[0] / size
    return FallingLaw(float(found[0]), found[1:], end, first, last, begins)
