"""The packaged scenes for a terminal: a line per scene, or one scene with numbers and a drawing."""

from __future__ import annotations

import textwrap
from dataclasses import replace

from verify.command_line.scenes.sketch import sketch
from verify.methods import bonds
from verify.methods.mesh_choice import size
from verify.methods.reference_mesh import reference_mesh
from verify.methods.solve import prepare, require
from verify.scene.bond.interface import Interface
from verify.scene.laws import EXPONENTIAL, OWN_KEYS
from verify.scene.materials import Isotropic, Material
from verify.scene.schema import Scene
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
        "effects": ", ".join(_effect(name, getattr(scene.effects, name)) for name in type(scene.effects).model_fields),
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


def _effect(name: str, value: bool | str) -> str:
    return f"{name} {value}" if isinstance(value, str) else name if value else f"no {name}"
