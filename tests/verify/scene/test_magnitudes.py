"""How large numbers may be beside each other: at the ends of each range, on both sides of them."""

from __future__ import annotations

import pytest

from verify.scene.complaints import _shown
from verify.scene.load import load_scene
from verify.scene.magnitudes import too_large
from verify.scene.parse import SceneError, parse_scene

#: Scene, key, and the ends of its range in N and mm, beside what they are held against.
RANGES = [
    ("dcb-czm1", "specimen.arm_thickness", 1e-6 * 14.0, 1e3 * 14.0),
    ("dcb-czm1", "specimen.precrack", 1e-6 * 14.0, 0.999999 * 14.0),
    ("dcb-czm1", "specimen.width", 1e-9 * 14.0, 1e9 * 14.0),
    ("dcb-czm1", "interface.strength", 1e-12 * 120e3, 1e3 * 120e3),
    ("dcb-czm1", "interface.toughness", 1e-9 * 4.0 * 0.2, 1e6 * 4.0 * 0.2),
    ("dcb-czm1", "interface.ductility", 1.000001, 1e6),
    ("dcb-czm1", "interface.penalty", 1e-6 * 1000.0, 1e12 * 1000.0),  # 4^2 12.5 / (2 0.1) = 1000
    ("dcb-czm1", "material.poisson", -0.999999, 0.499999),
    ("peel-60", "specimen.strip_thickness", 1e-6 * 150.0, 1e3 * 150.0),
    ("peel-60", "specimen.substrate_thickness", 1e-6 * 120.0, 1e3 * 120.0),
]


def said(name: str, *overrides: str) -> str:
    """What is said of a scene, nothing where it is taken."""
    try:
        load_scene(name, overrides)
    except SceneError as error:
        return "\n".join(error.sentences)
    return ""


@pytest.mark.parametrize(("name", "key", "low", "high"), RANGES, ids=[key for _, key, *_ in RANGES])
def test_a_range_ends_where_it_is_said_to_end(name: str, key: str, low: float, high: float) -> None:
    """What else the scene says of such a value is not asked here."""
    told = f"{key}: must be >= {low:.10g} and <= {high:.10g}, "
    for value, inside in ((low, True), (high, True), (low, False), (high, False)):
        outward = -1 if (value == low) == (value > 0) else 1
        off = value * (1.0 + (-outward if inside else outward) * 1e-7)
        assert (told in said(name, f"{key}={off!r}")) != inside, (off, inside)


@pytest.mark.parametrize(("key", "times"), [("E2", 1e6), ("G12", 1e6)])
def test_moduli_of_a_body_go_with_the_first(key: str, times: float) -> None:
    constants = {"E1": 120e3, "E2": 10e3, "G12": 5e3, "nu12": 1e-5}
    for factor, taken in ((1 / times, True), (times, True), (0.99 / times, False), (1.01 * times, False)):
        table = {**constants, key: factor * 120e3 * (1.0 + 1e-9 * (1 if factor < 1 else -1) * taken)}
        words = ", ".join(f"{name} = {value!r}" for name, value in table.items())
        assert (f"material.{key}: must be >= " in said("dcb-czm1", f"material={{{words}}}")) != taken, factor


def test_the_second_body_goes_with_the_first() -> None:
    strip = load_scene("peel-60").strip.young
    for factor, taken in ((1.01e-9, True), (0.99e9, True), (0.99e-9, False), (1.01e9, False)):
        told = said("peel-60", f"substrate.young={factor * strip!r}")
        assert ("substrate.young: must be >= " in told and "the modulus of strip" in told) != taken, factor


def test_openings_that_follow_each_other_are_apart() -> None:
    """By 1e-12 of the length at the least."""
    for step, taken in ((1.1e-12 * 14.0, True), (0.9e-12 * 14.0, False)):
        assert ("load.opening: must be >= 1.4e-11" in said("dcb-czm1", f"load.opening={step!r}")) != taken
    assert "load.opening[1]: " in said("dcb-czm1", "load.opening=[1.0, 1.0]")
    assert said("dcb-czm1", "load.opening=[1.0, 0.5, 1.0]") == ""


def test_a_scene_may_be_a_million_lengths_away() -> None:
    for shift, taken in (
        (0.99e6 * 14.0, True),
        (-0.99e6 * 14.0, True),
        (1.01e6 * 14.0, False),
        (-1.01e6 * 14.0, False),
    ):
        for axis in (0, 1):
            pose = [0.0, 0.0]
            pose[axis] = shift
            assert (f"pose.shift[{axis}]: must be >= -14000000" in said("dcb-czm1", f"pose.shift={pose}")) != taken


@pytest.mark.parametrize(("value", "taken"), [(1.01e-30, True), (0.99e-30, False), (0.99e30, True), (1.01e30, False)])
def test_no_number_is_beyond_all_units(value: float, taken: bool) -> None:
    assert ("interface.toughness: must be of a size >= 1e-30 and <= 1e+30" in said(
        "dcb-czm1", f"interface.toughness={value!r}")) != taken  # fmt: skip


