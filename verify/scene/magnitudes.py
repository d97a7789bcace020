"""How large the numbers of a scene may be: each alone, and relative to the others.

The range of each number leaves room for any consistent set of units; beyond it products overflow, and a solver would
end with infinities. Numbers with a dimension are then compared with others of the same dimension, with limits far
outside of all practical values: a strength of 1e20 times the modulus is a mistake in the units.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from verify.scene.materials import Isotropic, Material, elastic_constants

#: Absolute value of a number that is not 0.
SMALLEST_NUMBER, LARGEST_NUMBER = 1e-30, 1e30

#: Tables whose numbers have dimensions; those of other tables are pure numbers.
TABLES_WITH_UNITS = ("specimen", "material", "strip", "substrate", "interface", "load", "pose", "published")


def too_large(raw: Mapping[str, Any]) -> list[str]:
    """A sentence for every number of a scene file that is too large or small for any set of units."""
    return [
        f"{key}: must be of a size >= {SMALLEST_NUMBER:g} and <= {LARGEST_NUMBER:g}, got {_shown(value)}"
        for table in TABLES_WITH_UNITS
        for key, value in _numbers(table, raw.get(table))
        if value != 0 and not SMALLEST_NUMBER <= abs(value) <= LARGEST_NUMBER
    ]


#: Key, number, its smallest and largest value, and what they are relative to.
Range = tuple[str, float, float, float, str]


def proportions(scene: Any) -> Iterator[Range]:
    """The numbers of a `Scene`, whose module imports this one, with the ranges that the others leave them."""
    yield from _stiffnesses(scene)
    yield from _cohesion(scene)
    yield from _paths(scene)


def _beside(key: str, value: float, low: float, high: float, other: str, size: float | None) -> Range:
    """The range of a number relative to ``size``, which is that of ``other``; of a pure number it is that itself."""
    if size is None:
        return key, value, low, high, other
    return key, value, low * size, high * size, f"{low:g} to {high:g} times {other}"


def _stiffnesses(scene: Any) -> Iterator[Range]:
    (first, one), *_ = scene.named_materials.items()
    for key, material in scene.named_materials.items():
        if isinstance(material, Isotropic):
            name = "young"
            yield f"{key}.poisson", material.poisson, -0.999999, 0.499999, "short of what cannot be deformed"
        else:
            name = "E1"
            for across in ("E2", "G12"):
                yield _beside(f"{key}.{across}", getattr(material, across), 1e-6, 1e6, f"{key}.E1", material.E1)
        yield _beside(f"{key}.{name}", _modulus(material), 1e-9, 1e9, f"the modulus of {first}", _modulus(one))


def _cohesion(scene: Any) -> Iterator[Range]:
    law, thickness = scene.interface, scene.specimen.loaded_thickness
    (key, material), *_ = scene.named_materials.items()
    least, opening = law.strength**2 / (2 * law.toughness), "interface.strength^2 / (2 interface.toughness)"
    stiffness, bond = least * law.ductility, "the stiffness of the bond"
    peeled = "interface.strength times the thickness of what is peeled"
    rows: list[tuple[str, float, float, str, float | None]] = [
        ("strength", 1e-12, 1e3, f"the modulus of {key}", _modulus(material)),
        ("toughness", 1e-9, 1e6, peeled, law.strength * thickness),
        ("ductility", 1.000001, 1e6, "g_u / g_max", None)
        if law.stiffness is None
        else ("stiffness", 1.000001, 1e6, opening, least),
        ("penalty", 1e-6, 1e12, bond, stiffness),
    ]
    if law.slides:
        rows += [
            ("shear_strength", 1e-6, 1e6, "interface.strength", law.strength),
            ("shear_toughness", 1e-6, 1e6, "interface.toughness", law.toughness),
            ("shear_stiffness", 1e-12, 1e12, bond, stiffness),
            ("exponent", 1.0, 20.0, "which is steeper than any bond", None),
            ("friction", 0.0, 100.0, "which holds more than any face", None),
            ("viscosity", 0.0, 1e6, "durations of the programme", None),
            ("pressure_strength", 0.0, 1e6, "strength for a unit of pressure", None),
        ]
    for name, low, high, other, size in rows:
        yield _beside(f"interface.{name}", getattr(law, name), low, high, other, size)


def _paths(scene: Any) -> Iterator[Range]:
    size, openings = scene.specimen.extent, scene.load.opening
    for i, (before, after) in enumerate(zip((0.0, *openings[:-1]), openings, strict=True)):
        key = f"load.opening[{i}]" if len(openings) > 1 else "load.opening"
        far = abs(after - before)
        if far < 1e-12 * size:
            yield key, far, 1e-12 * size, 4 * size, "as its distance from the opening before it, 1e-12 times the length"
    for i, shift in enumerate(scene.pose.shift):
        yield f"pose.shift[{i}]", shift, -1e6 * size, 1e6 * size, "a million times the length"


def _modulus(material: Material) -> float:
    return elastic_constants(material)["E1"]


def _numbers(key: str, value: object) -> Iterator[tuple[str, int | float]]:
    """Every number below a key with its path; NaN and infinity are left to the schema, which refuses them."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _numbers(f"{key}.{name}", inner)
    elif isinstance(value, list | tuple):
        for i, inner in enumerate(value):
            yield from _numbers(f"{key}[{i}]", inner)
    elif isinstance(value, int) and not isinstance(value, bool):
        yield key, value
    elif isinstance(value, float) and abs(value) < float("inf"):
        yield key, value


def _shown(value: int | float) -> str:
    return f"{value:g}" if isinstance(value, float) or abs(value) < 10**300 else "an integer of hundreds of digits"
