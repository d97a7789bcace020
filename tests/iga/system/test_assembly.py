"""Assembly in batches: the sum of all element matrices, in memory that does not hold them."""

import tracemalloc

import numpy as np
import pytest

from iga.bases.names import BASES
from iga.elements.bulk import BATCH, Solid, full_matrices, stiffness_of_batches
from iga.elements.elasticity import orthotropic
from iga.elements.shape_functions import block_basis
from iga.mesh.quadrature import gauss, square
from iga.system.bulk import BULKS

D = orthotropic(130.0, 9.0, 5.0, 0.3, "stress")


def strip(elements: int, kinematics: str):
    """A bulk of cubic splines, two elements through the thickness, its numbering, and some displacements."""
    mesh = BASES["nurbs"].rectangle((3, 3), np.linspace(0.0, 50.0, elements // 2 + 1), np.linspace(0.0, 1.0, 3))
    bulk = BULKS[kinematics](
        tuple(Solid(block_basis(mesh, block, *square(gauss(3), gauss(4))), D) for block in mesh.blocks)
    )
    free_d = np.arange(2 * len(mesh.P_AI)) > 2
    u_d = 1e-3 * np.random.default_rng(1).standard_normal(free_d.size)
    return bulk, bulk.numbering([], np.repeat(mesh.P_AI[:, 0], 2), free_d), u_d


@pytest.mark.parametrize("kinematics", BULKS)
def test_batches_add_up_to_the_sum_of_all_element_matrices(kinematics):
    bulk, band, u_d = strip(2 * BATCH + 10, kinematics)
    gradients = bulk.respond(u_d).gradients
    expected = np.zeros((u_d.size, u_d.size))
    for solid, d, H in zip(bulk.solids, bulk.element_dofs, gradients or (None,), strict=True):
        for e, K in stiffness_of_batches(solid, bulk.kinematics.moduli, H):
            np.add.at(expected, (d[e][:, :, None], d[e][:, None, :]), full_matrices(K))
    expected = expected[np.ix_(band.dof_n, band.dof_n)]
    assemble = bulk.assembler(band)
    first, half = assemble(gradients), assemble(gradients)
    lower = half[:-1].reshape(band.n, band.k + 1)
    for d in range(band.k + 1):
        below = np.diagonal(expected, -d)
        assert np.allclose(lower[: band.n - d, d], below, rtol=0, atol=1e-13 * np.abs(expected).max())
    assert np.abs(np.tril(expected, -band.k - 1)).max() == 0.0
    assert np.array_equal(first, half) and not np.shares_memory(first, half)


def test_assembly_holds_the_band_and_its_places_but_no_element_matrices():
    """The places of an element take 2.1 kB, its stiffness and moduli 7.5 kB; those of a few batches are allowed."""
    elements = 64 * BATCH
    bulk, band, u_d = strip(elements, "finite")
    gradients = bulk.respond(u_d).gradients
    tracemalloc.start()
    half = bulk.assembler(band)(gradients)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    places = 4 * (16 * 16 + 2 * 16 * 17 // 2) * elements
    assert peak < half.nbytes + places + 4 * BATCH * 7_500 + 1e6


def test_a_factor_takes_the_place_of_its_matrix():
    bulk, band, u_d = strip(4 * BATCH, "finite")
    half = bulk.assembler(band)(bulk.respond(u_d).gradients)
    half[band.positions(band.dof_n, band.dof_n)] += half.max()
    factors = band.cholesky(half)
    assert factors is not None and np.shares_memory(factors.factor, half)
