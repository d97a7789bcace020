"""Numbers, units and sentences of the pages."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from markupsafe import Markup, escape

from verify.methods.mesh_choice import size, spline_mesh
from verify.methods.reference_mesh import reference_mesh
from verify.methods.solve import prepare
from verify.scene.effects import simulated
from verify.scene.keys import keys_of
from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination
from verify.verdict import Counts

#: Names of inputs with their symbols, and what part of `Units` each dimension has.
_INPUT_NAMES = {
    "strength": "strength p_max",
    "toughness": "toughness G_Ic",
    "shear_strength": "shear strength t_max",
    "shear_toughness": "shear toughness G_IIc",
    "shear_stiffness": "shear stiffness K_s",
    "dofs": "target unknowns",
    "elements": "elements along",
    "in_a_zone": "elements in a process zone",
    "young": "Young's modulus",
    "poisson": "Poisson's ratio",
    "ductility": "ductility 2 G_Ic / (p_max g_max)",
}
_DIMENSIONS = {
    "": "none",
    "length": "length",
    "stress": "stress",
    "stress per length": "stiffness",
    "energy per area": "toughness",
}

_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
NO_VALUE = "no value"

#: Characters that are markup in Markdown; an angle bracket before a space or a digit is not.
_SPECIAL = re.compile(r"[\\`*\[\]|]|<(?=[A-Za-z/!?])|&(?=#?\w+;)|~(?=~)|^[>#+-]|(?<!\w)_|_(?!\w)")


@dataclass(frozen=True)
class Units:
    """Unit labels; empty where the scene's label has not three parts."""

    force: str = ""
    length: str = ""
    stress: str = ""
    none: str = ""

    @staticmethod
    def of(label: str) -> Units:
        """Read ``"N, mm, MPa"``: force, length, stress."""
        parts = [part.strip() for part in str(label).split(",")]
        return Units(*parts) if len(parts) == 3 else Units()

    @property
    def energy(self) -> str:
        return f"{self.force} {self.length}".strip()

    @property
    def stiffness(self) -> str:
        return f"{self.stress}/{self.length}" if self.stress and self.length else ""

    @property
    def toughness(self) -> str:
        return f"{self.force}/{self.length}" if self.force and self.length else ""


def axis(name: str, unit: str) -> str:
    """Label of an axis."""
    return f"{name} ({unit})" if unit else name


def number(value: float | None, digits: int = 3, pad: bool = False) -> str:
    """A number in running text: 0.0123, 1200, 1.2 × 10⁻⁹; ``pad`` keeps trailing zeros."""
    if value is None or math.isnan(value):
        return NO_VALUE
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if -4 <= exponent < 6:
        text = f"{value:.{max(digits - 1 - exponent, 0)}f}"
        text = text.rstrip("0").rstrip(".") if "." in text and not pad else text
    else:
        mantissa = f"{value / 10.0**exponent:.{digits - 1}f}".rstrip("0").rstrip(".")
        text = f"{mantissa}\u00a0×\u00a010{str(exponent).translate(_SUPERSCRIPTS)}"
    whole, point, rest = text.partition(".")
    if whole.lstrip("-").isdigit() and len(whole.lstrip("-")) > 4:
        whole = f"{int(whole):,}".replace(",", "\u202f")
    return (whole + point + rest).replace("-", "−")


def plain(text: object) -> str:
    """Text of Markdown on one line, with its markup characters escaped."""
    return _SPECIAL.sub(r"\\\g<0>", re.sub(r"\s*[\r\n]+\s*", " ", str(text)))


def power_of_ten(value: float) -> str:
    """10⁻⁴ for 1e-4: a label of a logarithmic axis."""
    return f"10{str(round(math.log10(value))).translate(_SUPERSCRIPTS)}" if value > 0 else ""


def symbols(text: str) -> Markup:
    """``p_max`` as an italic letter with an index."""
    return Markup(re.sub(r"\b([GKgpt])_(II?c|max|s|u)\b", r"<i>\1</i><sub>\2</sub>", str(escape(text))))


def quantity(value: float | None, unit: str, digits: int = 6) -> str:
    """A number with its unit, e.g. 14 mm."""
    return f"{number(value, digits)}\u00a0{unit}".strip()


def percent(fraction: float | None) -> str:
    """A relative number in per cent, two digits: 0.12 %."""
    if fraction is None or math.isnan(fraction):
        return NO_VALUE
    if 0 < abs(fraction) < 5e-6:
        return "<\u00a00.0005\u00a0%"
    return f"{number(100 * fraction, 2, pad=True)}\u00a0%"


def seconds(value: float | None, unknown: str = NO_VALUE) -> str:
    """A duration: 0.31 s, 8.9 s, 2 min 5 s."""
    if value is None or math.isnan(value):
        return unknown
    if value < 0.095:
        return "<\u00a00.1\u00a0s"
    if value < 99.5:
        return f"{number(value, 2, pad=True)}\u00a0s"
    return f"{int(round(value)) // 60}\u00a0min\u00a0{int(round(value)) % 60}\u00a0s"


def span(values: list[float], form: Callable[[float], str]) -> str:
    """The smallest and the largest value by ``form``; only one if their texts are equal."""
    low, high = form(min(values)), form(max(values))
    return low if low == high else f"{low} to {high}"


