"""How large the numbers of a scene may be: each alone, and relative to the others.

The range of each number leaves room for any consistent set of units; beyond it products overflow, and a solver would
end with infinities. Numbers with a dimension are then compared with others of the same dimension, with limits far
outside of all practical values: a strength of 1e20 times the modulus is a mistake in the units.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from verify.scene.bond.interface import Interface
from verify.scene.materials import Isotropic, Material
from verify.scene.schema import Scene

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


def out_of_proportion(scene: Scene) -> list[str]:
    """A sentence for every number of a valid scene that is out of proportion to the others."""
    return [
        f"{key}: must be >= {low:.10g} and <= {high:.10g}, {why}, got {value:.10g}"
        for key, value, low, high, why in (*_lengths(scene), *_stiffnesses(scene), *_cohesion(scene), *_paths(scene))
        if not low <= value <= high
    ]


Range = tuple[str, float, float, float, str]


def _beside(key: str, value: float, low: float, high: float, other: str, size: float) -> Range:
    return key, value, low * size, high * size, f"{low:g} to {high:g} times {other}"


def _lengths(scene: Scene) -> Iterator[Range]:
    body = scene.specimen
    for key, low, high, other in body.ratios:
        value = getattr(body, key)
        for one in dict.fromkeys(value) if isinstance(value, tuple) else (value,):
            yield _beside(f"specimen.{key}", one, low, high, f"specimen.{other}", getattr(body, other))


def _stiffnesses(scene: Scene) -> Iterator[Range]:
    for key, material in _materials(scene):
        if isinstance(material, Isotropic):
            yield f"{key}.poisson", material.poisson, -0.999999, 0.499999, "short of what cannot be deformed"
            continue
        for name in ("E2", "G12"):
            yield _beside(f"{key}.{name}", getattr(material, name), 1e-6, 1e6, f"{key}.E1", material.E1)
    (first, one), *rest = _materials(scene)
    for key, material in rest:
        name = "young" if isinstance(material, Isotropic) else "E1"
        yield _beside(f"{key}.{name}", _modulus(material), 1e-9, 1e9, f"the modulus of {first}", _modulus(one))


def _cohesion(scene: Scene) -> Iterator[Range]:
    law, thickness = scene.interface, scene.specimen.loaded_thickness
    key, material = _materials(scene)[0]
    yield _beside("interface.strength", law.strength, 1e-12, 1e3, f"the modulus of {key}", _modulus(material))
    bending = "interface.strength times the thickness of what is peeled"
    yield _beside("interface.toughness", law.toughness, 1e-9, 1e6, bending, law.strength * thickness)
    if law.stiffness is None:
        yield "interface.ductility", law.ductility, 1.000001, 1e6, "g_u / g_max"
    else:
        least, why = law.strength**2 / (2 * law.toughness), "interface.strength^2 / (2 interface.toughness)"
        yield _beside("interface.stiffness", law.stiffness, 1.000001, 1e6, why, least)
    steepness = law.strength**2 * law.ductility / (2 * law.toughness)
    yield _beside("interface.penalty", law.penalty, 1e-6, 1e12, "the stiffness of the bond", steepness)
    if law.slides:
        yield from _sliding(law, steepness)


def _sliding(law: Interface, steepness: float) -> Iterator[Range]:
    """Limits of the numbers of sliding: relative to those of opening, or absolute for pure numbers."""
    of_opening = {"strength": law.strength, "toughness": law.toughness}
    for key, size in of_opening.items():
        yield _beside(f"interface.shear_{key}", getattr(law, f"shear_{key}"), 1e-6, 1e6, f"interface.{key}", size)
    other = "the stiffness of the bond"
    yield _beside("interface.shear_stiffness", law.shear_stiffness or 0.0, 1e-12, 1e12, other, steepness)
    yield "interface.exponent", law.exponent, 1.0, 20.0, "which is steeper than any bond"
    yield "interface.friction", law.friction, 0.0, 100.0, "which holds more than any face"
    yield "interface.viscosity", law.viscosity, 0.0, 1e6, "durations of the programme"
    yield "interface.pressure_strength", law.pressure_strength, 0.0, 1e6, "strength for a unit of pressure"


def _paths(scene: Scene) -> Iterator[Range]:
    size, openings = scene.specimen.extent, scene.load.opening
    for i, (before, after) in enumerate(zip((0.0, *openings[:-1]), openings, strict=True)):
        key = f"load.opening[{i}]" if len(openings) > 1 else "load.opening"
        far = abs(after - before)
        if far < 1e-12 * size:
            yield key, far, 1e-12 * size, 4 * size, "as its distance from the opening before it, 1e-12 times the length"
    for i, shift in enumerate(scene.pose.shift):
        yield f"pose.shift[{i}]", shift, -1e6 * size, 1e6 * size, "a million times the length"


def _materials(scene: Scene) -> list[tuple[str, Material]]:
    return list(scene.named_materials.items())


def _modulus(material: Material) -> float:
    return material.young if isinstance(material, Isotropic) else material.E1


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
