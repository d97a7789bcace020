"""Energy that the ledger of a path must know of: in springs of supports, and in points that slide off the master."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from test_peel import PEEL, column, isotropic

from iga.peel import solve
from iga.system import Energies
from iga.work import leaks

#: So soft that the bond hardly gives: strip and substrate stretch, slide on each other and tilt.
SOFT = replace(PEEL, strip=isotropic(250.0, 0.2), substrate=isotropic(5.0, 0.2), dofs=900)


def ledger(solution) -> float:
    """Worst energy that is missing, in parts of the work."""
    work = column(solution, "external_work")
    missing = work - column(solution, "stored_energy") - column(solution, "dissipated_energy")
    return float(np.abs(missing).max() / work.max())


def test_springs_that_hold_tilted_tractions_store_energy():
    """Work of a purely elastic path to 1e-9; 1e-4 of it is in the spring along the strip at opening 4."""
    found = solve(replace(SOFT, opening=(4.0,)))
    assert found.status == "complete" and column(found, "dissipated_energy").max() == 0.0
    assert ledger(found) < 1e-9


@pytest.mark.slow
def test_what_slides_off_the_end_of_the_master_is_told():
    """The outermost points fade before any damage: their energy is gone with them, and told to a percent of it."""
    found = solve(replace(SOFT, opening=(22.0,), steps=110))
    assert found.status == "complete"
    gone = column(found, "dissipated_energy")[-1]
    assert gone > 0.0 and column(found, "damage_front").max() == column(found, "damage_front")[0]
    assert ledger(found) * column(found, "external_work").max() < 0.01 * gone


#: Dissipated before and after a step that does a work of 1, what it leaks, the forces times displacements that balance
#: has left over, and whether the leak is too much.
LEAKS = [
    pytest.param(0.5, 0.6, 0.9e-3, 1e-12, False, id="far less than is dissipated"),
    pytest.param(0.5, 0.6, 1.1e-3, 1e-12, True, id="a part of the path left out"),
    pytest.param(0.0, 0.0, 1e-6, 1e-12, True, id="nothing dissipated and energy gone"),
    pytest.param(0.0, 0.0, 1e-6, 2e-6, False, id="nothing dissipated, no more gone than rounding leaves"),
    pytest.param(0.0, 1e-5, 1e-6, 1e-12, False, id="damage has just begun"),
    pytest.param(1e-5, 2e-5, 1e-6, 1e-12, True, id="a twentieth of all that is dissipated"),
]


@pytest.mark.parametrize(("before", "after", "leak", "left_over", "refused"), LEAKS)
def test_what_a_step_may_leak(before, after, leak, left_over, refused):
    """A part of the work, but of what is dissipated as long as that is little; of the work with a reversible law."""
    start, end = (
        SimpleNamespace(
            external_work=work,
            energies=Energies(work - spent, 0.0, 0.0, spent),
            state=SimpleNamespace(u_d=np.array([0.0, 2.0 * work])),
        )
        for work, spent in ((0.0, before), (1.0, after))
    )
    for reversible in (False, True):
        law = SimpleNamespace(irreversible=not reversible)
        system = SimpleNamespace(interface=SimpleNamespace(law=law))
        off = replace(end.energies, bulk=end.energies.bulk - leak)
        response = SimpleNamespace(scale=5.0)
        after_it = SimpleNamespace(
            external_work=1.0, energies=off, state=end.state, response=response, residuals=(1.0, 0.1 * left_over)
        )
        assert leaks(system, start, after_it, 0.0) == (refused if not reversible else leak > 1e-3)
