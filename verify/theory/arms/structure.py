"""The bodies without their bond: splines along them, forces and stiffness, loads and supports, jumps of the faces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.linalg import null_space

from verify.support.refusal import Refusal
from verify.theory.arms.faces import Faces, faces_of
from verify.theory.arms.problem import ArmsProblem, Load, Support
from verify.theory.arms.sections import TURN, Beam, Section, X, Y, sections
from verify.theory.arms.splines import ARM_DEGREE, Shapes, Splines

#: Gauss points of the interface in an element.
INTERFACE_POINTS = 10


class Part(NamedTuple):
    """A part of the stiffness: matrices ``K`` (E, a a, k k) of elements for some unknowns ``at`` (k,) of a function."""

    at: np.ndarray
    K: np.ndarray


@dataclass(frozen=True)
class Structure:
    """Bodies on one mesh, whose unknowns are those of all sections, function after function.

    ``load`` (n,) : forces for a load of 1, which is the opening as a function of the unknowns, too
    ``held`` (m, n) : mean displacements that supports keep at zero
    ``load_slope`` (n,), ``held_slope`` (m, n) : the same of derivatives by X
    ``pins`` (k, n) : motions of an end that nothing else holds; the first of ``springs`` (3, n) at most
    """

    problem: ArmsProblem
    mesh: Splines
    sections: tuple[Section, ...]
    faces: Faces
    load: np.ndarray
    held: np.ndarray
    load_slope: np.ndarray
    held_slope: np.ndarray
    springs: np.ndarray
    pins: np.ndarray

    @staticmethod
    def of(problem: ArmsProblem, mesh: Splines) -> Structure:
        """On a mesh, whose elements end where the loads and supports do.

        Raises
        ------
        Refusal : the loads move the specimen as a rigid body
        """
        parts = sections(problem)
        load, load_slope = _functionals(problem, mesh, parts, problem.loads)
        held, held_slope = _functionals(problem, mesh, parts, problem.supports)
        share = np.array([one.share for one in problem.loads])
        load, load_slope = share @ load, share @ load_slope
        springs, pins = _pins(problem, mesh, parts, load, held)
        return Structure(
            problem, mesh, parts, faces_of(problem, parts), load, held, load_slope, held_slope, springs, pins
        )

    @property
    def unknowns(self) -> int:
        """Of one function."""
        return sum(part.unknowns for part in self.sections)

    @cached_property
    def per_unknown(self) -> np.ndarray:
        """Factors (m,) that make forces of moments, those on the unknowns that are rotations."""
        found = []
        for part in self.sections:
            one = np.ones(part.unknowns)
            if isinstance(part, Beam):
                one[TURN] = 1.0 / part.thickness
            found.append(one)
        return np.concatenate(found)

    @property
    def count(self) -> int:
        return self.mesh.count * self.unknowns

    @property
    def band(self) -> int:
        """Entries beside the diagonal."""
        return (ARM_DEGREE + 1) * self.unknowns - 1

    @cached_property
    def columns(self) -> tuple[slice, ...]:
        """Unknowns of every body among those of a function."""
        ends = np.cumsum([0, *(part.unknowns for part in self.sections)])
        return tuple(slice(a, b) for a, b in zip(ends[:-1], ends[1:], strict=True))

    @cached_property
    def functions(self) -> np.ndarray:
        """Functions (E, a) of every element."""
        return self.mesh.first[:, None] + np.arange(ARM_DEGREE + 1)

    @cached_property
    def dofs(self) -> np.ndarray:
        """Unknowns (E, a, m) of every element."""
        return self.functions[..., None] * self.unknowns + np.arange(self.unknowns)

    def local(self, x: np.ndarray) -> np.ndarray:
        """Coefficients (E, a, m) of every element."""
        return x.reshape(-1, self.unknowns)[self.functions]

    @cached_property
    def _inside(self) -> list[np.ndarray]:
        """Elements of every body."""
        middle = 0.5 * (self.mesh.ends[1:] + self.mesh.ends[:-1])
        return [np.flatnonzero(middle < length) for length in self.problem.lengths]

    @cached_property
    def _bulk_shapes(self) -> Shapes:
        return self.mesh.gauss(ARM_DEGREE if self.problem.finite else ARM_DEGREE + 1)

    @cached_property
    def _bulk_products(self) -> np.ndarray:
        return products(self._bulk_shapes.both, self._bulk_shapes.weight)

    @cached_property
    def linear(self) -> tuple[Part, ...]:
        """Stiffness of the unstrained bodies."""
        q, found = self._bulk_shapes.weight.shape[1], []
        for part, inside in zip(self.sections, self._inside, strict=True):
            m = part.unknowns
            D = np.tile(part.stiffness.reshape(2, m, 2, m).swapaxes(1, 2).reshape(4, m * m), (q, 1))
            found.append(self._bulk_products[inside] @ D)
        return self._parts(found)

    def _parts(self, of_bodies: Sequence[np.ndarray]) -> tuple[Part, ...]:
        """Of matrices (E', a a, m m) of the elements of every body."""
        found = []
        for K, at, inside in zip(of_bodies, self.columns, self._inside, strict=True):
            whole = np.zeros((len(self.mesh.sizes), *K.shape[1:]))
            whole[inside] = K
            found.append(Part(np.arange(at.start, at.stop), whole))
        return tuple(found)

    def bulk(self, x: np.ndarray) -> tuple[np.ndarray, Callable[[], tuple[Part, ...]]]:
        """Forces (n,) and what gives the stiffness of the bodies."""
        # an element that moves as a whole has no forces: left in, rounding of its motion adds up along the arms
        local = self.local(x)
        local = local - local[:, :1] * self._moving
        forces, tangents, shapes = np.zeros(local.shape), [], self._bulk_shapes
        for part, at, inside in zip(self.sections, self.columns, self._inside, strict=True):
            both, m = shapes.both[inside], part.unknowns
            z = self._states(both, local[inside][..., at])
            E, q = z.shape[:2]
            if self.problem.finite:
                _, f, tangent = part.respond(z)
                tangents.append(tangent)
            else:
                f = z @ part.stiffness
            f = f.reshape(E, q, 2, m) * shapes.weight[inside][..., None, None]
            forces[inside, :, at] += np.matmul(both.reshape(E, q * 2, -1).swapaxes(1, 2), f.reshape(E, q * 2, m))

        def stiffness() -> tuple[Part, ...]:
            found = []
            for tangent, inside, part in zip(tangents, self._inside, self.sections, strict=True):
                (E, q), m = shapes.weight[inside].shape, part.unknowns
                D = tangent().reshape(E, q, 2, m, 2, m).swapaxes(3, 4).reshape(E, q * 4, m * m)
                found.append(self._bulk_products[inside] @ D)
            return self._parts(found)

        return self.gathered(forces), stiffness if self.problem.finite else lambda: self.linear

    @cached_property
    def _moving(self) -> np.ndarray:
        """Unknowns (m,) that a translation changes, 1 or 0."""
        return np.concatenate([np.abs(part.rigid[:, [X, Y]]).sum(axis=1) for part in self.sections])

    @staticmethod
    def _states(both: np.ndarray, local: np.ndarray) -> np.ndarray:
        """States (E, q, 2m) from functions (E, q, 2, a) and coefficients (E, a, m)."""
        E, q, _, a = both.shape
        return np.matmul(both.reshape(E, q * 2, a), local).reshape(E, q, -1)

    def energy(self, x: np.ndarray) -> float:
        """Strain energy of all bodies."""
        local, shapes, total = self.local(x), self._bulk_shapes, 0.0
        local = local - local[:, :1] * self._moving
        for part, at, inside in zip(self.sections, self.columns, self._inside, strict=True):
            z = self._states(shapes.both[inside], local[inside][..., at])
            total += float(np.sum(part.energy(z) * shapes.weight[inside]))
        return total

    @cached_property
    def _ends(self) -> list[tuple[int, Shapes]]:
        """Element and functions at the left end, and at the right ends of all bodies."""
        return [self.mesh.at(x) for x in (0.0, *(length * (1.0 - 1e-12) for length in self.problem.lengths))]

    def end_energies(self, x: np.ndarray) -> tuple[float, float]:
        """Energies per length of all bodies at their left ends and at their right ones."""
        found = []
        for right in (False, True):
            total = 0.0
            for i, (part, at) in enumerate(zip(self.sections, self.columns, strict=True)):
                e, shapes = self._ends[i + 1 if right else 0]
                local = x.reshape(-1, self.unknowns)[self.functions[e]][:, at]
                total += float(part.energy(np.concatenate((shapes.N[0] @ local, shapes.dN[0] @ local))))
            found.append(total)
        return found[0], found[1]

    def j_of_loads(self, x: np.ndarray, load: float, reactions: np.ndarray) -> float:
        """J of loads and supports for growth towards larger X."""
        turned = load * float(self.load_slope @ x) + float(reactions @ (self.held_slope @ x))
        left, right = self.end_energies(x)
        return (right - left - turned) / self.problem.width

    def gathered(self, forces: np.ndarray) -> np.ndarray:
        """Forces (n,) from those of the elements (E, a, m)."""
        return np.bincount(self.dofs.ravel(), forces.ravel(), self.count)

    @cached_property
    def common(self) -> np.ndarray:
        """Elements on which both faces are, (E,)."""
        return 0.5 * (self.mesh.ends[1:] + self.mesh.ends[:-1]) < min(self.problem.lengths)

    @cached_property
    def points(self) -> Shapes:
        """Functions at the points of the interface."""
        found = self.mesh.gauss(INTERFACE_POINTS)
        return found._replace(weight=found.weight * self.problem.width * self.common[:, None])

    @cached_property
    def at_points(self) -> np.ndarray:
        """X (E, q) of the points of the interface."""
        return self.mesh.x(0.5 * (1.0 + np.polynomial.legendre.leggauss(INTERFACE_POINTS)[0]))

    @cached_property
    def _point_products(self) -> np.ndarray:
        """Products (s, t, E, a a, q) of functions (s or t = 0) and slopes (1) at the points of the interface."""
        both, (E, q) = self.points.both[:, :, : 2 if self.faces.turns else 1], self.points.weight.shape
        found = np.einsum("eqsa,eqtb,eq->steabq", both, both, self.points.weight, optimize=True)
        return np.ascontiguousarray(found).reshape(*found.shape[:2], E, -1, q)

    def functionals(self, x: np.ndarray, shapes: Shapes | None = None, slopes: bool = False) -> np.ndarray:
        """Functionals y (E, q, i) of the faces at the points of the interface, or their derivatives by X."""
        at = shapes or self.points
        parts = (at.dN, at.ddN) if slopes else (at.N, at.dN)
        local = self.local(x)
        found = parts[0] @ (local @ self.faces.values.T)
        return found + parts[1] @ (local @ self.faces.slopes.T) if self.faces.turns else found

    def jump_at(self, x: np.ndarray, e: int, shapes: Shapes) -> np.ndarray:
        """Jump (J,) of the faces at a place, of which `Splines.at` tells element and functions."""
        local = x.reshape(-1, self.unknowns)[self.functions[e]]
        y = self.faces.values @ (shapes.N[0] @ local) + self.faces.slopes @ (shapes.dN[0] @ local)
        return self.faces.jump(y).value

    def bond_forces(self, f_eqi: np.ndarray) -> np.ndarray:
        """Forces (n,) of the forces per area on the functionals."""
        weighted = f_eqi * self.points.weight[..., None]
        found = (self.points.N.swapaxes(1, 2) @ weighted) @ self.faces.values
        if self.faces.turns:
            found = found + (self.points.dN.swapaxes(1, 2) @ weighted) @ self.faces.slopes
        return self.gathered(found)

    def bond_stiffness(self, H_eqij: np.ndarray) -> Part:
        """Stiffness of the bond with derivatives of forces by functionals, each of which has values or slopes."""
        K: np.ndarray | float = 0.0
        for (s, (i, rows)), (t, (j, columns)) in product(enumerate(self.faces.parts), repeat=2):
            H = H_eqij[:, :, i[:, None], j].reshape(*H_eqij.shape[:2], -1)
            K = K + (self._point_products[s, t] @ H) @ np.kron(rows, columns)
        return Part(self.faces.touched, np.asarray(K))


def products(both: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Products (E, a a, q s t) of functions and slopes (E, q, s, a), with weights (E, q)."""
    E, q, s, a = both.shape
    found = np.einsum("eqsa,eqtb,eq->eabqst", both, both, weight, optimize=True)
    return np.ascontiguousarray(found).reshape(E, a * a, q * s * s)


def _functionals(
    problem: ArmsProblem, mesh: Splines, parts: Sequence[Section], listed: Sequence[Load | Support]
) -> tuple[np.ndarray, np.ndarray]:
    """Mean displacements, and the means of their derivatives by X, (k, n) each, that go with loads or supports."""
    total = sum(part.unknowns for part in parts)
    found = np.zeros((2, len(listed), mesh.count, total))
    for i, one in enumerate(listed):
        length = problem.lengths[min(one.body or 0, len(parts) - 1)]
        ends = {"left": (0.0, 0.0), "right": (length, length)}
        if one.couple and one.side not in ends:
            raise Refusal(f"specimen: a couple must be on an end face, got the {one.side}")
        along = _means(mesh, *(ends.get(one.side) or one.extent or (0.0, length)))
        found[:, i] = along[..., None] * _rows(problem, parts, one)
    values, slopes = found.reshape(2, len(listed), mesh.count * total)
    return values, slopes


def _means(mesh: Splines, low: float, high: float) -> np.ndarray:
    """Means (2, n) of the functions and of their derivatives over a range of X, or at one place."""
    if high - low < 1e-9 * mesh.ends[-1]:
        e, one = mesh.at(low)
        first, parts = mesh.first[[e]], (one.N, one.dN)
    else:
        shapes, first = mesh.gauss(ARM_DEGREE), mesh.first
        inside = (mesh.ends[:-1] > low - 1e-9 * high) & (mesh.ends[1:] < high + 1e-9 * high)
        weight = shapes.weight * inside[:, None] / (high - low)
        parts = tuple(np.einsum("eqa,eq->ea", values, weight) for values in (shapes.N, shapes.dN))
    where = first[:, None] + np.arange(ARM_DEGREE + 1)
    return np.stack([np.bincount(where.ravel(), values.ravel(), mesh.count) for values in parts])


def _of_body(parts: Sequence[Section], body: int, values: np.ndarray) -> np.ndarray:
    """A functional (m,) of one section by the unknowns of all."""
    return np.concatenate([values if i == body else np.zeros(part.unknowns) for i, part in enumerate(parts)])


def _rows(problem: ArmsProblem, parts: Sequence[Section], one: Load | Support) -> np.ndarray:
    """Mean displacement or rotation (m,) of a place by the unknowns of all sections.

    The rotation of an end face of both arms as one is -int u_x (Y - Y_m) dY / int (Y - Y_m)^2 dY about its middle Y_m.
    """
    kind = TURN if one.couple else Y
    if one.side in ("top", "bottom"):
        body = one.body if one.body is not None else ("top", "bottom").index(one.side)
        return _of_body(parts, body, parts[body].face(1.0 if one.side == "top" else -1.0)[Y])
    if one.body is not None:
        there = one.body < len(parts)  # else it is the mirror image
        return _of_body(parts, one.body, parts[one.body].mean(kind)) if there else -parts[0].mean(kind)
    h = np.array([part.thickness for part in parts])
    if not one.couple:
        return np.concatenate([part.moments(Y)[0] / h.sum() for part in parts])
    middle, moments = 0.5 * (h[0] - h[1]), [part.moments(X) for part in parts]
    turned = [by_Y + (part.middle - middle) * flat for part, (flat, by_Y) in zip(parts, moments, strict=True)]
    return -12.0 / h.sum() ** 3 * np.concatenate(turned)


def _pins(
    problem: ArmsProblem, mesh: Splines, parts: Sequence[Section], load: np.ndarray, held: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Functionals of the springs that make the stiffness regular, and those of the motions that nothing else holds.

    Springs hold the end away from the load: of the lower arm where the bond slides, else of the upper one, which can
    move along X whatever the bond does. A specimen without supports turns until its loads act on one line, in place of
    the turn of its end (`_lever`).
    """
    body = len(parts) - 1 if problem.bond.slides else 0
    x_end = 0.0 if problem.loaded_at > 0.5 * problem.length else problem.lengths[body]
    rows = [_of_body(parts, body, parts[body].mean(i)) for i in (X, Y, TURN)]
    springs = np.stack([np.outer(_means(mesh, x_end, x_end)[0], row).ravel() for row in rows])
    if not problem.bond.slides:
        return springs[:1], springs[:1]
    lever = _lever(problem, mesh, parts)
    if problem.finite and not len(held) and lever.any():
        springs[TURN] = lever
    modes = rigid_motions(mesh, parts)
    scale = np.array([1.0, 1.0, 1.0 / problem.length])  # a turn moves by it times the length
    free = null_space(held @ modes * scale, rcond=1e-9) if len(held) else np.eye(3)
    if np.any(np.abs(load @ modes * scale @ free) > 1e-9 * np.abs(load).sum()):
        raise Refusal("specimen: the loads must balance each other where no support takes them")
    turn = np.array([1.0, 1.0, problem.length])
    return springs, free.T @ (springs * turn[:, None])


def _lever(problem: ArmsProblem, mesh: Splines, parts: Sequence[Section]) -> np.ndarray:
    """Displacement (n,) along X of the loads on end faces, over their distance: zero where these loads have no moment,
    however far the specimen has turned."""
    found, height = np.zeros(mesh.count * sum(part.unknowns for part in parts)), 0.0
    for one in problem.loads:
        if one.side not in ("left", "right") or one.couple or one.body is None or one.body >= len(parts):
            continue
        x = 0.0 if one.side == "left" else problem.lengths[one.body]
        row = _of_body(parts, one.body, one.share * parts[one.body].mean(X))
        found += np.outer(_means(mesh, x, x)[0], row).ravel()
        height += one.share * parts[one.body].middle
    return found / height if height else np.zeros_like(found)


def rigid_motions(mesh: Splines, parts: Sequence[Section]) -> np.ndarray:
    """Motions (n, 3) of all bodies along X, along Y, and by a small turn about X = 0, Y = 0."""
    rigid = np.concatenate([part.rigid for part in parts])
    middle = np.concatenate([np.full(part.unknowns, part.middle) for part in parts])
    modes = np.broadcast_to(rigid, (mesh.count, *rigid.shape)).copy()
    modes[:, :, TURN] += mesh.places[:, None] * rigid[:, Y] - middle * rigid[:, X]
    return modes.reshape(-1, 3)
