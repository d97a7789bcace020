"""Equations of a Newton step: the bordered band is the dense system, and its matrix the derivative of the forces."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from tests.verify.theory.arms.specimens import DCB, ENF, of_scene, on_rollers
from verify.support.refusal import Refusal
from verify.theory.arms.equations import Bordered, Pattern
from verify.theory.arms.equilibrium import Model
from verify.theory.arms.front import model
from verify.theory.arms.problem import Load
from verify.theory.arms.splines import ARM_DEGREE
from verify.theory.arms.structure import Part, Structure, rigid_motions

COARSE = {
    "enf": replace(on_rollers(ENF, 0.5), zone=60.0),
    "enf 3": replace(ENF, zone=60.0, order=3),
    "dcb of two arms": replace(DCB, zone=60.0),
    "opening": replace(of_scene("dcb-czm1"), zone=8.0),
    "finite": replace(of_scene("dcb-czm1", "effects.kinematics='finite'", order=3), zone=8.0),
    "finite sliding": replace(ENF, zone=60.0, kinematics="finite"),
    "finite sliding 3": replace(ENF, zone=60.0, order=3, kinematics="finite"),
    "peel": replace(of_scene("peel-60"), zone=40.0),
}


def dense(one: Structure, parts: Iterable[Part]) -> np.ndarray:
    """From matrices of the elements."""
    found, a = np.zeros((one.count, one.count)), ARM_DEGREE + 1
    for at, K in parts:
        dofs = one.dofs[..., at]
        places = np.broadcast_arrays(dofs[:, :, None, :, None], dofs[:, None, :, None, :])
        np.add.at(found, tuple(places), K.reshape(-1, a, a, len(at), len(at)))
    return found


@pytest.mark.parametrize("name", COARSE)
def test_the_bordered_band_is_the_dense_system(name):
    """With a bond of springs between the faces: balance of forces, supports, control, and no pinned motion."""
    one = model(COARSE[name]).structure
    pattern, rng = Pattern(one), np.random.default_rng(5)
    i = len(one.faces.values)
    bond = one.bond_stiffness(np.broadcast_to(100.0 * np.eye(i), (*one.at_points.shape, i, i)))
    K, load = (*one.linear, bond), float(np.abs(one.load).max())
    b = rng.normal(size=one.count)
    b[pattern.unused] = 0.0
    c, row = 1e-3 * rng.normal(size=len(one.held)), one.load
    found, along = Bordered(pattern, pattern.banded(K, pattern.springs)).solve(b, c, row, 0.1)
    left = dense(one, K) @ found.x - b - one.load * found.load - one.held.T @ found.reactions
    off_motions = left - one.pins.T @ np.linalg.lstsq(one.pins.T, left, rcond=None)[0]  # b is in no balance
    assert np.abs(off_motions).max() < 1e-6 * np.abs(dense(one, K) * found.x).max()
    assert one.held @ found.x == pytest.approx(c, abs=1e-9) and row @ found.x == pytest.approx(0.1, abs=1e-9)
    assert np.abs(one.pins @ found.x).max(initial=0.0) < 1e-8 * np.abs(found.x).max()
    assert row @ along.x == pytest.approx(1.0, abs=1e-8) and load > 0.0


@pytest.mark.parametrize("name", COARSE)
def test_stiffness_is_the_derivative_of_the_forces(name):
    """Of the bodies, and of a bond that opens and slides under its history, far from small strains."""
    m = model(COARSE[name])
    one, face, rng = m.structure, m.interface, np.random.default_rng(6)
    smooth = rng.normal(size=(one.mesh.count, one.unknowns)) * one.per_unknown
    x = 2e-3 * smooth.ravel()
    way = rng.normal(size=one.count)

    def forces(at: np.ndarray) -> np.ndarray:
        jump = one.faces.jump(one.functionals(at))
        traction = face.respond(jump.value, face.intact).traction
        f_y = np.matmul(traction[..., None, :], jump.first)[..., 0, :]
        return one.bulk(at)[0] + one.bond_forces(f_y)

    jump = one.faces.jump(one.functionals(x))
    now = face.respond(jump.value, face.intact)
    H = jump.first.swapaxes(-1, -2) @ now.tangent @ jump.first
    if jump.second is not None:
        H = H + np.sum(now.traction[..., None, None] * jump.second, axis=-3)
    K = (*one.bulk(x)[1](), one.bond_stiffness(H))
    h = 1e-9
    quotient = (forces(x + h * way) - forces(x - h * way)) / (2.0 * h)
    assert dense(one, K) @ way == pytest.approx(quotient, rel=1e-4, abs=1e-4 * np.abs(quotient).max())


@pytest.mark.parametrize("order", [1, 3])
def test_arms_that_move_as_a_whole_have_no_forces(order):
    """Not even by rounding, which would add up along the arms to what statics then misses."""
    one: Model = model(replace(ENF, order=order))
    moved = rigid_motions(one.structure.mesh, one.structure.sections)[:, :2] @ np.array([123.456, 1234.567])
    assert not one.structure.bulk(moved)[0].any()


@pytest.mark.parametrize(
    ("problem", "message"),
    [
        (replace(ENF, supports=ENF.supports[:1]), "balance"),
        (replace(ENF, loads=(Load(0, "top", 1.0, (3.0, 3.0), couple=True),)), "end face"),
    ],
)
def test_loads_that_nothing_takes_are_refused(problem, message):
    with pytest.raises(Refusal, match=message):
        model(problem)
