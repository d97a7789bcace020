"""What holds of every basis: its functions on rectangles, and what its record says of them."""

import numpy as np
import pytest

from iga.bases.names import BASES, find
from iga.elements.shape_functions import block_basis
from iga.mesh.continuity import jumps
from iga.mesh.edges import element_sides
from iga.mesh.quadrature import gauss, square

EACH = [(name, degree) for name, basis in BASES.items() for degree in basis.degrees]
BREAKS_S, BREAKS_T = np.array([-1.0, 0.0, 0.3, 2.0]), np.array([0.5, 1.0, 2.5])


@pytest.mark.parametrize(("name", "degree"), EACH)
def test_a_rectangle_has_the_functions_of_both_directions(name, degree):
    basis = BASES[name]
    for through in {2, degree}:  # coarse specimens are quadratic through their bodies, whatever they are along
        mesh = basis.rectangle((degree, through), BREAKS_S, BREAKS_T)
        assert len(mesh.P_AI) == basis.columns(degree, 3) * basis.columns(through, 2) and mesh.elements == 6
        assert {block.degrees for block in mesh.blocks} == {(degree, through)}
        assert {name: len(mesh.chains[name].element_c) for name in mesh.chains} == {
            "left": 2, "right": 2, "bottom": 3, "top": 3,
        }  # fmt: skip
    assert basis.least_dofs(degree) == 4 * (degree + 1) * basis.columns(degree, 2) + (4 if basis.local else 0)


@pytest.mark.parametrize(("name", "degree"), EACH)
def test_boundaries_that_turn_back_are_refused(name, degree):
    folded = np.array([0.0, 1.0, 0.5])
    for breaks in ((folded, BREAKS_T), (BREAKS_S, folded)):
        with pytest.raises(ValueError, match="must rise|non-decreasing"):
            BASES[name].rectangle((degree, degree), *breaks)


@pytest.mark.parametrize(("name", "degree"), EACH)
def test_functions_sum_to_one_and_parameters_are_places(name, degree):
    mesh = BASES[name].rectangle((degree, degree), BREAKS_S, BREAKS_T)
    made = block_basis(mesh, mesh.blocks[0], *square(gauss(3), gauss(2)))
    assert np.max(np.abs(made.N_eqa.sum(-1) - 1.0)) < 1e-13 and np.max(np.abs(made.dN_eqIa.sum(-1))) < 1e-11
    at_s, at_t = ((x[:-1, None] + np.diff(x)[:, None] * gauss(n)[0]) for x, n in ((BREAKS_S, 3), (BREAKS_T, 2)))
    X = made.X_eqI.reshape(-1, 2)
    for found, places in zip(X.T, (at_s, at_t), strict=True):
        assert np.max(np.abs(np.unique(found.round(12)) - np.sort(places.ravel()).round(12))) < 1e-11
    assert made.dV_eq.sum() == pytest.approx(3.0 * 2.0, rel=1e-13)


@pytest.mark.parametrize(("name", "degree"), [(name, degree) for name, degree in EACH if degree > 1])
def test_smooth_bases_have_gradients_without_jumps(name, degree):
    mesh = BASES[name].rectangle((degree, degree), BREAKS_S, BREAKS_T)
    _, jump_no = jumps(mesh, element_sides(mesh))
    assert jump_no[:, 0].max() < 1e-12
    assert (jump_no[:, 1].max() < 1e-10) == BASES[name].smooth


def test_bases_are_found_in_their_folder_and_named():
    assert list(BASES)[:3] == ["tspline", "nurbs", "lagrange"] and all(find(name) is BASES[name] for name in BASES)
    assert len({basis.label for basis in BASES.values()}) == len(BASES)
    with pytest.raises(ValueError, match='basis must be "tspline", "nurbs".* or "[a-z0-9]+", got \'fourier\''):
        find("fourier")
