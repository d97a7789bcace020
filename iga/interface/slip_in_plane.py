"""The slip of two solids on each other: a vector in the plane of the bond, whose length is that of the law.

It has the sign of the slip along the specimen. Its first and second variation, of parts s_k along two directions that
do not turn:

    s = +- (s_1^2 + s_2^2)^(1/2),    ds = (s_1 ds_1 + s_2 ds_2) / s,    D(ds) = (ds_1 ds_1 + ds_2 ds_2 - ds ds) / s

so that tractions are along the slip, and the tangent has ``t / s`` across it (Camanho and Davila 2002, NASA TM-211737).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.contact import Contact, Rows, Slip

#: Slip of points at rest, relative to the size of the model: there its variations would otherwise be 0 / 0.
LEAST_SLIP = 1e-12


def in_plane(ways: tuple[Rows, Rows], s_kq: np.ndarray, least: float) -> tuple[Slip, np.ndarray]:
    """The length of slips of the parts s_kq (2, n_q) with the first variations ``ways``, and these parts over it."""
    s_q = np.copysign(np.sqrt(np.sum(s_kq**2, axis=0) + least**2), s_kq[0])
    part_kq = s_kq / s_q
    G_qd = sum(part_q[:, None] * rows.G_qd for part_q, rows in zip(part_kq, ways, strict=True))
    return Slip(s_q, replace(ways[0], G_qd=G_qd)), part_kq


@dataclass(frozen=True)
class InPlaneContact(Contact):
    """Contact of fixed pairs. ``ways`` are the first variations of both parts of the slip, ``part_kq`` (2, n_q) these
    parts over its length, ``least`` a length that is added to it at a right angle."""

    ways: tuple[Rows, Rows]
    part_kq: np.ndarray
    least: float

    @staticmethod
    def at_rest(
        known: tuple[np.ndarray, np.ndarray, np.ndarray], gap_rows: Rows, ways: tuple[Rows, Rows], least: float
    ) -> InPlaneContact:
        """Contact before anything moves, with ``known`` gaps, normals and shares."""
        slip = Slip(np.full(len(known[0]), least), replace(ways[0], G_qd=np.zeros_like(ways[0].G_qd)))
        return InPlaneContact(None, *known, gap_rows, ways, np.zeros((2, len(known[0]))), least, slip=slip)

    def moved(self, u_d: np.ndarray) -> InPlaneContact:
        s_kq = np.stack([rows.rates(u_d) for rows in self.ways])
        slip, part_kq = in_plane(self.ways, s_kq, self.least)
        return replace(self, g_q=self.g_q + self.rates(u_d), slip=slip, part_kq=part_kq)

    def slip_rate(self, ways_kq: list[np.ndarray]) -> np.ndarray:
        return np.sum(self.part_kq * ways_kq, axis=0)

    def quadratic(self, f_qc: np.ndarray, slope_qcc: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By the gap and both parts of the slip, with ``t D(ds)``."""
        assert self.slip is not None
        P_qck = np.zeros((len(f_qc), 2, 3))  # of the jumps by the gap and both parts
        P_qck[:, 0, 0], P_qck[:, 1, 1:] = 1.0, self.part_kq.T
        C_qkk = P_qck.swapaxes(1, 2) @ slope_qcc @ P_qck
        across_qkk = np.eye(2) - P_qck[:, 1, 1:, None] * P_qck[:, 1, None, 1:]
        C_qkk[:, 1:, 1:] += (f_qc[:, 1] / self.slip.s_q)[:, None, None] * across_qkk
        return np.stack([rows.G_qd for rows in (self.gap_rows, *self.ways)], axis=1), C_qkk
