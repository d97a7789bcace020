"""The law of one solver is held against that of the other."""

from collections.abc import Callable
from dataclasses import replace

import pytest
from made_up_point_laws import BONDS

from verify.studies.law import study
from verify.studies.law.given.built_in import modelled
from verify.studies.law.study import Subject, judge_built_in
from verify.studies.law.ways.paths import paths
from verify.theory.mixed_law import MixedBond


def test_a_fault_of_the_other_code_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """One per mille more toughness in the law of fem_reference breaks this check and no other."""
    bond = BONDS["as4-peek"]

    def tougher(bond: MixedBond) -> Callable:
        return modelled(replace(bond, toughness=(1.001 * bond.toughness[0], bond.toughness[1])))

    subject = Subject(bond, True, paths(bond))
    assert judge_built_in(subject).passed
    monkeypatch.setattr(study, "modelled", tougher)
    assert {check.name for check in judge_built_in(subject).checks if not check.passed} == {"other-code"}
