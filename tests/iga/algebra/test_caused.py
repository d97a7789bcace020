"""Steps that loads cause, put together from halves of solutions, against whole solutions."""

from dataclasses import replace

import numpy as np
import pytest
from specimens import PAPER

from iga.algebra.banded import BandCholesky, BandLU
from iga.algebra.caused import Caused
from iga.algebra.factors import bordered, inverse
from iga.dcb import build
from iga.system.system import factorise, respond, untimed


@pytest.mark.parametrize("kind", [BandCholesky, BandLU])
def test_sums_of_steps_and_works_of_loads_are_those_of_whole_solutions(kind, rng):
    """Loads that come one after the other, one of them far along the specimen, under a control of its own."""
    system = build(replace(PAPER, opening=(1.5,), dofs=400)).system
    response = respond(system, system.start(), decide=False)
    pattern = system.pattern(response)
    known = factorise(system, response, pattern, untimed)
    if kind is BandLU:
        known = inverse(pattern.band, *pattern.tangent(system.interface, response), system.load_d)
    assert isinstance(known.factors, kind)
    tied = bordered(known, response.contact.rows(np.array([3]), system.n_dof)[:, 0], 0.7)
    assert tied is not None
    loads_dm = rng.standard_normal((system.n_dof, 3))
    late = pattern.band.dof_n[-40:]
    loads_dm = np.concatenate([loads_dm, np.zeros((system.n_dof, 1))], axis=1)
    loads_dm[late, 3] = rng.standard_normal(late.size)
    caused = Caused.none(tied).with_loads(loads_dm[:, 3:]).with_loads(loads_dm[:, :3])
    order, z_r = [3, 0, 1, 2], rng.standard_normal(4)
    expected = tied.solve(loads_dm[:, order])
    step, whole = caused.step(z_r), expected @ z_r
    assert caused.loads == 4 and np.allclose(step, whole, rtol=0, atol=1e-8 * np.abs(whole).max())
    work_rr = loads_dm[:, order].T @ expected[:-1]
    assert np.allclose(caused.work_rr, work_rr, rtol=0, atol=1e-8 * np.abs(work_rr).max())
