"""How large numbers may be: at the ends of each range, on both sides of them."""

from __future__ import annotations

import pytest

from verify.scene.complaints import shown
from verify.scene.load import load_scene
from verify.scene.magnitudes import too_large
from verify.scene.parse import SceneError, parse_scene

MODULUS = 120e3
#: Scene, key, the ends of its range (in N and mm, beside what they are held against), and other overrides.
RANGES = [
    ("dcb-czm1", "specimen.arm_thickness", 1e-6 * 14.0, 1e3 * 14.0),
    ("dcb-czm1", "specimen.precrack", 1e-6 * 14.0, 0.999999 * 14.0),
    ("dcb-czm1", "specimen.width", 1e-9 * 14.0, 1e9 * 14.0),
    ("dcb-czm1", "interface.strength", 1e-12 * MODULUS, 1e3 * MODULUS),
    ("dcb-czm1", "interface.toughness", 1e-9 * 4.0 * 0.2, 1e6 * 4.0 * 0.2),
    ("dcb-czm1", "interface.ductility", 1.000001, 1e6),
    ("dcb-czm1", "interface.penalty", 1e-6 * 1000.0, 1e12 * 1000.0),  # 4^2 12.5 / (2 0.1) = 1000
    ("dcb-czm1", "material.poisson", -0.999999, 0.499999),
    ("dcb-czm1", "pose.shift[0]", -1e6 * 14.0, 1e6 * 14.0),
    ("dcb-czm1", "pose.shift[1]", -1e6 * 14.0, 1e6 * 14.0),
    ("dcb-czm1", "material.E2", 1e-6 * MODULUS, 1e6 * MODULUS),
    ("dcb-czm1", "material.G12", 1e-6 * MODULUS, 1e6 * MODULUS),
    ("dcb-czm1", "load.opening", 1e-12 * 14.0, 28.0),
    ("dcb-czm1", "discretization.mismatch", 0.05, 20.0),
    ("dcb-czm1", "discretization.bend", 1e-5, 0.2),
    ("dcb-czm1", "pose.angle", -360.0, 360.0),
    ("peel-60", "specimen.strip_thickness", 1e-6 * 150.0, 1e3 * 150.0),
    ("peel-60", "specimen.substrate_thickness", 1e-6 * 120.0, 1e3 * 120.0),
    ("peel-60", "substrate.young", 1e-9 * 250e3, 1e9 * 250e3),
]
#: Key, and the first and the last integer that it takes.
COUNTS = [
    ("discretization.degree", 1, 5),
    ("discretization.dofs", 40, 1_000_000),
    ("discretization.interface_points", 1, 12),
    ("discretization.steps", 1, 100_000),
    ("dolfinx.degree", 1, 4),
    ("dolfinx.elements", 2, 100_000),
    ("dolfinx.layers", 1, 100),
    ("dolfinx.interface_points", 1, 12),
]


def said(name: str, key: str, value: float) -> str:
    """What is said of a key of a scene with this value, nothing where it is taken."""
    override = f"{key}={value!r}"
    if key.startswith("pose.shift"):
        override = f"pose.shift={[value, 0.0] if '0' in key else [0.0, value]}"
    if key in ("material.E2", "material.G12"):
        constants = {"E1": MODULUS, "E2": 10e3, "G12": 5e3, "nu12": 1e-5, key[9:]: value}
        override = f"material={{{', '.join(f'{name} = {one!r}' for name, one in constants.items())}}}"
    try:
        load_scene(name, [override])
    except SceneError as error:
        return "\n".join(sentence for sentence in error.sentences if sentence.startswith(f"{key}: must be "))
    return ""


@pytest.mark.parametrize(("name", "key", "low", "high"), RANGES)
def test_a_range_ends_where_it_is_said_to_end(name, key, low, high):
    """What else the scene says of such a value is not asked here."""
    for value, inside in ((low, True), (high, True), (low, False), (high, False)):
        outward = -1 if (value == low) == (value > 0) else 1
        told = said(name, key, value * (1.0 + (-outward if inside else outward) * 1e-7))
        if key != "load.opening":
            assert (f">= {low:.10g} and <= {high:.10g}" in told) != inside, (value, inside, told)
        else:
            assert bool(told) != inside


@pytest.mark.parametrize(("key", "first", "last"), COUNTS)
def test_counts_are_taken_from_the_first_to_the_last(key, first, last):
    assert [said("dcb-czm1", key, value) for value in (first, last)] == ["", ""]
    for value in (first - 1, last + 1):
        assert f">= {first} and <= {last}" in said("dcb-czm1", key, value)


def test_a_number_that_no_rule_can_be_worked_out_for_is_named():
    """The default of the penalty divides by a gap that is nothing."""
    law = {"strength": 5.0, "toughness": 5e-324}
    with pytest.raises(SceneError) as caught:
        parse_scene(load_scene("dcb-czm1").model_dump() | {"interface": law})
    told = "interface.toughness: must be of a size >= 1e-30 and <= 1e+30, got 4.94066e-324"
    assert list(caught.value.sentences) == [told]


def test_what_is_too_large_is_shown_as_far_as_it_can_be():
    """A whole number that no float holds is told by its length; one of more digits than are ever printed as well."""
    raw = {"load": {"opening": [1e31, 10**40, -(10**299), 10**301, True, float("inf")]}, "pose": {"shift": (1e-31, 0)}}
    told = [line.partition(": must be of a size >= 1e-30 and <= 1e+30, got ")[::2] for line in too_large(raw)]
    assert [got for _, got in told] == ["1e+31", "1e+40", "-1e+299", "an integer of hundreds of digits", "1e-31"]
    assert [key for key, _ in told] == [*(f"load.opening[{i}]" for i in range(4)), "pose.shift[0]"]
    assert too_large({"discretization": {"dofs": 1e40}, "specimen": {"length": 1e30, "width": 1e-30}}) == []
    assert shown(10**5000) == "an integer of thousands of digits" and shown(True) == "true" and shown("a") == "'a'"
    assert shown("x" * 58) == f"'{'x' * 58}'" and shown("x" * 59) == f"'{'x' * 56}..."
