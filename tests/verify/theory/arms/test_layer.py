"""The elastic layer under a peeled strip: closed forms, limits, and units."""

import numpy as np
import pytest

from iga.elements.elasticity import orthotropic
from verify.theory.layer import Layer

PEEL = Layer.of((120.0, 10.0), 5e3, 5e3, 5e3 / 2.4, 0.2)


@pytest.mark.parametrize("nu", [0.0, 0.2, 0.33])
@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_layer_is_the_closed_form_of_an_isotropic_one(nu, plane):
    """Plane elasticity by stress functions, base clamped, surface free of shear; E is 5, the thickness 2."""
    G, kappa = 5.0 / (2 * (1 + nu)), (3 - nu) / (1 + nu) if plane == "stress" else 3 - 4 * nu
    layer = Layer.of((100.0, 2.0), 5.0, 5.0, G, nu, plane)
    for q in (0.05, 0.3, 0.8, 2.0, 4.9, 20.0):
        x = 2.0 * min(q, 50.0)
        cosh, sinh = np.cosh(2 * x), np.sinh(2 * x)
        sag = (kappa + 1) / (4 * G * q) * (kappa * sinh - 2 * x) / (kappa * cosh + 2 * x**2 + (1 + kappa**2) / 2)
        assert layer.stiffness(q) == pytest.approx(1 / sag, rel=1e-6)


@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_layer_takes_the_elasticity_of_its_plane(plane):
    constants = {"E1": 120.0, "E2": 9.0, "G12": 5.0, "nu12": 0.3}
    layer, D = Layer.of((1.0, 1.0), **constants, plane=plane), orthotropic(**constants, plane=plane)
    assert (layer.C11, layer.C12, layer.C22, layer.C66) == pytest.approx((D[0, 0], D[0, 1], D[1, 1], D[2, 2]))


def test_parameters_are_the_tangent():
    k, g = PEEL.parameters(0.22)
    assert k + g * 0.22**2 == pytest.approx(PEEL.stiffness(0.22), rel=1e-12)
    assert g == pytest.approx((PEEL.stiffness(0.2201) - PEEL.stiffness(0.2199)) / (0.2201**2 - 0.2199**2), rel=1e-6)


def test_long_waves_feel_winkler_and_a_quarter_of_vlasov():
    """g = t C12 / 3 (1 - C12 / C66), by the energy of the first order fields; at nu = 0.2 that is C66 t / 3 over 4."""
    k, g = PEEL.parameters(1e-4)
    assert k == pytest.approx(5e3 / 0.96 / 10.0, rel=1e-6)
    assert g == pytest.approx(10.0 * PEEL.C12 / 3 * (1 - PEEL.C12 / PEEL.C66), rel=1e-5)
    assert g == pytest.approx(PEEL.C66 * 10.0 / 3 / 4, rel=1e-5)


@pytest.mark.parametrize("part", [0.2, 1.0, 5.0])
def test_a_layer_that_hardly_contracts_is_coupled_by_a_hundredth(part):
    """Of K / (1 / t^2 + q^2), which keeps its foundation stable; one that contracts has more by itself."""
    q, thickness = part / 10.0, 10.0
    soft, plain = Layer.of((120.0, thickness), 5e3, 5e3, 10.0, 0.2), PEEL
    for layer, least in ((soft, part < 5.0), (plain, False)):
        k, g = layer.parameters(q)
        K = layer.stiffness(complex(q)).real
        assert k + g * q**2 == pytest.approx(K, rel=1e-12) and k > 0.0
        share = g / (K / (thickness**-2 + q**2))
        assert (share == pytest.approx(0.01, rel=1e-9)) == least and share >= 0.01 * (1.0 - 1e-9)


@pytest.mark.parametrize(("part", "exact"), [(0.2, 504.597998049174), (5.0, 508.269973209), (50.0, 1142.05468085637)])
def test_a_thick_layer_that_shears_easily_is_as_stiff_as_in_exact_arithmetic(part, exact):
    """Waves that grow by e^1000 through the layer; the values are those of 1400 digits."""
    soft = Layer.of((120.0, 10.0), 5e3, 5e3, 10.0, 0.2)
    assert soft.stiffness(complex(part / 10.0)).real == pytest.approx(exact, rel=1e-9)
