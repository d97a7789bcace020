"""Rows and snapshots of arms on a bond: curve, energies, J by two routes, balances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from verify.theory.arms.equilibrium import Model, State
from verify.theory.arms.sections import Y
from verify.theory.arms.splines import Shapes
from verify.theory.arms.structure import rigid_motions


@dataclass(frozen=True)
class Rows:
    """Rows of a model.

    The work is the sum of the trapezoids under the curve. Slopes of the path are of no use: while a crack grows through
    points of a law, they are those between two points that break.
    """

    model: Model

    def row(self, state: State, before: State, last: Mapping[str, float] | None) -> dict[str, float]:
        """Columns of a state, after the state ``before`` and its row ``last``; None before the first."""
        face = self.model.interface
        now = face.respond(state.jump, before.history)
        last = last or {"opening": 0.0, "load": 0.0, "external_work": 0.0}
        opening = self.model.opening(state.x)
        work = 0.5 * (last["load"] + state.load) * (opening - last["opening"])
        row = {
            "opening": opening,
            "load": state.load,
            "external_work": last["external_work"] + work,
            "newton_iterations": float(state.iterations),
            "residual": state.residual,
            **self._crack(state),
            **self._energies(state, now.traction),
        }
        mode = self._sliding(state, before, now.traction) if face.bond.slides else self._opening(state, now.traction)
        return {**row, **mode}

    def unloaded(self, first: Mapping[str, float]) -> dict[str, float]:
        """The row of the specimen at rest, from that of a state before damage."""
        kept = ("crack_length", "damage_front", "mode_ratio")
        return {**dict.fromkeys(first, 0.0), **{name: first[name] for name in kept if name in first}}

    @cached_property
    def _way(self) -> np.ndarray:
        """Distance (E, q) of the points of the interface from the loaded end."""
        return np.abs(self.model.structure.at_points - self.model.structure.problem.loaded_at)

    @cached_property
    def _tip(self) -> float:
        """X of the end of the bond next to the load."""
        problem = self.model.structure.problem
        return min(problem.bonded, key=lambda x: abs(x - problem.loaded_at))

    def _crack(self, state: State) -> dict[str, float]:
        tip, end = (self.model.structure.jump_at(state.x, *place) for place in self._bond_ends)
        found = {
            "crack_length": self._reached(state, 1.0),
            "damage_front": self._reached(state, 0.0),
            "tip_opening": float(tip[0]),
            "end_opening": float(end[0]),
        }
        return {**found, "tip_slip": float(tip[1])} if len(tip) > 1 else found

    @cached_property
    def _bond_ends(self) -> list[tuple[int, Shapes]]:
        """Element and functions at the end of the bond next to the load, and at the other one."""
        mesh, problem = self.model.structure.mesh, self.model.structure.problem
        within = min(problem.lengths) * (1.0 - 1e-12)
        return [mesh.at(min(x, within)) for x in sorted(problem.bonded, key=lambda x: abs(x - problem.loaded_at))]

    def _reached(self, state: State, level: float) -> float:
        """Length of the crack (level 1) or to the end of damage (0), between points by their progress."""
        face, start = self.model.interface, abs(self._tip - self.model.structure.problem.loaded_at)
        done = state.history.progress > level if level < 1.0 else state.history.progress >= level
        done = done & face.bonded
        if not done.any():
            return start
        way, bonded = self._way.ravel(), face.bonded.ravel()
        last = int(np.argmax(np.where(done.ravel(), way, -1.0)))
        beyond = bonded & (way > way[last])
        if not beyond.any():
            return float(way[last])
        after = int(np.argmin(np.where(beyond, way, np.inf)))
        r = face.bond.progress(*(one.ravel()[[last, after]] for one in face.split(state.jump))) - 1.0
        part = (r[0] - level) / (r[0] - r[1]) if r[0] > level > r[1] else 0.0
        return float(way[last] + part * (way[after] - way[last]))

    def _energies(self, state: State, traction: np.ndarray) -> dict[str, float]:
        """Stored in arms and bond, and taken by damage and friction (energy)."""
        one, face = self.model.structure, self.model.interface
        law, (K, Ks), area = face.bond, face.bond.slopes, one.points.weight
        g, s = face.split(state.jump)
        pressed = (g < 0.0) & law.contact
        bulk = one.energy(state.x) + 0.5 * float(np.einsum("eq,j,eqj->", area, face.give, traction**2))
        bond = float(np.sum(area * 0.5 * (1.0 - state.history.d) * (K * np.where(pressed, 0.0, g) ** 2 + Ks * s**2)))
        contact = float(np.sum(area * np.where(pressed, 0.5 * law.penalty * g**2, 0.0)))
        released = float(np.sum(area * np.where(face.bonded, state.history.released, 0.0)))
        rubbed = float(np.sum(area * state.history.rubbed))
        if not face.bond.irreversible:
            bond, released = bond + released, 0.0
        return {
            "stored_energy": bulk + bond + contact,
            "dissipated_energy": released + rubbed,
            "bulk_energy": bulk,
            "cohesive_energy": bond,
            "contact_energy": contact,
            **({"friction_energy": rubbed} if face.bond.slides else {}),
        }

    def _opening(self, state: State, traction: np.ndarray) -> dict[str, float]:
        """J of the loaded faces, b J = P |du_y/dX| less the energy per length there, more that at the far ends; and the
        resultant of the bond."""
        one = self.model.structure
        slope = float(one.load_slope @ state.x)
        left, right = one.end_energies(state.x)
        ahead = left - right if one.problem.loaded_at < 0.5 * one.problem.length else right - left
        return {
            "face_slope_top": 0.5 * slope if one.problem.mirrored else slope,
            "face_slope_bottom": -0.5 * slope if one.problem.mirrored else 0.0,
            "face_energy": ahead / one.problem.width,
            "interface_force": float(np.sum(one.points.weight * traction[..., 0])),
        }

    def _sliding(self, state: State, before: State, traction: np.ndarray) -> dict[str, float]:
        """J of the bond, -int (p dg/dX + t ds/dX) dX over all faces, and J of loads and supports, equal in balance:

        b J = [U at the right ends] - [U at the left ends] - sum of force times mean slope; g and s are the jumps of the
        faces, of bond and give of the arms together. Both arms together have the first integral d/dX (f_c' c' - U) =
        b (p dg/dX + t ds/dX) - q c', with q the forces on patches.
        """
        one = self.model.structure
        y, dy = one.functionals(state.x), one.functionals(state.x, slopes=True)
        rate = np.matmul(one.faces.jump(y).first, dy[..., None])[..., 0]
        parts = -np.einsum("eqj,eqj,eq->j", traction, rate, one.points.weight) / one.problem.width
        found = {
            "J_bond": float(parts.sum()),
            "J_shear": float(parts[1]),
            "J_loads": one.j_of_loads(state.x, state.load, state.reactions),
            "mode_ratio": self._mode_ratio(state, before),
            **{f"support_{i + 1}": float(R) for i, R in enumerate(state.reactions)},
        }
        return found if one.problem.finite else {**found, **self._balance(state, traction)}

    def _mode_ratio(self, state: State, before: State) -> float:
        """B where damage grows and the bond is furthest on its way, of all points that are not broken."""
        face = self.model.interface
        g, s = face.split(state.jump)
        r = np.where(face.bonded & (before.history.d < 1.0), face.bond.progress(g, s), -1.0)
        growing = state.history.d > before.history.d
        r = np.where(growing, r, -1.0) if np.any(growing & (r >= 0.0)) else r
        at = np.unravel_index(int(np.argmax(r)), r.shape)
        return float(face.bond.mode_ratio(g[at], s[at]))  # type: ignore[union-attr]

    def _balance(self, state: State, traction: np.ndarray) -> dict[str, float]:
        """Forces and moment about the lower right corner of all that acts on the upper arm: zero."""
        one = self.model.structure
        forces = one.load * state.load + one.held.T @ state.reactions - one.bond_forces(traction)
        upper = np.zeros(one.unknowns)
        upper[one.columns[0]] = 1.0
        modes = rigid_motions(one.mesh, one.sections)
        modes[:, 2] -= one.problem.length * modes[:, Y]
        sums = (forces.reshape(-1, one.unknowns) * upper).ravel() @ modes
        return dict(zip(("arm_force_x", "arm_force_y", "arm_moment"), map(float, sums), strict=True))

    def snapshot(self, state: State, before: State) -> dict[str, object]:
        """The interface of a state; there is no field to show."""
        face = self.model.interface
        order = np.argsort(self._way[face.bonded])
        now = face.respond(state.jump, before.history)
        columns = {"gap_q": state.jump[..., 0], "traction_q": now.traction[..., 0], "damage_q": state.history.d}
        if face.bond.slides:
            columns |= {"slip_q": state.jump[..., 1], "shear_q": now.traction[..., 1]}
        return {
            "opening": self.model.opening(state.x),
            "load": state.load,
            "s_q": self._way[face.bonded][order],
            **{name: values[face.bonded][order] for name, values in columns.items()},
            "X_euvi": np.zeros((0, 1, 1, 2)),
            "u_euvi": np.zeros((0, 1, 1, 2)),
            "stress_euv": np.zeros((0, 1, 1)),
        }
