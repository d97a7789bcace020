"""Intervals contain the truth as often as they say: 100 noisy tests of a known toughness, LEFM curves."""

from collections import Counter
from dataclasses import replace

import pytest
from made_up_tests import NOISY, TESTS, recorded, specimen

from verify.reduction.reduce import reduce
from verify.reduction.scheme import Settings

#: Schemes whose assumption holds of these curves: the modulus of the scene, which CBT takes, is 3 % wrong.
HONEST = {
    "dcb": ("MBT", "CC", "MCC", "CBBM"),
    "enf": ("CC", "CBBM"),
    "4enf": ("CC", "CBBM"),
    "mmb": ("D6671", "CBBM"),
}


def contained(kind: str, trials: int) -> Counter:
    """How often the interval of the propagation value contains the toughness."""
    of, toughness = specimen(kind), TESTS[kind][1]
    hits: Counter = Counter()
    for seed in range(trials):
        found = reduce(recorded(kind, replace(NOISY, seed=seed)), of, Settings(machine=NOISY.machine))
        hits.update(
            one.name for one in found.schemes if abs(one.propagation.value - toughness) <= one.propagation.half_width
        )
    return hits


@pytest.mark.slow
@pytest.mark.parametrize("kind", TESTS)
def test_intervals_contain_the_toughness_in_95_of_100_tests(kind):
    """90 to 99 are within three standard deviations of a binomial of 95 %; the seeds are fixed."""
    hits = contained(kind, 100)
    assert all(90 <= hits[name] <= 100 for name in HONEST[kind]), hits


def test_intervals_of_a_few_tests():
    hits = contained("dcb", 12)
    assert all(hits[name] >= 10 for name in HONEST["dcb"]), hits


def test_a_wrong_modulus_shows_in_the_scheme_that_takes_it_from_the_scene():
    found = reduce(recorded("dcb", NOISY), specimen("dcb"), Settings(machine=NOISY.machine))
    cbt, cbbm = (next(one for one in found.schemes if one.name == name) for name in ("CBT", "CBBM"))
    assert cbt.propagation.value / cbbm.propagation.value == pytest.approx(0.97, abs=0.01)
