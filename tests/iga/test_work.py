"""Energy that the ledger of a path must know of: in springs of supports, and in points that slide off the master."""

from dataclasses import replace

import numpy as np
import pytest
from test_peel import PEEL, column, isotropic

from iga.peel import solve

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
