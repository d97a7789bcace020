"""How far a crack runs in arms bent between loads and supports, by beam theory: where a mesh has to be fine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.specimen.layout import Layout, Load, Support
from iga.specimen.problem import Debonding


@dataclass(frozen=True)
class BentArms:
    """``places``: number of positions of the crack tip that are tried. ``slack``: factor on the openings of the
    programme, as arms also deform in shear and at the tip."""

    places: int = 400
    slack: float = 1.15


BENT = BentArms()


def crack_end(problem: Debonding) -> float:
    """X of the furthest tip of a sharp crack in slender arms that is in equilibrium within the programme, which may
    bend them both ways."""
    reached = [max(way * opening for opening in problem.opening) for way in (1.0, -1.0)]
    return max(_crack_end(problem, way, far) for way, far in zip((1.0, -1.0), reached, strict=True))


def _crack_end(problem: Debonding, way: float, far: float) -> float:
    """The same for openings up to ``far`` in one way, 1 that of the loads and -1 the other.

    Under a unit load a crack releases ``G = (sum m_i^2 / E I_i - m^2 / E I) / (2 w)``, with m_i the moments of both
    arms at the tip, m their sum and E I the bending stiffness of both as one. The load at which G is the toughness
    opens the specimen by the compliance ``C = int m^2 / E I dX`` times the load. Arms that would pass through each
    other bend alike, and slide. The toughness is that of the mode mixture: energy released beyond that of arms that
    bend alike is of mode I (Williams 1988).
    """
    layout, plane = problem.layout, problem.plane
    X = np.linspace(0.0, layout.bonded[1], BENT.places)
    m_kX = way * moments(layout, X)
    E, h = (np.array(v) for v in zip(*((one.moduli.axial(plane), one.thickness) for one in layout.bodies), strict=True))
    EI, EA = problem.width * E * h**3 / 12.0, problem.width * E * h
    both = EI.sum() + EA.prod() / EA.sum() * (0.5 * h.sum()) ** 2
    whole = m_kX.sum(0)
    opens = m_kX[0] / EI[0] > m_kX[1] / EI[1]
    arms_kX = np.where(opens, m_kX, np.outer(EI / EI.sum(), whole))
    joined, gained = whole**2 / both, np.sum(arms_kX**2 / EI[:, None], axis=0) - whole**2 / both
    steps = 0.5 * (gained[1:] + gained[:-1]) * np.diff(X)
    compliance = float(np.trapezoid(joined, X)) + np.concatenate([[0.0], np.cumsum(steps)])
    slid = whole**2 * (1.0 / EI.sum() - 1.0 / both)
    B = np.clip(slid / np.maximum(gained, 1e-300), 0.0, 1.0)
    toughness = problem.law.critical(B)
    load = np.sqrt(2.0 * problem.width * toughness / np.maximum(gained, 1e-300))
    there = (X >= layout.bonded[0]) & (compliance * load <= BENT.slack * far)
    return float(X[there].max(initial=layout.bonded[0]))


def moments(layout: Layout, X: np.ndarray) -> np.ndarray:
    """Bending moments (2, n_X) of the upper and the lower arm in cracked sections at X under a unit load, sagging ones
    positive."""
    acting: list[tuple[Load | Support, float]] = [(load, load.share) for load in layout.loads]
    rollers = [support for support in layout.supports if not support.couple and support.body is not None]
    if len(rollers) == 2:  # two reactions from the balance of forces and moments
        x, at = [_place(layout, support) for support in rollers], [_place(layout, load) for load, _ in acting]
        force = sum(share for load, share in acting if not load.couple)
        turn = sum(
            share if load.couple else share * (place - x[0]) for (load, share), place in zip(acting, at, strict=True)
        )
        right = -turn / (x[1] - x[0])
        acting += [(rollers[0], -force - right), (rollers[1], right)]
    m_kX = np.zeros((2, len(X)))
    for patch, size in acting:
        if patch.body is not None:
            lever = X - _place(layout, patch)
            m_kX[patch.body] += np.where(lever > 0.0, -size if patch.couple else size * lever, 0.0)
    return m_kX


def _place(layout: Layout, patch: Load | Support) -> float:
    if patch.extent is not None:
        return 0.5 * sum(patch.extent)
    return 0.0 if patch.side == "left" else layout.bonded[1]
