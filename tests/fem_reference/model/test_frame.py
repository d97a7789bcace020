"""Gap and slip of faces in space, without DOLFINx."""

import numpy as np
import pytest

from fem_reference.model.frame import relative

REFERENCE = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # tangents along X and Z


def functionals(jump_qi, tangents_qki):
    return np.concatenate([jump_qi, (tangents_qki - REFERENCE).reshape(len(jump_qi), 6)], axis=1)


@pytest.mark.parametrize("m", [3, 9])
def test_derivatives_in_space_are_those_of_the_differences(m):
    rng, h = np.random.default_rng(1), 1e-6
    z_qa, dz_qa = 0.3 * rng.standard_normal((6, m)), rng.standard_normal((6, m))
    at, ahead, behind = relative(z_qa), relative(z_qa + h * dz_qa), relative(z_qa - h * dz_qa)
    assert at.rates(dz_qa) == pytest.approx((ahead.jump_qj - behind.jump_qj) / (2 * h), rel=1e-7, abs=1e-7)
    bent_qja = np.einsum("qjab,qb->qja", at.dz_qjab, dz_qa)
    assert bent_qja == pytest.approx((ahead.dz_qja - behind.dz_qja) / (2 * h), rel=1e-6, abs=1e-6)


def test_faces_that_turn_as_one_keep_gap_and_slip_in_any_direction():
    rng = np.random.default_rng(2)
    jump_qi = rng.standard_normal((4, 3))
    turn_ij = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    turn_ij *= np.sign(np.linalg.det(turn_ij))
    stays, turned = (
        relative(functionals(jump_qi @ R.T, np.tile(REFERENCE @ R.T, (4, 1, 1)))).jump_qj for R in (np.eye(3), turn_ij)
    )
    assert stays == pytest.approx(
        np.stack([jump_qi[:, 1], np.sign(jump_qi[:, 0]) * np.hypot(*jump_qi[:, [0, 2]].T)], -1), rel=1e-13
    )
    assert np.abs(turned) == pytest.approx(np.abs(stays), rel=1e-13)


def test_faces_of_a_plane_specimen_have_its_gap_and_slip():
    plane_qa = 0.2 * np.random.default_rng(3).standard_normal((5, 4))
    space_qa, shared = np.zeros((5, 9)), np.ix_(range(5), range(2), [0, 1, 3, 4])
    space_qa[:, shared[2].ravel()] = plane_qa
    plane, space = relative(plane_qa), relative(space_qa)
    assert space.jump_qj == pytest.approx(plane.jump_qj, rel=1e-13)
    assert space.dz_qja[shared] == pytest.approx(plane.dz_qja, rel=1e-12, abs=1e-13)
    assert space.dz_qjab[..., [0, 1, 3, 4], :][..., [0, 1, 3, 4]] == pytest.approx(plane.dz_qjab, rel=1e-11, abs=1e-12)


def test_an_unloaded_bond_resists_every_direction_alike():
    at, K, Ks = relative(np.zeros((1, 9))), 3.0, 7.0
    force_qj = at.jump_qj * [K, Ks]
    tangent_qab = at.tangent(force_qj, np.array([[[K, 0.0], [0.0, Ks]]]))
    assert tangent_qab[0, :3, :3] == pytest.approx(np.diag([Ks, K, Ks]))
    assert not np.any(at.forces(force_qj)) and not np.any(tangent_qab[0, 3:])
