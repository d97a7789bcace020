"""Error of an interface with fixed pairs of points, from the rotation of the lower surface and the sliding along it.

The DOLFINx model, like every model without ``effects.search``, keeps the initial pairs of points and measures gap and
traction along the undeformed normal. Where the lower surface has rotated by theta and a pair has slid apart by s, the
gap along the current normal is g cos(theta) - s sin(theta), and the tractions have the axial component p sin(theta).
Both are computed from the stored fields of a run. They bound the difference to a code that projects the points anew.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from verify.checks.mechanics.columns import law_of
from verify.methods.method import Prepared
from verify.result import Result, Snapshot
from verify.scene.effects import NEGLIGIBLE
from verify.theory.law import Law

#: Least traction, over the strength, at which the rotation at a point counts.
LEAST_TRACTION = 0.01


@dataclass(frozen=True)
class LeftOut:
    """Largest values over the stored fields.

    ``tilt``: rotation of the lower surface in radians, where the interface carries traction. ``gap``: change of the
    gap over g_u, in the process zone. ``pull``: axial resultant of the tractions over the load.
    """

    tilt: float
    gap: float
    pull: float

    @property
    def bound(self) -> float:
        """Bound of the difference from a code that follows the surfaces, over G_Ic or the load.

        No traction is above p_max = 2 G_Ic / g_u: a change of the gap by ``gap`` g_u changes the area under the law by
        no more than 2 ``gap`` G_Ic.
        """
        return float(np.max([2.0 * self.gap, self.pull]))  # NaN stays NaN, and is not valid

    @property
    def valid(self) -> bool:
        """Whether an interface with fixed pairs is accurate enough; False where the bound is NaN."""
        return self.bound <= NEGLIGIBLE


def summary(prepared: Prepared, result: Result) -> dict[str, float]:
    """The entry of ``result.json``: tilt, gap and pull; empty where the method follows the surfaces."""
    found = of_run(prepared, result)
    return {} if found is None else asdict(found)


def of_run(prepared: Prepared, result: Result) -> LeftOut | None:
    """The error of a run; None where its method follows the surfaces, where they are mirror images, whose points stay
    opposite each other, or where no fields were stored."""
    method, scene = prepared.method, prepared.scene
    mirrored = prepared.effects["symmetry"]
    if mirrored or not (method.has_mesh and "search" in method.fixed(scene) and result.snapshots):
        return None
    specimen = scene.specimen
    return left_out(result.snapshots, law_of(scene), specimen.place(0.0), specimen.width)


def left_out(
    snapshots: tuple[Snapshot, ...], law: Law, loaded_at: float, width: float = 1.0, between: bool = False
) -> LeftOut:
    """The error of a matched interface in the stored fields of a run.

    Parameters
    ----------
    loaded_at : X of the loaded end, from which the snapshots measure distances; the bodies meet on Y = 0
    between : use the surface half way between both faces instead of the lower one. With equal arms the tractions are
        normal to that surface, and its rotation is the error of a normal taken from either face
    """
    found = [_of(snapshot, law, loaded_at, width, between) for snapshot in snapshots]
    return LeftOut(*(float(np.max(values)) for values in zip(*found, strict=True))) if found else LeftOut(0, 0, 0)


def _of(snapshot: Snapshot, law: Law, loaded_at: float, width: float, between: bool) -> tuple[float, float, float]:
    below_X, below_u, turn = _surface(snapshot, upper=False)
    above_X, above_u, above_turn = _surface(snapshot, upper=True)
    X_q = np.abs(loaded_at - snapshot.s_q)
    turn_q = np.interp(X_q, below_X, turn)
    if between:
        turn_q = 0.5 * (turn_q + np.interp(X_q, above_X, above_turn))
    slip_q = np.interp(X_q, above_X, above_u[:, 0]) - np.interp(X_q, below_X, below_u[:, 0])
    g_q, p_q = snapshot.gap_q, snapshot.traction_q
    zone_q = (g_q > law.g_peak) & (g_q < law.g_open)
    change_q = g_q * (1.0 - np.cos(turn_q)) + slip_q * np.sin(turn_q)
    order = np.argsort(X_q)
    pull = width * float(np.trapezoid((p_q * np.sin(turn_q))[order], X_q[order]))
    return (
        float(np.max(np.abs(turn_q[np.abs(p_q) > LEAST_TRACTION * law.strength]), initial=0.0)),
        float(np.max(np.abs(change_q[zone_q]), initial=0.0)) / law.g_open,
        abs(pull / snapshot.load) if snapshot.load else 0.0,
    )


def _surface(snapshot: Snapshot, upper: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """X (n,) in rising order, displacements (n, 2) and rotations (n,) along the side of a body on Y = 0."""
    X_euvi, u_euvi, v = snapshot.X_euvi, snapshot.u_euvi, 0 if upper else -1
    height_u, height_v = (np.ptp(X_euvi[..., 1], axis=axis).max() for axis in (1, 2))
    if height_u > height_v:  # the first axis of the grid runs through the thickness
        X_euvi, u_euvi = X_euvi.swapaxes(1, 2), u_euvi.swapaxes(1, 2)
    Y_euv = X_euvi[..., 1]
    on_side = np.all(np.abs(Y_euv[:, :, v]) < 1e-9 * np.ptp(Y_euv), axis=1)
    on_side &= (Y_euv.mean(axis=(1, 2)) > 0.0) == upper
    X_eu, u_eui = X_euvi[on_side][:, :, v, 0], u_euvi[on_side][:, :, v]
    order = np.argsort(X_eu[:, 0])
    X_eu, u_eui = X_eu[order], u_eui[order]
    t_u = np.linspace(0.0, 1.0, X_eu.shape[1])
    powers = np.arange(t_u.size)
    slopes_uc = powers * t_u[:, None] ** np.maximum(powers - 1, 0)
    slopes_uv = slopes_uc @ np.linalg.inv(t_u[:, None] ** powers)  # exact for the polynomial through the samples
    du_eui = np.einsum("uv,evi->eui", slopes_uv, u_eui) / (X_eu[:, -1:] - X_eu[:, :1])[..., None]
    turn_eu = np.arctan2(du_eui[..., 1], 1.0 + du_eui[..., 0])
    return X_eu.ravel(), u_eui.reshape(-1, 2), turn_eu.ravel()
