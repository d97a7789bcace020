"""Sizes of elements along the interface, as the mesh maker made them."""

from __future__ import annotations

import numpy as np

from iga.specimen import Specimen
from iga.surface import Surface, surface


def element_length(specimen: Specimen) -> float:
    """Longest element side where the crack is to run, of either body: the one that resolves a process zone least."""
    P_AI, first, longest = specimen.system.interface.P_AI, 0, 0.0
    for mesh, side in zip(specimen.meshes, ("bottom", "top"), strict=False):
        start_ci, end_ci = _ends(surface(mesh, mesh.chains[side], first), P_AI)
        middle_c = specimen.distance(0.5 * (start_ci + end_ci))
        met = (middle_c > specimen.path[0]) & (middle_c < specimen.path[1])
        longest = max(longest, float(np.linalg.norm(end_ci - start_ci, axis=1)[met].max(initial=0.0)))
        first += len(mesh.P_AI)
    return longest


def _ends(face: Surface, P_AI: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and last point (n_c, 2) of every side."""
    Q_cbi = face.bezier_points(P_AI) / face.w_cb[..., None]
    return Q_cbi[:, 0], Q_cbi[:, -1]
