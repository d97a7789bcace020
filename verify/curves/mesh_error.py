"""Uncertainty that the mesh leaves in one number, from three or more meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.convergence import GCI_SAFETY, assess


@dataclass(frozen=True)
class MeshEstimate:
    """What is taken for the error of a mesh where its index cannot be trusted.

    most_order : the load of a cohesive front has no higher order. A higher observed one is that of two fine meshes that
        agree by chance: the error is then that of this order over the range of all values, range / ((h_coarsest /
        h_finest)^order - 1), times the safety factor of the index
    spread : safety factor on the error of meshes that are not in the asymptotic range, which is then that of a first
        order over the range of all values, range / (h_coarsest / h_finest - 1) (Eca and Hoekstra 2014, J. Comput. Phys.
        262, 104)
    """

    most_order: float = 2.0
    spread: float = 3.0


MESH_ESTIMATE = MeshEstimate()


@dataclass(frozen=True)
class MeshError:
    """Of the finest mesh: ``index`` bounds the error with 95 % [unit of the value], ``verdict`` says how."""

    index: float
    verdict: str
    doubtful: bool


def mesh_error(sizes: Sequence[float], values: Sequence[float]) -> MeshError:
    """The grid convergence index of the finest of three or more meshes.

    Observed orders of more than `MeshEstimate.most_order`, and meshes that are not in the asymptotic range, have an
    error over the range of their values in its place. NaN where two meshes are of one size.
    """
    by_size = np.argsort(sizes)
    h, f = np.asarray(sizes, dtype=float)[by_size], np.asarray(values, dtype=float)[by_size]
    if len(set(h)) < len(h):
        return MeshError(float("nan"), "two meshes are of one size", True)
    found = assess(h, f)
    ratio, width = float(h[-1] / h[0]), float(np.ptp(f))
    if not found.asymptotic:
        index = MESH_ESTIMATE.spread * width / (ratio - 1.0)
    elif found.order > MESH_ESTIMATE.most_order:
        index = GCI_SAFETY * width / (ratio**MESH_ESTIMATE.most_order - 1.0)
    else:
        index = float(abs(f[0])) * found.gci
    return MeshError(index, found.verdict, not found.asymptotic)