#: Key, and the first and the last number that it takes.
LIMITS = [
    ("discretization.degree", 1, 5),
    ("discretization.dofs", 40, 1_000_000),
    ("discretization.interface_points", 1, 12),
    ("discretization.mismatch", 0.05, 20.0),
    ("discretization.steps", 1, 100_000),
    ("discretization.bend", 1e-5, 0.2),
    ("dolfinx.degree", 1, 4),
    ("dolfinx.elements", 2, 100_000),
    ("dolfinx.layers", 1, 100),
    ("dolfinx.interface_points", 1, 12),
    ("pose.angle", -360.0, 360.0),
    ("load.opening", -0.2, 28.0),
]


@pytest.mark.parametrize(("key", "first", "last"), LIMITS, ids=[key for key, *_ in LIMITS])
def test_limits_are_taken_and_what_is_beyond_is_not(key: str, first: float, last: float) -> None:
    whole = isinstance(first, int)
    beyond = (first - 1, last + 1) if whole else (first - 1e-6 * abs(first), last + 1e-6 * abs(last))
    assert [said("dcb-czm1", f"{key}={value!r}") for value in (first, last)] == ["", ""]
    for value in beyond:
        assert said("dcb-czm1", f"{key}={value!r}").startswith(f"{key}")


def test_what_is_not_given_is_as_it_is_written() -> None:
    """In the guide and in `debond new`: whoever leaves a key out counts on it."""
    given = load_scene("dcb-czm1").model_dump()
    needed = {"name": "a", "specimen": given["specimen"], "material": given["material"], "load": {"opening": 1.0}}
    law = {key: given["interface"][key] for key in ("strength", "toughness", "ductility", "penalty")}
    scene = parse_scene({**needed, "interface": law})
    mesh = {
        "accuracy": 0.003, "degree": 3, "dofs": "auto", "in_a_zone": "auto", "layers": "auto",
        "interface_rule": "gauss", "interface_points": "auto", "mismatch": 1.0,
        "adaptive": False, "slave": "upper", "steps": "auto", "bend": "auto",
    }  # fmt: skip
    effects = {
        "kinematics": "finite",
        "contact": True,
        "irreversible": True,
        "symmetry": False,
        "search": True,
        "shear": "auto",
    }
    found = scene.model_dump()
    assert found["discretization"] == mesh and found["effects"] == effects
    assert (
        found["dolfinx"] == dict.fromkeys(("degree", "elements", "in_a_zone", "layers", "interface_points"), "auto")
        and found["interface"]["law"] == "bilinear"
    )
    assert found["pose"] == {"angle": 0.0, "mirror": False, "shift": (0.0, 0.0)} and found["published"] == ()


def test_a_law_that_is_not_given_in_full_is_12_5_as_ductile_and_pushes_100_times_as_hard_as_it_pulls() -> None:
    given = load_scene("dcb-czm1").model_dump()
    needed = {"name": "a", "specimen": given["specimen"], "material": given["material"], "load": {"opening": 1.0}}
    law = parse_scene({**needed, "interface": {"strength": 5.0, "toughness": 0.2}}).interface
    assert law.ductility == 12.5
    g_max = 2.0 * 0.2 / 5.0 / 12.5
    assert law.penalty == pytest.approx(100.0 * 5.0 / g_max)


def test_a_number_that_no_rule_can_be_worked_out_for_is_named() -> None:
    """The default of the penalty divides by a gap that is nothing."""
    given = load_scene("dcb-czm1").model_dump()
    needed = {"name": "a", "specimen": given["specimen"], "material": given["material"], "load": {"opening": 1.0}}
    with pytest.raises(SceneError) as caught:
        parse_scene({**needed, "interface": {"strength": 5.0, "toughness": 5e-324}})
    told = "interface.toughness: must be of a size >= 1e-30 and <= 1e+30, got 4.94066e-324"
    assert list(caught.value.sentences) == [told]


def test_what_is_too_large_is_shown_as_far_as_it_can_be() -> None:
    """A whole number that no float holds is told by its length."""
    raw = {"load": {"opening": [1e31, 10**40, -(10**299), 10**301, True, float("inf")]}, "pose": {"shift": (1e-31, 0)}}
    told = [line.partition(", got ")[::2] for line in too_large(raw)]
    assert [got for _, got in told] == ["1e+31", "1e+40", "-1e+299", "an integer of hundreds of digits", "1e-31"]
    assert [words.partition(":")[0] for words, _ in told] == [
        *(f"load.opening[{i}]" for i in range(4)),
        "pose.shift[0]",
    ]
    assert all(words.endswith(": must be of a size >= 1e-30 and <= 1e+30") for words, _ in told)
    assert too_large({"discretization": {"dofs": 1e40}, "specimen": {"length": 1e30, "width": 1e-30}}) == []


def test_a_value_of_any_size_has_a_complaint() -> None:
    """One of more digits than are ever printed as well."""
    assert _shown(10**5000) == "an integer of thousands of digits" and _shown(True) == "true" and _shown("a") == "'a'"
    assert _shown("x" * 58) == f"'{'x' * 58}'" and _shown("x" * 59) == f"'{'x' * 56}..."
