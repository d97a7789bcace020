"""What ``import iga`` offers, and what it costs."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import iga

BEAM = iga.Dcb(
    length=14.0, arm_thickness=0.2, precrack=4.0, E1=120e3, nu12=0.2, strength=4.0, toughness=0.1,
    opening=(0.3,), dofs=280, steps=6,
)  # fmt: skip


def test_every_name_is_there():
    assert all(getattr(iga, name) is not None for name in iga.__all__) and set(iga.__all__) <= set(dir(iga))
    assert len(iga.__all__) == len(set(iga.__all__)) < 20
    with pytest.raises(AttributeError, match="no attribute 'DCB'"):
        iga.DCB  # noqa: B018


def test_the_import_brings_nothing_along():
    program = "import iga, sys; print(sorted(n for n in sys.modules if n.startswith(('iga.', 'numpy', 'scipy'))))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_solution_has_its_columns_as_arrays_and_one_line_of_words():
    run = iga.solve(replace(BEAM, snapshot_openings=(0.3,)))
    assert run.status == "complete" and run.opening.shape == run.load.shape == (len(run.rows),)
    assert run.opening[-1] == pytest.approx(0.3) and np.all(run.steps["load"] == run.load)
    assert run.snapshots[0].opening == pytest.approx(0.3) and run.snapshots[0].line_nki.shape == (0, 2, 2)
    assert repr(run).startswith("<Solution: ") and len(repr(run)) < 120 and "complete" in repr(run)


def test_both_specimens_are_solved():
    moduli = iga.Moduli(E1=250e3, nu12=0.2)
    peel = iga.Peel(
        strip_length=150.0, strip_thickness=2.0, substrate_length=120.0, substrate_thickness=10.0, bond_length=120.0,
        strip=moduli, substrate=moduli, strength=6.0, toughness=0.1, opening=0.3, dofs=400, steps=2,
    )  # fmt: skip
    openings = []
    assert iga.solve(peel, lambda row: openings.append(row["opening"])).status == "complete"
    assert openings[0] == 0.0 and openings[-1] == pytest.approx(0.3)
