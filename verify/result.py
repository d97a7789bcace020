"""What a solver hands over: one row a converged step, a few field snapshots, and how the run ended.

Every method, own or foreign, is reduced to these shapes before anything is compared.
All forces are for the whole specimen (width included); lengths, forces and energies are in the scene's own units.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from html import escape
from math import nan
from typing import Any

import numpy as np


def run_seconds(result: Result) -> float:
    """Wall time of a run without what it compiled."""
    return (result.seconds or {}).get("total", nan) - result.jit_seconds


#: Columns of ``curve.csv``, in order: the contract with other people's scripts.
CURVE_COLUMNS = (
    "opening",  # total separation of the loaded end faces (mean over each face)
    "load",  # work-conjugate to the opening
    "crack_length",  # from the loaded end to the foremost fully open point, g >= g_u; at least the precrack
    "stored_energy",  # bulk + cohesive + contact
    "dissipated_energy",
    "external_work",  # integral of load over opening along the path
    "newton_iterations",
)

#: Further columns of ``curve.csv`` where the bond slides, described below; NaN where a method does not know one.
SLIDING_COLUMNS = ("J_loads", "J_bond", "mode_ratio")

#: What the checks need besides; a method leaves out what it cannot know.
EVIDENCE_COLUMNS = (
    "load_slope",  # d load / d opening of the path at this point, exact (bordered system)
    "heading",  # +1 where the opening grows along the path at this point, -1 where it falls (snap-back, unloading)
    "residual",  # norm of the residual forces of the converged step
    "tip_opening",  # normal gap at the end of the precrack
    "end_opening",  # and at the far end of the interface
    "damage_front",  # from the loaded end to the foremost point past its strength, g > g_max; at least the precrack
    "face_slope_top",  # mean of du_y/dX over the loaded face, signed
    "face_slope_bottom",
    "face_energy",  # integral of W dY over the end faces, those of the far end with a minus, per unit width
    "interface_force",  # vertical resultant of the interface tractions on the upper arm
    "reaction_x",  # sums of the support reactions, besides what balances the resultant of the loads
    "reaction_y",
    "load_moment",  # moment about the origin, current configuration, of load and supports on the upper arm
    "interface_moment",  # and of the interface tractions on the upper arm
    "clamp_moment",  # and of a clamp
    "interface_pull",  # resultant along the specimen of the interface tractions on a body that is not clamped
    "anchor_pull",  # and of what keeps that body from sliding along the other
    "bulk_energy",
    "cohesive_energy",
    "contact_energy",
    "penetration",  # how deep the faces are in each other, sampled all along them; where the programme goes down
    "contact_pressure",  # largest traction with which they push each other apart
    "mouth_opening",  # gap at the end of the faces next to the load, where they may touch beyond the bond
    "front_middle",  # from the loaded end to the front of the crack in the middle of the width of a solid
    "front_edge",  # and at its edge; other lengths of a solid are means over the width
    # where the bond slides, and then beside them `support_columns`:
    "tip_slip",  # slip at the end of the precrack
    "J_loads",  # J of loads and supports: w J = sum of F mean(du/dX), with the energy of strained end faces
    "J_bond",  # J of the bond and of faces that touch: - integral of p dg/dX + t ds/dX
    "J_shear",  # its part of t ds/dX
    "mode_ratio",  # B of the foremost point whose damage grows; before damage where the scaled jump is largest
    "friction_energy",  # the part of the dissipated energy that friction took
    "arm_force_x",  # sums of all forces on the upper arm, and of their moments, current configuration
    "arm_force_y",
    "arm_moment",
)


def support_columns(row: Collection[str]) -> tuple[str, ...]:
    """The reactions of supports that a row has, in their order: upwards, couples anticlockwise, on the specimen."""
    found = [name for name in row if name.startswith("support_") and name[8:].isdigit()]
    return tuple(sorted(found, key=lambda name: int(name[8:])))


def _none(*shape: int) -> Any:
    """A field that a snapshot may lack."""
    return field(default_factory=lambda: np.zeros(shape))


@dataclass(frozen=True)
class Snapshot:
    """Fields at one converged step.

    The interface part is ordered by ``s_q``, the distance along the specimen from the loaded end; the field part is
    one grid of (k+1) x (k+1) sample points for every element, so that a jump of the stress between elements is seen.
    """

    opening: float
    load: float
    s_q: np.ndarray  # (n_q,) position of the interface quadrature points
    gap_q: np.ndarray  # (n_q,) normal opening, negative where closed
    traction_q: np.ndarray  # (n_q,) normal traction, positive in tension
    damage_q: np.ndarray  # (n_q,) 0 intact .. 1 open
    X_euvi: np.ndarray  # (n_e, k+1, k+1, 2) reference positions
    u_euvi: np.ndarray  # (n_e, k+1, k+1, 2) displacements
    stress_euv: np.ndarray  # (n_e, k+1, k+1) Cauchy stress sigma_xx
    line_nki: np.ndarray = _none(0, 2, 2)  # edges of the T-mesh, where there is one
    junction_ni: np.ndarray = _none(0, 2)  # T-junctions
    slip_q: np.ndarray = _none(0)  # (n_q,) slip, where the bond slides
    shear_q: np.ndarray = _none(0)  # (n_q,) traction along the faces, there as well

    front_z: np.ndarray = _none(0)  # (n_k,) places across the width of a solid
    front_s: np.ndarray = _none(0)  # (n_k,) crack there, distance as s_q
    front_G: np.ndarray = _none(0)  # (n_k,) energy that the bond takes up there

    def _repr_html_(self) -> str:
        from iga.notebook import drawn, grids

        text = f"{len(self.X_euvi)} elements, deformed, at opening {self.opening:.4g} under load {self.load:.4g}"
        return drawn(grids(self.X_euvi + self.u_euvi), text)


@dataclass(frozen=True)
class Result:
    """A run, as far as it came.

    ``steps`` maps a column name to an array (n_steps,); it holds CURVE_COLUMNS and those EVIDENCE_COLUMNS that the
    method knows. ``status`` is ``complete`` or ``stopped: <cause and what to do>``. ``ending`` says what else is worth
    saying of it: "separated at opening 5.2". ``counted_steps`` says from where on, and why, steps were counted that the
    path was to choose. ``condition`` is the largest condition number (1-norm, estimated) of the tangents that were
    looked at, 0 where none was. ``nonzeros`` counts the entries of a sparse tangent, 0 where the method does not say;
    ``jit_seconds`` is the part of ``seconds["basis"]`` that compiling at run time took.
    """

    method: str
    steps: Mapping[str, np.ndarray]
    status: str = "complete"
    ending: str = ""
    counted_steps: str = ""
    condition: float = 0.0
    dofs: int = 0
    elements: int = 0
    rejected_steps: int = 0
    snapshots: tuple[Snapshot, ...] = ()
    seconds: Mapping[str, float] | None = None
    peak_memory_mb: float = 0.0
    nonzeros: int = 0
    jit_seconds: float = 0.0

    @property
    def opening(self) -> np.ndarray:
        return self.steps["opening"]

    @property
    def load(self) -> np.ndarray:
        return self.steps["load"]

    @property
    def complete(self) -> bool:
        return self.status == "complete"

    @property
    def separated(self) -> bool:
        return self.complete and self.ending.startswith("separated")

    def __repr__(self) -> str:
        return f"<Result: {self._in_short}>"

    @property
    def _in_short(self) -> str:
        size = f"{self.dofs} unknowns, " if self.dofs else ""
        end = self.ending or self.status
        if not self.load.size:
            return f"{self.method}, {size}no point, {end}"
        peak = int(np.argmax(self.load))
        at = f"peak load {self.load[peak]:.6g} at opening {self.opening[peak]:.6g}"
        return f"{self.method}, {size}{self.load.size} points, {at}, {end}"

    def _repr_html_(self) -> str:
        from iga.notebook import Drawn, chart

        return f"<p>{escape(self._in_short)}</p>{chart([Drawn(self.method, self.opening, self.load)])}"


def steps_from_rows(rows: list[Mapping[str, float]]) -> dict[str, np.ndarray]:
    """Columns from the rows of a run; every row must have the same keys."""
    if not rows:
        return {name: np.zeros(0) for name in CURVE_COLUMNS}
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
