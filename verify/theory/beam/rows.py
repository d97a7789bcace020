"""Rows and snapshots of the cohesive beam, in the units of the scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from verify.theory.beam.arm import FORCE, V
from verify.theory.beam.peeled_strip import SURFACE, Strip
from verify.theory.beam.zones import BARE, CONTACT, ELASTIC, FREE, OPEN, SOFTENING
from verify.theory.law import Bilinear

if TYPE_CHECKING:
    from verify.theory.beam.collocation import Field
    from verify.theory.beam.equilibrium import Model, State
    from verify.theory.beam.problem import BeamProblem


@dataclass(frozen=True)
class Units:
    """Units of the beam (length h, force EI / h^2, energy EI / h) and the data of the problem that rows need."""

    h: float
    arms: int
    force: float
    width: float
    law: Bilinear
    irreversible: bool
    reference_load: float  # LEFM, in units of the force
    scale: np.ndarray  # (2,) opening and load at which LEFM begins, in the units of the scene

    @staticmethod
    def of(problem: BeamProblem) -> Units:
        h, bending = problem.arm_thickness, problem.bending
        arms = 1 if problem.substrate else 2
        griffith = np.sqrt(2.0 / arms * problem.width * problem.toughness * bending) / problem.precrack
        force = bending / h**2
        scale = np.array([arms * griffith * problem.precrack**3 / (3.0 * bending), griffith])
        return Units(h, arms, force, problem.width, problem.law, problem.irreversible, griffith / force, scale)

    def deflection(self, opening: float) -> float:
        return opening / (self.arms * self.h)

    def gap(self, m: Model, y: np.ndarray) -> np.ndarray:
        """Gap (...,) at states (..., a), in the unit of length of the scene."""
        return self.arms * self.h * m.arm.gap(y)[0]


def row(units: Units, m: Model, state: State, before: Mapping[str, float] | None) -> dict[str, float]:
    """Curve and evidence columns of a state; without the row ``before``, of the unloaded specimen.

    Work: along every step a cubic over its chord, with the exact slopes of the path. Interface energies: exact
    integrals of piecewise polynomials.
    J identity of this beam, the first integral of its equations: J w = n (P |v'(0)| - W(0)) for n arms, with v' the
    slope of the deflection (shear included, as du_y/dX of a face) and W the strain energy per length at the loaded
    section. For a strip the energy per length of the substrate at its right edge is subtracted, that at its left edge
    added.
    """
    slope = float(-state.tangent.node[0, FORCE] / (units.arms * units.h * state.tangent.node[0, V])) * units.force
    if before is None:
        return unloaded(m, units, slope)
    field, kind, h = state.field, state.kind, units.h
    first = field.node[0]
    rate = float(m.arm.rates(first, np.zeros(3))[0][V])
    opening, load = units.arms * h * first[V], -first[FORCE] * units.force
    heading = float(np.copysign(1.0, state.tangent.node[0, V]))
    energies = _energies(units, m, state)
    return {
        "opening": opening,
        "load": load,
        "crack_length": h * max([m.ends.precrack, *field.x[1:][kind == OPEN]]),
        "stored_energy": energies["bulk"] + energies["cohesive"] + energies["contact"],
        "dissipated_energy": energies["dissipated"],
        "external_work": before["external_work"]
        + _work(units, before, {"opening": opening, "load": load, "load_slope": slope, "heading": heading}),
        "newton_iterations": float(state.iterations),
        "load_slope": slope,
        "heading": heading,
        "tip_opening": float(units.gap(m, field.at(np.array(m.ends.precrack)))),
        "end_opening": float(units.gap(m, field.node[-1])),
        "damage_front": h * max(m.ends.precrack, state.front),
        "face_slope_top": rate,
        "face_slope_bottom": -rate if units.arms == 2 else 0.0,
        "face_energy": _face_energy(m, field) * units.arms * units.force / units.width,
        "interface_force": energies["resultant"],
        "bulk_energy": energies["bulk"],
        "cohesive_energy": energies["cohesive"],
        "contact_energy": energies["contact"],
    }


def unloaded(m: Model, units: Units, slope: float) -> dict[str, float]:
    """The row of the specimen before it is loaded, with the slope of its path there."""
    names = (
        "opening load crack_length stored_energy dissipated_energy external_work newton_iterations load_slope heading "
        "tip_opening end_opening damage_front face_slope_top face_slope_bottom face_energy interface_force bulk_energy "
        "cohesive_energy contact_energy"
    ).split()
    start = dict.fromkeys(("crack_length", "damage_front"), m.ends.precrack * units.h)
    return {**dict.fromkeys(names, 0.0), **start, "load_slope": slope, "heading": 1.0}


def _work(units: Units, before: Mapping[str, float], row: Mapping[str, float]) -> float:
    """Work of a step: under its chord, and between chord and path; the opening may turn back.

    The path is taken as the cubic over the chord, both axes scaled, that has the directions of the path at its ends.
    """
    chord = np.array([row["opening"] - before["opening"], row["load"] - before["load"]]) / units.scale
    rises = []
    for end in (before, row):
        along = end["heading"] * np.array([1.0, end["load_slope"]]) / units.scale
        rises.append((chord[0] * along[1] - chord[1] * along[0]) / (chord @ along))
    between = (chord @ chord) / 12.0 * (rises[0] - rises[1]) * units.scale.prod()
    return 0.5 * (before["load"] + row["load"]) * chord[0] * units.scale[0] + between


def _face_energy(m: Model, field: Field) -> float:
    """Energy per unit length at the loaded face, and of a substrate at its right edge less that at its left one."""
    face = float(m.arm.energy(field.node[0], np.zeros(3)))
    if not isinstance(m.arm, Strip):
        return face
    right, left = field.at(np.array(m.ends.edge)), field.node[-1]
    return face + 0.5 * m.arm.bed * float(right[SURFACE] ** 2 - left[SURFACE] ** 2)


def _law(units: Units, kind: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Traction and area under the envelope, by the zone that was solved (not by the sign of a gap of no size)."""
    law = units.law
    below = law.penalty if law.contact else law.stiffness
    k = np.array([0.0, 0.0, law.softening, law.stiffness, below, 0.0])[kind]
    traction = k * gap - np.where(kind == SOFTENING, law.softening * law.g_open, 0.0)
    return traction, np.where(np.isin(kind, (ELASTIC, CONTACT)), 0.5 * k * gap**2, law.area(gap))


def _energies(units: Units, m: Model, state: State) -> dict[str, float]:
    field, kind = state.field, state.kind[:, None]
    dx, gap = field.stage_dx, units.gap(m, field.stage)
    traction, area = _law(units, np.broadcast_to(kind, gap.shape), gap)
    w_dx = units.width * units.h * dx
    back = 0.5 * traction * gap if units.irreversible else area
    sealed = CONTACT if units.law.contact else -1
    bonded = ~np.isin(kind, (FREE, BARE))
    lost = np.where(np.isin(kind, (OPEN, SOFTENING)), area - back, 0.0)
    return {
        "bulk": units.arms * units.force * units.h * float(np.sum(m.arm.energy(field.stage, m.base.on[kind]) * dx)),
        "cohesive": float(np.sum(np.where(bonded & (kind != sealed), back, 0.0) * w_dx)),
        "contact": float(np.sum(np.where(kind == sealed, back, 0.0) * w_dx)),
        "dissipated": float(np.sum(lost * w_dx)),
        "resultant": float(np.sum(traction * w_dx)),
    }


def snapshot(units: Units, m: Model, state: State, values: Mapping[str, float]) -> dict[str, object]:
    """The interface of a state at the Gauss points of its mesh; a beam has no field to show."""
    bonded = ~np.isin(state.kind, (FREE, BARE))
    kind = np.repeat(state.kind[bonded], state.field.stage.shape[1])
    gap = units.gap(m, state.field.stage[bonded]).ravel()
    history = np.where(kind == ELASTIC, 0.0, np.maximum(gap, 0.0))
    return {
        "opening": values["opening"],
        "load": values["load"],
        "s_q": units.h * state.field.stage_x[bonded].ravel(),
        "gap_q": gap,
        "traction_q": _law(units, kind, gap)[0],
        "damage_q": units.law.damage(history),
        "X_euvi": np.zeros((0, 1, 1, 2)),
        "u_euvi": np.zeros((0, 1, 1, 2)),
        "stress_euv": np.zeros((0, 1, 1)),
    }
