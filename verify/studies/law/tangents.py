"""Tangents compared with differences of tractions."""

from __future__ import annotations

import numpy as np

from verify.studies.law.given.answer import DIFFERENCES, Answer
from verify.studies.law.ways.legs import JumpPath
from verify.theory.mixed_law import MixedBond

#: Part of the steps of a path that is judged for tractions from a file; the others count as next to a kink.
JUDGED = 0.85
#: A step is at a kink of the law if forward and backward differences differ by more than this part of the stiffness.
KINK = 1e-3


def off(bond: MixedBond, way: JumpPath, given: Answer) -> float | None:
    """Largest deviation of a tangent, relative to the corresponding stiffness; None where there is nothing to judge.

    The tangent of a function is compared with its central differences, with the step size that fits best; kinks are
    left out. A tangent from a file is compared with the change of the tractions between steps on straight parts of the
    path; the steps with the largest deviations are left out, as they are at kinks.
    """
    if given.tangent is None:
        return None
    if given.differences is not None:
        found = by_size(bond, given)
        return float(found.min(axis=0).max()) if found.size else None
    return _along(bond, way, given)


def by_size(bond: MixedBond, given: Answer) -> np.ndarray:
    """Deviation (n_h, n_i) from central differences with each step size, at each probed step that is not at a kink."""
    assert given.tangent is not None and given.differences is not None and given.probed is not None
    tangent, scale = given.tangent[given.probed], _scale(bond, given)[given.probed]
    forward, central, backward = np.moveaxis(given.differences, 2, 0)
    bent = (np.abs(forward - backward) / scale).max(axis=(-2, -1)).min(axis=0) > KINK
    return (np.abs(central - tangent) / scale).max(axis=(-2, -1))[:, ~bent]


def study(bond: MixedBond, answers: list[Answer]) -> list[tuple[float, float]]:
    """Step size, over the largest jump of a path, and the median deviation of all probed steps with it."""
    found = [by_size(bond, one) for one in answers if one.tangent is not None and one.differences is not None]
    if not found:
        return []
    return list(zip(DIFFERENCES.sizes, np.median(np.concatenate(found, axis=1), axis=1).tolist(), strict=True))


def _scale(bond: MixedBond, given: Answer) -> np.ndarray:
    """Stiffness (n, 2, 2) of opening, of sliding, and their geometric mean, or the tangent where that is larger, as in
    contact."""
    K, Ks = bond.slopes
    whole = np.array([[K, (K * Ks) ** 0.5], [(K * Ks) ** 0.5, Ks]])
    assert given.tangent is not None
    return np.maximum(whole, np.abs(given.tangent))


def _along(bond: MixedBond, way: JumpPath, given: Answer) -> float | None:
    """Deviation of the change of the tractions between two steps from the mean of both tangents times the change of the
    jump."""
    assert given.tangent is not None
    step = np.diff(np.stack([way.g, way.s], axis=1), axis=0)
    change = np.diff(np.stack([given.p, given.t], axis=1), axis=0)
    mean = 0.5 * (given.tangent[1:] + given.tangent[:-1])
    scale = 0.5 * (_scale(bond, given)[1:] + _scale(bond, given)[:-1])
    left = np.abs(change - np.einsum("nij,nj->ni", mean, step))
    size = np.einsum("nij,nj->ni", scale, np.abs(step))
    inside = way.straight[1:] & way.straight[:-1]
    if inside.sum() < 4:
        return None
    found = (left[inside] / np.maximum(size[inside], np.finfo(float).tiny)).max(axis=1)
    return float(np.sort(found)[int(JUDGED * (found.size - 1))])