def sentence(scene: Scene) -> str:
    """The problem with its effects, in words."""
    unit, specimen, found = Units.of(scene.units).length, scene.specimen, simulated(scene)
    openings = " → ".join(number(v, 4) for v in scene.load.opening)
    turned = "radians" if all(load.couple for load in specimen.loads) else unit
    words: Mapping[str, Mapping[object, str]] = {
        "kinematics": {
            "finite": "finite kinematics (large rotations)",
            "linear": "linear kinematics (small displacements)",
        },
        "irreversible": {True: "irreversible damage", False: "reversible damage (nothing is dissipated)"},
        "contact": {True: "contact on closing", False: "no contact"},
        "search": {True: "points look for the other face", False: "points keep their places on the other face"},
        "symmetry": {True: "one arm against the symmetry plane", False: f"both {_bodies(scene)} modelled"},
    }
    chosen = {key for key, value in scene.effects if value == "auto"}
    effects = ", ".join(words[key][found[key]] + ", chosen automatically" * (key in chosen) for key in words)
    moved = f"{specimen.sentence.format(**dict(_sizes(specimen, unit)))} to {openings} {turned}".rstrip()
    state = "as a solid" if specimen.plane == "solid" else f"in plane {specimen.plane}"
    return f"{moved}, {state}, with a {scene.interface.law} traction law and {effects}."


def _sizes(specimen: Delamination, unit: str) -> Iterator[tuple[str, str]]:
    """Numbers of a specimen in words; of a pair of equal ones, one."""
    for key in keys_of("specimen", type(specimen)):
        value = getattr(specimen, key.name)
        numbers = value if isinstance(value, tuple) else (value,)
        if numbers and all(isinstance(one, float) for one in numbers):
            shown = [quantity(one, unit if key.dimension == "length" else "") for one in numbers]
            yield key.name, " and ".join(dict.fromkeys(shown) if key.dimension == "length" else shown)


def _bodies(scene: Scene) -> str:
    return f"{scene.specimen.body}s" if scene.specimen.symmetric else "bodies"


def modelled(scene: Scene, method: str) -> str:
    """The effects as a method simulates them, in short."""
    effects = prepare(scene, method).effects
    said = [f"{effects['kinematics']} kinematics"]
    if method != "lefm":
        said.append("irreversible damage" if effects["irreversible"] else "reversible damage")
        said.append("contact" if effects["contact"] else "no contact")
    return ", ".join([*said, "one arm" if effects["symmetry"] else f"both {_bodies(scene)}"])


def inputs(scene: Scene) -> list[tuple[str, str, str]]:
    """Rows of the table of inputs: group, name, value; with what follows from them."""
    units, law, mesh, other = Units.of(scene.units), scene.interface, scene.discretization, reference_mesh(scene)
    tables = {**scene.named_materials, "interface": law}
    known = {"ductility", "penalty", *(("criterion", "exponent", "onset", "shear_stiffness") if law.slides else ())}
    rows = [
        (
            group,
            _INPUT_NAMES.get(key.name, key.name.replace("_", " ")),
            _input(value, getattr(units, _DIMENSIONS[key.dimension])),
        )
        for group, table in tables.items()
        for key in keys_of(group, type(table))
        if key.name in {*table.model_fields_set, *known}
        and (value := getattr(table, key.name)) not in (None, (), "auto")
    ]
    scale, bilinear = 2 * law.toughness / law.strength, law.law == "bilinear"
    sizes = [
        (_INPUT_NAMES[one.key.rpartition(".")[2]], number(one.value, 6))
        for one in (size(scene, True), size(scene, False))
    ]
    lumped, points = mesh.interface_rule == "lumped", spline_mesh(scene).points
    return [
        *(("specimen", name.replace("_", " "), value) for name, value in _sizes(scene.specimen, units.length)),
        *rows,
        *[("interface", "full opening g_u = 2 G_Ic / p_max", quantity(scale, units.length))] * bilinear,
        ("interface", "opening at peak g_max", quantity(scale / law.ductility, units.length)),
        ("isogeometric mesh", "degree", str(mesh.degree)),
        ("isogeometric mesh", *sizes[0]),
        ("isogeometric mesh", "interface points", "at control points" if lumped else f"{points} per element"),
        ("isogeometric mesh", "interface rule", mesh.interface_rule),
        ("DOLFINx mesh", "degree", str(other.degree)),
        ("DOLFINx mesh", *sizes[1]),
        ("DOLFINx mesh", f"elements through the {scene.specimen.body}", str(other.layers)),
    ]


def _input(value: object, unit: str) -> str:
    """A number with its unit; of each corner of a tabular law opening and traction."""
    if isinstance(value, tuple):
        return "; ".join(", ".join(map(number, corner)) for corner in value)
    return quantity(value, unit) if isinstance(value, float) else str(value)


def tone(counts: Counts) -> str:
    """The class of a verdict in the style sheet: ``bad`` where a check is broken, ``open`` where one judges nothing."""
    if not counts.total:
        return "none"
    return "bad" if counts.broken else "open" if counts.held < counts.total else "good"
