"""Tangents held against differences of tractions."""

from __future__ import annotations

import numpy as np

from verify.studies.law.given.answer import DIFFERENCES, Answer
from verify.studies.law.ways.legs import JumpPath
from verify.theory.mixed_law import MixedBond

#: Of a path without a function, the part of its steps that is judged: others are next to a kink.
JUDGED = 0.85
#: Of differences forward and backward, in parts of the stiffness: beyond this a step is at a kink of the law.
KINK = 1e-3


def off(bond: MixedBond, way: JumpPath, given: Answer) -> float | None:
    """Largest deviation of a tangent, in parts of the stiffness it belongs to; None where there is nothing to judge.

    Of a law that can be called: against its central differences with the step size that fits best, but at kinks. Of
    numbers in a file: against the tractions of the step before, on straight parts of the path, but for the steps of
    largest deviation, which are at kinks.
    """
    if given.tangent is None:
        return None
    if given.differences is not None:
        found = by_size(bond, given)
        return float(found.min(axis=0).max()) if found.size else None
    return _along(bond, way, given)


def by_size(bond: MixedBond, given: Answer) -> np.ndarray:
    """Deviation (n_h, n_i) from central differences with each step size, at each probed step that is at no kink."""
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
    """Stiffness (n, 2, 2) of opening, of sliding, and their mean; that of contact where the tangent has one."""
    K, Ks = bond.slopes
    whole = np.array([[K, (K * Ks) ** 0.5], [(K * Ks) ** 0.5, Ks]])
    assert given.tangent is not None
    return np.maximum(whole, np.abs(given.tangent))


def _along(bond: MixedBond, way: JumpPath, given: Answer) -> float | None:
    """Between two steps the change of the tractions is the mean of both tangents times that of the jump."""
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
