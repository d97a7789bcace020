"""The table of combinations: it covers all pairs of its factors, holds, and finds faults that are put back."""

from __future__ import annotations

from dataclasses import fields
from itertools import combinations as pairs

import pytest

from iga.laws.law import Law
from verify.studies.hard import combinations
from verify.studies.hard.combinations import TABLE, Combination, findings

NAMES = [field.name for field in fields(Combination)]


def pairs_of(cell: Combination) -> set[tuple]:
    """Pairs of values of two factors."""
    return {(a, getattr(cell, a), b, getattr(cell, b)) for a, b in pairs(NAMES, 2)}


def covering() -> list[Combination]:
    """A few cells with every pair of values of two factors that the table has, chosen greedily in the table's order."""
    wanted, found = set().union(*map(pairs_of, TABLE)), []
    while wanted:
        found.append(max(TABLE, key=lambda cell: len(pairs_of(cell) & wanted)))
        wanted -= pairs_of(found[-1])
    return found


FEW = covering()


def test_the_table_has_every_combination_that_is_a_case():
    assert len(FEW) < 0.15 * len(TABLE) and len({cell.name for cell in TABLE}) == len(TABLE) == 288


def broken(cell: Combination) -> list[str]:
    return [f"{check.subject} {check.name} {check.value:.2e} > {check.tolerance:.0e}"
            for check in findings(cell) if not check.passed]  # fmt: skip


@pytest.mark.parametrize("cell", [
    pytest.param(cell, id=cell.name, marks=() if cell in FEW else pytest.mark.slow) for cell in TABLE
])  # fmt: skip
def test_a_combination_holds(cell):
    assert not broken(cell)


def test_a_precrack_that_is_glued_is_found(monkeypatch):
    """A law that heals, and evaluates points without cohesion as all others."""
    plain = Law.respond
    monkeypatch.setattr(combinations, "dolfinx_installed", lambda: False)
    monkeypatch.setattr(Law, "respond", lambda *args: plain(*args[:5]))
    glued = Combination("slides", "bilinear", "unbonded", "load", False, "linear")
    assert any(" unbonded " in line for line in broken(glued))
