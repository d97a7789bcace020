"""Frames of the isogeometric solver: the stresses that they are made of."""

import numpy as np
import pytest

from iga.elements.elasticity import orthotropic
from iga.elements.kinematics import FINITE, LINEAR


def test_stress_in_the_axes_of_the_material():
    """From the Cauchy stress back to S / det F, which P = F S has told another way."""
    H = 0.3 * np.random.default_rng(5).normal(size=(2, 2, 4, 3))
    D = orthotropic(140e3, 10e3, 5e3, 0.3, "strain")
    F = H + np.eye(2)[:, :, None, None]
    P, J = FINITE.stress(D, H)[0], F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
    found = FINITE.material(FINITE.cauchy(D, H), H)
    assert np.einsum("iIeq,IJeq->iJeq", F, found * J) == pytest.approx(P, rel=1e-9, abs=1e-9 * np.abs(P).max())
    linear = LINEAR.cauchy(D, H)
    assert LINEAR.material(linear, H) is linear
