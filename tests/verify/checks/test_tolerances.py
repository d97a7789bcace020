"""Every tolerance says what it follows from, those that follow from measurements alone are known, the page has all."""

from __future__ import annotations

import re
from dataclasses import is_dataclass
from importlib import import_module
from numbers import Real
from pathlib import Path

import pytest

from tests.verify.checks.test_planted_faults import BETWEEN
from verify.checks.identities import IDENTITIES

PAGE = Path(__file__).parents[3] / "docs/pages/theory/tolerances.md"
#: Name of a check, or of a constant below ``verify`` -> kind of its source, as the tables of the page say.
TOLERANCES, CONSTANTS = (
    dict(re.findall(r"^\| `([\w.-]+)` \| ([\w ]+) \| .+ \|$", part, re.MULTILINE))
    for part in PAGE.read_text().split("\n## ")[1:]
)
SOURCES = {*"rounding,iteration,steps,second mesh,next order,stated,requirement,convention,measured".split(",")}
MODULES = (
    *("checks." + name for name in ("between_codes", "identities", "matched", "neglected", "orders", "proof")),
    *(
        "checks.mechanics." + path.stem
        for path in Path(import_module("verify.checks.mechanics").__path__[0]).glob("[a-z]*.py")
    ),
    *("curves." + name for name in ("convergence", "legs", "leg_checks", "scatter")),
    "checks.foreign.given",
    "methods.second_meshes",
)


def test_every_check_of_a_run_and_of_a_pair_has_its_source():
    assert set(IDENTITIES) <= set(TOLERANCES)
    of_pairs = {name.split(" of ")[0] for name in BETWEEN} - {"curve-error", "peak-load", "energy"}  # of `compare`
    assert {re.sub(r"-\d+$", "", name) for name in of_pairs} <= set(TOLERANCES)


@pytest.mark.parametrize("module", MODULES)
def test_every_constant_that_decides_has_its_source(module):
    here = import_module(f"verify.{module}")
    source = Path(str(here.__file__)).read_text()
    names = set(re.findall(r"^([A-Z][A-Z_]+)", source, re.MULTILINE))
    names |= {one for line in re.findall(r"^([A-Z][A-Z_, ]+) = ", source, re.MULTILINE) for one in line.split(", ")}
    decides = {name for name in names if hasattr(here, name) and is_number(getattr(here, name))}
    assert {f"{module}.{name}" for name in decides} == {one for one in CONSTANTS if one.startswith(f"{module}.")}


def is_number(value: object) -> bool:
    if is_dataclass(value):
        return all(isinstance(one, Real) for one in vars(value).values())
    if isinstance(value, dict):
        return bool(value) and all(isinstance(key, int) for key in value)
    return isinstance(value, Real)


def test_what_follows_from_measurements_alone_is_known():
    """A list to make shorter: what is added here has to be derived."""
    known = TOLERANCES | CONSTANTS
    assert {*known.values()} <= SOURCES
    assert {name for name, source in known.items() if source == "measured"} == {
        *("j-pressed", "growth-angle", "dissipation"),
        *(f"checks.mechanics.unresolved.LEFT_BY_{code}" for code in ("ARMS", "IGA", "DOLFINX")),
        "checks.proof.TRUST",
        "checks.neglected.OVERLAP",
        "checks.mechanics.secant.SOFTER",
        "curves.legs.SNAPS",
    }
