"""The packaged scenes for a terminal: a line per scene, or one scene with numbers and a drawing."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import replace

from verify.methods import bonds
from verify.methods.mesh_choice import size
from verify.methods.reference_mesh import reference_mesh
from verify.methods.solve import prepare, require
from verify.scene.bond.interface import Interface
from verify.scene.laws import EXPONENTIAL, OWN_KEYS
from verify.scene.materials import Isotropic, Material
from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination, Load, Support
from verify.theory.arms.brittle import stability

NAME_WIDTH = 24

#: Lengths of crack at which its growth is looked at.
GROWN_CRACKS = 40


def line(name: str, scene: Scene, width: int) -> str:
    """Name and main data of a scene; on a narrow terminal the data are below the name."""
    law, effects = scene.interface, scene.effects
    text = (
        f"{scene.specimen.kind}, {effects.kinematics} kinematics, strength {law.strength:g}, "
        f"toughness {law.toughness:g}, opened to {max(scene.load.opening):g} ({scene.units})"
    )
    if NAME_WIDTH + 1 + len(text) <= width:
        return f"{name:{NAME_WIDTH}} {text}"
    return "\n".join([name, *textwrap.wrap(text, width, initial_indent="  ", subsequent_indent="  ")])


def page(scene: Scene, width: int) -> str:
    """Drawing and key numbers."""
    law, mesh, other = scene.interface, scene.discretization, reference_mesh(scene)
    facts = {
        "specimen": f"{scene.specimen.kind}, plane {scene.specimen.plane}, width {scene.specimen.width:g}",
        **{name: _material(material) for name, material in scene.named_materials.items()},
        "interface": f"{law.law}, strength {law.strength:g}, toughness {law.toughness:g}, ductility {law.ductility:g}"
        f"{_shape(law)}",
        "sliding": _sliding(law),
        "remark": "; ".join(bonds.remarks(scene)),
        "growth": _growth(scene),
        "opening": " -> ".join(f"{opening:g}" for opening in scene.load.opening),
        "effects": ", ".join(
            f"{name} {value}" if isinstance(value, str) else name if value else f"no {name}"
            for name, value in scene.effects
        ),
        "meshes": f"{size(scene, True).words}, degree {mesh.degree}; DOLFINx {size(scene, False).words}, "
        f"{other.layers} through, degree {other.degree}",
        "published": "; ".join(f"{one.quantity}, {one.source}" for one in scene.published),
    }
    whole_words = textwrap.TextWrapper(
        min(width, 100), subsequent_indent=" " * 11, break_long_words=False, break_on_hyphens=False
    )
    body = [part for name, text in facts.items() if text for part in whole_words.wrap(f"{name:10} {text}")]
    return "\n".join([f"{scene.name} ({scene.units})", "", *sketch(scene, width), "", *body])


def _shape(law: Interface) -> str:
    """What a law has besides strength, toughness and ductility."""
    own = [f", {key.replace('_', ' ')} {getattr(law, key):g}" for key in OWN_KEYS.get(law.law, ()) if key != "table"]
    corners = ", ".join(f"({opening:g}, {traction:g})" for opening, traction in law.table)
    return f", corners {corners}" if corners else "".join(own)


def _sliding(law: Interface) -> str:
    """Nothing for a bond that opens alone."""
    if not law.slides:
        return ""
    others = {key: getattr(law, key) for key in ("friction", "viscosity", "pressure_strength")}
    more = [f"{key} {value:g}" for key, value in others.items() if value]
    mixing = [] if law.law == EXPONENTIAL else [f"{law.criterion} of exponent {law.exponent:g}, onset {law.onset}"]
    strengths = f"strength {law.shear_strength:g}, toughness {law.shear_toughness:g}"
    return ", ".join([f"{strengths}, stiffness {law.shear_stiffness:g}", *mixing, *more])


def _growth(scene: Scene) -> str:
    """Whether fracture mechanics has the crack of a bond that slides run away at a prescribed deflection."""
    prepared = prepare(scene, "lefm")
    if not prepared.effects["shear"]:
        return ""
    try:
        require(prepared)
        found = stability(replace(prepared.problem, points=GROWN_CRACKS))
    except ValueError:  # a programme that unloads; loads that release nothing, or that nothing takes
        return ""
    precrack = scene.specimen.free_length
    if found.stable:
        shorter = [a for a in found.changes if a < precrack]
        return "by LEFM stable" + (f"; unstable with a precrack shorter than {shorter[-1]:.3g}" if shorter else "")
    longer = [a for a in found.changes if a > precrack]
    until = f" up to a crack length of {longer[0]:.3g}" if longer else ""
    return f"by LEFM unstable: the deflection falls while the crack grows{until}"


def _material(material: Material) -> str:
    kind = "isotropic" if isinstance(material, Isotropic) else "orthotropic"
    return f"{kind}, " + ", ".join(f"{key} {value:g}" for key, value in material if value is not None)


#: Width of the notes to the right of a drawing.
NOTES = 16
#: Lines of a body at most: the thinner one has one, the other so many times more.
MOST_ROWS = 5


def sketch(scene: Scene, width: int) -> list[str]:
    """Lines of at most ``width`` characters (40 at least) in ASCII."""
    specimen, longest = scene.specimen, max(scene.specimen.lengths)
    room = min(max(width, 40), 100) - NOTES - 4
    tip, *ends = (min(max(round(length / longest * room), 1), room) for length in (specimen.tip, *specimen.lengths))
    forward = specimen.tip > specimen.loaded_at
    start, end = (tip, ends[0]) if forward else (0, tip)
    if not forward:
        ends[0] = max(ends[0], tip + 2)  # the free end can be seen
    bond = f" {'':{start}}{':' * (end - start)}{' ' * (end == max(ends))}  bond"
    upper, lower = (
        [f"+{'-' * n}+", f"|{'':{n}}|  {h:.4g} thick", *[f"|{'':{n}}|"] * (rows - 1), f"+{'-' * n}+"]
        for n, h in zip(ends, specimen.thicknesses, strict=True)
        for rows in [min(round(h / min(specimen.thicknesses)), MOST_ROWS)]
    )
    lines = ["opening " + " -> ".join(f"{opening:.4g}" for opening in scene.load.opening)]
    lines += [*_acting(specimen, 0, ends), *upper, _marked(bond, specimen, _under(specimen, 0), ends), *lower]
    lines += _acting(specimen, 1, ends)
    lines += [f" {'/' * ends[clamp.body]}  fixed" for clamp in specimen.clamps if clamp.side == "bottom"]
    if under := list(_under(specimen, 1)):
        lines.append(f"{_marked('', specimen, under, ends):{room + 2}}  o: supports")
    if any(support.couple for support in specimen.supports if support.body is None):
        lines.append(f"{'':{room}} |  guided")
    measured = {(specimen.tip, tip), *zip(specimen.lengths, ends, strict=True)}
    lines += [_measure(n, f" {length:.4g} ") for length, n in sorted(measured)]
    return ["  " + line.rstrip() for line in lines]


def _acting(specimen: Delamination, body: int, ends: list[int]) -> list[str]:
    """A line with a mark for every load on a body: an arrow of a force, @ of a couple."""
    found = [load for load in specimen.loads if (load.body or 0) == body]
    return [_marked("", specimen, found, ends)] if found else []


def _under(specimen: Delamination, body: int) -> Iterable[Support]:
    return (one for one in specimen.supports if one.body == body)


def _marked(line: str, specimen: Delamination, patches: Iterable[Load | Support], ends: list[int]) -> str:
    """A line with a sign in the middle of each patch."""
    letters = list(f"{line:{max(ends) + 2}}")
    for one in patches:
        body = one.body or 0
        sign = "o" if isinstance(one, Support) else "@" if one.couple else "^" if one.share > 0.0 else "v"
        letters[1 + round(specimen.middle(one) / specimen.lengths[body] * (ends[body] - 1))] = sign
    return "".join(letters)


def _measure(end: int, label: str) -> str:
    """|<--- 14 --->| or, where the number does not fit, the number behind the line."""
    return f"|{'-' * end}|{label}" if end - 2 < len(label) else f"|<{label:-^{end - 2}}>|"
