"""Sections of every kind: derivatives, motions without energy, and exact states of stress."""

from __future__ import annotations

import numpy as np
import pytest

from iga.elements.elasticity import orthotropic
from tests.verify.theory.arms.quotients import derivative
from verify.theory.arms.sections import SHEAR_CORRECTION, TURN, Base, Beam, Plane, Section, X, Y

E1, E2, G, NU = 120.0, 9.0, 5.0, 0.3
D = orthotropic(E1, E2, G, NU, plane="stress")
B, H, MIDDLE = 2.0, 1.4, 0.3


def plane(order: int, finite: bool = True, clamped: float = 0.0) -> Plane:
    return Plane(B, H, MIDDLE, finite, D, order, clamped)


BEAM = Beam(B, H, MIDDLE, True, E1 * B * H, E1 * B * H**3 / 12.0, SHEAR_CORRECTION * G * B * H)
SECTIONS: dict[str, Section] = {
    "beam": BEAM,
    "order 2": plane(2),
    "order 3": plane(3),
    "order 5": plane(5),
    "clamped below": plane(5, clamped=-1.0),
    "clamped above": plane(3, clamped=1.0),
    "base": Base(B, H, MIDDLE, True, 3.0, 7.0),
}
FREE = {name: one for name, one in SECTIONS.items() if np.any(one.rigid)}


@pytest.mark.parametrize("name", SECTIONS)
def test_forces_and_stiffness_are_derivatives_of_the_energy(name):
    """At states bent far beyond any specimen; the unstrained stiffness is that of small strains."""
    one = SECTIONS[name]
    z = 0.4 * np.random.default_rng(1).normal(size=(6, 2 * one.unknowns))
    U, f, tangent = one.respond(z)
    K = tangent()
    assert f == pytest.approx(derivative(lambda at: one.respond(at)[0], z), rel=1e-6, abs=1e-6 * np.abs(f).max())
    assert K == pytest.approx(derivative(lambda at: one.respond(at)[1], z), rel=1e-6, abs=1e-6 * np.abs(K).max())
    rest = one.respond(np.zeros(2 * one.unknowns))
    assert rest[0] == 0.0 and np.all(rest[1] == 0.0)
    assert rest[2]() == pytest.approx(one.stiffness, abs=1e-12 * np.abs(one.stiffness).max())
    assert one.energy(1e-5 * z) == pytest.approx(0.5e-10 * np.einsum("na,ab,nb->n", z, one.stiffness, z), rel=1e-3)
    assert U == pytest.approx(one.energy(z))


def turned(one: Section, angle: float) -> np.ndarray:
    """State of a section that turns as a rigid body about its middle: u = -Y sin, v = Y (cos - 1), and x along."""
    c, s = np.cos(angle), np.sin(angle)
    if isinstance(one, Beam):
        return np.array([0.0, 0.0, angle, c - 1.0, s, 0.0])
    values = np.zeros((2, one.unknowns // 2))
    slopes = np.zeros_like(values)
    values[X, 1], values[Y, 1] = -0.5 * H * s, 0.5 * H * (c - 1.0)
    slopes[X, 0], slopes[Y, 0] = c - 1.0, s
    return np.concatenate((values.ravel(), slopes.ravel()))


@pytest.mark.parametrize("angle", [0.3, -1.2, 2.5])
@pytest.mark.parametrize("name", FREE)
def test_motions_as_a_whole_have_no_energy(name, angle):
    one = FREE[name]
    U, f, _ = one.respond(turned(one, angle))
    assert abs(U) < 1e-13 * E1 and np.abs(f).max() < 1e-12 * E1
    shift = np.concatenate((one.rigid[:, X] + 2.0 * one.rigid[:, Y], np.zeros(one.unknowns)))
    assert one.respond(shift)[0] == 0.0
    small = np.concatenate((one.rigid[:, TURN], one.rigid[:, Y]))
    assert np.abs(one.stiffness @ small).max() < 1e-12 * E1


@pytest.mark.parametrize("name", ["order 2", "order 3", "order 5"])
def test_even_tension_and_even_bending_are_exact(name):
    """Energy per length E A e^2 / 2 and E I k^2 / 2 with no stress across: Y^2 of bending needs order 2."""
    one = FREE[name]
    m = one.unknowns // 2
    z = np.zeros((2, 2, 2, m))  # case, value or slope, component
    z[0, 1, X, 0], z[0, 0, Y, 1] = 1.0, -NU * 0.5 * H
    squared = 0.25 * H**2  # Y^2 = (h^2 / 4) (1 + 2 (P_2 - P_0) / 3)
    z[1, 1, X, 1] = -0.5 * H
    z[1, 0, Y, 0], z[1, 0, Y, 2] = 0.5 * NU * squared, NU * squared / 3.0
    z = z.reshape(2, -1)
    forces = z @ one.stiffness
    assert 0.5 * np.sum(forces * z, axis=1) == pytest.approx([0.5 * E1 * B * H, 0.5 * E1 * B * H**3 / 12.0])
    assert np.abs(forces[:, : 2 * m]).max() < 1e-12 * np.abs(forces).max(), "nothing across, nothing in shear"


@pytest.mark.parametrize("name", SECTIONS)
def test_faces_and_means_are_those_of_a_motion_as_a_whole(name):
    """u - Y t, w of a small turn t about the middle."""
    one = SECTIONS[name]
    for side in (-1.0, 1.0):
        up, turn = (0.0, 0.0) if name == "base" or isinstance(one, Plane) and one.clamped else (1.0, -side * 0.5 * H)
        assert one.face(side) @ one.rigid[:, Y] == pytest.approx([0.0, up])
        assert one.face(side) @ one.rigid[:, TURN] == pytest.approx([turn, 0.0])
    if name in FREE:
        assert np.array([one.mean(i) for i in (X, Y, TURN)]) @ one.rigid == pytest.approx(np.eye(3), abs=1e-12)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_clamped_face_does_not_move(side):
    one = plane(4, clamped=side)
    assert np.abs(one.face(side)).max() < 1e-12 and np.all(one.face(-side).sum(axis=1) == 1.0)
    assert np.linalg.eigvalsh(one.stiffness[: one.unknowns, : one.unknowns]).min() > 0.0, "nothing moves for free"
