"""The front of the crack across the width of a solid, and the energy that it takes up there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.path.point import Point
from iga.specimen.specimen import Specimen


@dataclass(frozen=True)
class Front:
    """Lines of interface points along the specimen, from the middle of the width to its edge.

    ``z_k`` (n_k,) places across the width; ``s_k`` distance of the crack from the loaded end; ``G_k`` energy that the
    bond takes up per area, ``- int p dg/dX + t ds/dX dX``; ``part_k`` the part of the width that a line stands for.
    """

    z_k: np.ndarray
    s_k: np.ndarray
    G_k: np.ndarray
    part_k: np.ndarray

    @property
    def mean(self) -> float:
        """Mean distance over the width."""
        return float(self.part_k @ self.s_k)

    @property
    def ends(self) -> tuple[float, float]:
        """Distance in the middle of the width, where the front is even in Z, and at the edge: through two lines."""
        if len(self.z_k) == 1:
            return float(self.s_k[0]), float(self.s_k[0])
        (z_0, z_1), (s_0, s_1) = self.z_k[:2] ** 2, self.s_k[:2]
        (z_2, z_3), (s_2, s_3), edge = self.z_k[-2:], self.s_k[-2:], self.edge
        return float((s_0 * z_1 - s_1 * z_0) / (z_1 - z_0)), float(s_3 + (edge - z_3) * (s_3 - s_2) / (z_3 - z_2))

    @property
    def edge(self) -> float:
        """Half of the width: the lines are Gauss points, whose mean square is that of the width."""
        return float((3.0 * self.part_k @ self.z_k**2) ** 0.5)


def front(specimen: Specimen, point: Point, limit: float) -> Front:
    """The foremost place on each line that has opened to a ``limit``, linear between points; at least the end of the
    bond next to the load."""
    interface, response = specimen.system.interface, point.response
    z_q, s_q = specimen.places[0][:, 2], specimen.distance(interface.X_qi)
    lines = interface.line_q.max() + 1
    q_ks = np.lexsort((s_q, interface.line_q)).reshape(lines, -1)
    s_ks, x_ks, dA_ks = s_q[q_ks], np.where(interface.bonded_q, response.back_q, 0.0)[q_ks], interface.dA_q[q_ks]
    part_k = dA_ks.sum(1) / dA_ks.sum()
    slopes = interface.slopes(point.state.u_d, response.contact)
    assert slopes is not None
    work_q = sum(f_q * by_X_q for f_q, by_X_q in zip(response.pull.f_qc.T, slopes, strict=False))
    work_ks = -np.asarray(work_q)[q_ks] * dA_ks
    k, broken_ks = np.arange(lines), x_ks >= limit
    last_k = s_ks.shape[1] - 1 - np.argmax(broken_ks[:, ::-1], axis=1)
    next_k = np.minimum(last_k + 1, s_ks.shape[1] - 1)
    s_0, s_1, x_0, x_1 = s_ks[k, last_k], s_ks[k, next_k], x_ks[k, last_k], x_ks[k, next_k]
    onward_k = (s_1 - s_0) * (x_0 - limit) / np.where(x_0 > x_1, x_0 - x_1, 1.0)
    tip = specimen.layout.free_length
    s_k = np.where(broken_ks.any(1), np.maximum(s_0 + onward_k, tip), tip)
    return Front(z_q[q_ks[:, 0]], s_k, work_ks.sum(1) / (part_k * specimen.width), part_k)
