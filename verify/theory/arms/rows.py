"""Rows and snapshots of two arms on a bond: curve, energies, J by two routes, reactions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from verify.theory.arms.equilibrium import Model, State
from verify.theory.arms.interface import History
from verify.theory.arms.mesh import UNKNOWNS, Points
from verify.theory.arms.structure import TURN, rigid


@dataclass(frozen=True)
class Rows:
    """What rows need: the model, and X from which the crack counts.

    The work is the sum of the trapezoids under the curve. Slopes of the path are of no use: while a crack grows through
    points of a law, they are those between two points that break.
    """

    model: Model
    loaded_at: float

    def row(self, state: State, before: State, last: Mapping[str, float]) -> dict[str, float]:
        """Columns of a state, after the state ``before`` and its row ``last``."""
        opening = float(self.model.structure.load @ state.x)
        traction = self.model.traction(state, before.history)
        work = 0.5 * (last["load"] + state.load) * (opening - last["opening"])
        return {
            "opening": opening,
            "load": state.load,
            "external_work": last["external_work"] + work,
            "newton_iterations": float(state.iterations),
            **self._crack(state),
            **self._energies(state, traction),
            **self._j(state, traction),
            "mode_ratio": self._mode_ratio(state, before.history),
            **{f"support_{i + 1}": float(R) for i, R in enumerate(state.reactions)},
            **self._balance(state, traction),
        }

    def unloaded(self, first: Mapping[str, float]) -> dict[str, float]:
        """The row of the specimen at rest, from that of a state before damage."""
        kept = ("crack_length", "damage_front", "mode_ratio")
        return {**dict.fromkeys(first, 0.0), **{name: first[name] for name in kept}}

    @cached_property
    def _x(self) -> np.ndarray:
        """X (E, q) of the points of the interface."""
        return self.model.structure.mesh.places(self.model.structure.points)

    @property
    def _tip(self) -> tuple[int, int]:
        """The point at the end of the precrack."""
        e, q = np.unravel_index(int(np.argmax(self.model.interface.bonded)), self._x.shape)
        return int(e), int(q)

    def _crack(self, state: State) -> dict[str, float]:
        tip, end = state.jump[self._tip], state.jump[-1, -1]
        return {
            "crack_length": self._reached(state, 2.0) - self.loaded_at,
            "damage_front": self._reached(state, 1.0) - self.loaded_at,
            "tip_opening": float(tip[0]),
            "tip_slip": float(tip[1]),
            "end_opening": float(end[0]),
        }

    def _reached(self, state: State, level: float) -> float:
        """X of the last point beyond the tip that is broken (2) or damaged (1), between points by the progress."""
        face, x, d = self.model.interface, self._x.ravel(), state.history.d.ravel()
        beyond = np.flatnonzero(face.bonded.ravel() & (d >= 1.0 if level > 1.0 else d > 0.0))
        if len(beyond) == 0:
            return float(self._x[self._tip])
        i = int(beyond[-1])
        if i + 1 == len(x):
            return float(x[-1])
        r = face.progress(state.jump[..., 0], state.jump[..., 1]).ravel()[i : i + 2]
        part = (r[0] - level) / (r[0] - r[1]) if r[0] > level > r[1] else 0.0
        return float(x[i] + part * (x[i + 1] - x[i]))

    def _energies(self, state: State, traction: np.ndarray) -> dict[str, float]:
        """Stored in arms and bond, and taken by damage and friction (energy); the rest of the work is none."""
        one, face, law = self.model.structure, self.model.interface, self.model.interface.law
        g, s, area = state.jump[..., 0], state.jump[..., 1], one.weight_eq
        x_el = state.x[one.mesh.dofs_el]
        bulk = 0.5 * float(np.einsum("ea,eab,eb->", x_el, one.stiffness_eab, x_el, optimize=True))
        bulk += 0.5 * float(np.sum(area[..., None] * np.array(face.give) * traction**2))
        pressed = (g < 0.0) & law.contact
        K, Ks = law.slopes
        cohesive = 0.5 * (1.0 - state.history.d) * (K * np.where(pressed, 0.0, g) ** 2 + Ks * s**2)
        contact = float(np.sum(area * np.where(pressed, 0.5 * law.penalty * g**2, 0.0)))
        rubbed = float(np.sum(area * state.history.rubbed))
        released = float(np.sum(area * state.history.released)) if law.irreversible else 0.0
        bond = float(np.sum(area * cohesive))
        return {
            "stored_energy": bulk + bond + contact,
            "dissipated_energy": released + rubbed,
            "bulk_energy": bulk,
            "cohesive_energy": bond,
            "contact_energy": contact,
            "friction_energy": rubbed,
        }

    def _j(self, state: State, traction: np.ndarray) -> dict[str, float]:
        """J of the bond, -int (p dg/dX + t ds/dX) dX over all faces, and J of loads and supports, equal in balance.

        g and s are the jumps of the beams, bond and give of the arms together. Both arms together have the first
        integral d/dX (N u' + M phi' + V w' - U) = b (p dg/dX + t ds/dX) - q w', with U their energy per length and q
        the forces on patches: b J = [N u' + M phi' + V w' - U] at the left end less that at the right one, less the sum
        of force times mean slope over the patches.
        """
        one = self.model.structure
        slope = np.einsum("qia,ea->eqi", one.jump_slope_qia, state.x[one.mesh.dofs_el], optimize=True)
        parts = -np.einsum("eqi,eqi,q->i", traction, slope, one.points.weight, optimize=True)
        turned = state.load * float(one.load_slope @ state.x) + float(state.reactions @ (one.held_slope @ state.x))
        J = (self._flux(state, 0) - self._flux(state, -1) - turned) / one.width
        return {"J_bond": float(parts.sum()), "J_shear": float(parts[1]), "J_loads": J}

    def _flux(self, state: State, element: int) -> float:
        """N u' + M phi' + V w' - U of both arms, at the left end (element 0) or the right one (-1)."""
        one = self.model.structure
        points = Points.of(np.array([0.0 if element == 0 else 1.0]), np.ones(1))
        x = state.x[one.mesh.dofs_el[element]]
        strain = one.strain(points)[element, 0] @ x
        force = one.sections * strain
        phi = (points.N_qa[0] @ x.reshape(-1, UNKNOWNS))[[TURN, 3 + TURN]]
        return float(0.5 * force @ strain + force[[2, 5]] @ phi)

    def _mode_ratio(self, state: State, before: History) -> float:
        """B where damage grows and the bond is furthest on its way, of all points that are not broken."""
        face = self.model.interface
        g, s = state.jump[..., 0], state.jump[..., 1]
        r = np.where(face.bonded & (before.d < 1.0), face.progress(g, s), -1.0)
        growing = state.history.d > before.d
        r = np.where(growing, r, -1.0) if np.any(growing & (r >= 0.0)) else r
        at = np.unravel_index(int(np.argmax(r)), r.shape)
        return float(face.law.mode_ratio(g[at], s[at]))

    def _balance(self, state: State, traction: np.ndarray) -> dict[str, float]:
        """Forces and moment about the lower arm's right end of all that acts on the upper arm: zero."""
        one, mesh = self.model.structure, self.model.structure.mesh
        faces = np.einsum("qia,eqi,eq->ea", one.jump_qia, traction, one.weight_eq, optimize=True)
        forces = one.load * state.load + one.held.T @ state.reactions
        forces = forces - np.bincount(mesh.dofs_el.ravel(), faces.ravel(), mesh.count)
        upper = np.tile([1.0, 1.0, 1.0, 0.0, 0.0, 0.0], mesh.count // UNKNOWNS)
        sums = (forces * upper) @ rigid(one.arms, mesh)
        return dict(zip(("arm_force_x", "arm_force_y", "arm_moment"), map(float, sums), strict=True))
