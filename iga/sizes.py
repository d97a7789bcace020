"""Sizes of elements along the interface, as the mesh maker made them."""

from __future__ import annotations

import numpy as np

from iga.specimen import Specimen
from iga.surface import Surface, surface


def element_length(specimen: Specimen) -> float:
    """Longest element side along the bond, of either body: the one that resolves a process zone least."""
    P_AI, first, longest = specimen.system.interface.P_AI, 0, 0.0
    for mesh, side in zip(specimen.meshes, ("bottom", "top"), strict=False):
        start_ci, end_ci = _ends(surface(mesh, mesh.chains[side], first), P_AI)
        bonded = _within(0.5 * (start_ci + end_ci), *specimen.probe.X_qi[[0, -1]])
        longest = max(longest, float(np.linalg.norm(end_ci - start_ci, axis=1)[bonded].max(initial=0.0)))
        first += len(mesh.P_AI)
    return longest


def _ends(face: Surface, P_AI: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and last point (n_c, 2) of every side."""
    Q_cbi = face.bezier_points(P_AI) / face.w_cb[..., None]
    return Q_cbi[:, 0], Q_cbi[:, -1]


def _within(x_ci: np.ndarray, start_i: np.ndarray, end_i: np.ndarray) -> np.ndarray:
    """Which points lie beside the segment from start to end."""
    along_i = end_i - start_i
    share = (x_ci - start_i) @ along_i / (along_i @ along_i)
    return (share > 0.0) & (share < 1.0)
