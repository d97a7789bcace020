"""What the tables of a scene ask of each other, each of which is valid by itself."""

from __future__ import annotations

from collections.abc import Iterator

from verify.scene.schema import Scene
from verify.scene.stated.uncertainty import DATA_KEYS, number_at, numbers_in
from verify.scene.tables import Broken
from verify.support.programme import turns


def broken(scene: Scene) -> Iterator[Broken]:
    """Every broken rule, by the path of its key."""
    yield from _load(scene)
    yield from _effects(scene)
    yield from _meshes(scene)
    yield from _published(scene)
    for key, value in scene.uncertainty.inputs.items():
        if number_at(scene, key) is None:
            known = ", ".join([*numbers_in(scene), *DATA_KEYS])
            yield ("uncertainty", key), f"that of a number of the scene that is not 0: one of {known}", value


def _load(scene: Scene) -> Iterator[Broken]:
    """Two arms of length L cannot be more than 2 L apart; rollers and couples have a traction of their own."""
    specimen, load = scene.specimen, scene.load
    (low, why_low), (high, why_high) = specimen.most
    for i, opening in enumerate(load.opening):
        if not low <= opening <= high:
            yield ("load", "opening", i), f">= {low:g} ({why_low}) and <= {high:g} ({why_high})", opening
    if specimen.slides and load.at != "face":
        yield ("load", "at"), f'"face" for the kind {specimen.kind}', load.at


def _effects(scene: Scene) -> Iterator[Broken]:
    """What needs a bond that slides, what such a bond excludes, and what two equal arms allow."""
    specimen, bond, effects = scene.specimen, scene.interface, scene.effects
    if specimen.slides and not bond.slides:
        text = f"one with shear_strength and shear_toughness for the kind {specimen.kind}, whose bond slides"
        yield ("interface",), text, sorted(bond.model_fields_set)
        return
    if effects.shear is True and not bond.slides:
        why = "without interface.shear_strength and interface.shear_toughness"
        yield ("effects", "shear"), f'false or "auto" {why}', True
    needed = [f"for the kind {specimen.kind}, whose arms nothing else holds"] * bool(specimen.supports)
    needed += [f"with interface.{key}" for key in ("friction", "viscosity") if getattr(bond, key)]
    if effects.shear is False and needed:
        yield ("effects", "shear"), f'true or "auto" {needed[0]}', False
    if effects.symmetry is True and (effects.shear is True or bond.viscosity):
        yield ("effects", "symmetry"), "false with a law of sliding, which acts between two arms", True
    bodies = " and ".join(specimen.bodies)
    if effects.symmetry is True and not specimen.symmetric:
        yield ("effects", "symmetry"), f"false for a {specimen.kind}: {bodies} differ", True
    if effects.search is False and not specimen.symmetric:
        yield ("effects", "search"), f"true for a {specimen.kind}: {bodies} turn", False


def _meshes(scene: Scene) -> Iterator[Broken]:
    specimen, mesh = scene.specimen, scene.discretization

    def rule(key: str, text: str) -> Broken:
        return ("discretization", key), text, getattr(mesh, key)

    if mesh.layers not in ("auto", 1) and specimen.clamped:
        yield rule("layers", f"1 for a {specimen.kind}, whose lower body is graded")
    if mesh.adaptive and not specimen.symmetric:
        yield rule("adaptive", f"false for a {specimen.kind}")
    elif mesh.adaptive and specimen.mesh:
        yield rule("adaptive", "false with specimen.mesh, which is taken as it is")
    if mesh.adaptive and mesh.mismatch != 1.0:
        yield rule("mismatch", "1 with discretization.adaptive, whose arms are alike")
    elif scene.effects.symmetry is True and mesh.mismatch != 1.0:
        yield rule("mismatch", "1 with effects.symmetry, which models the upper arm alone")
    if scene.effects.symmetry is True and mesh.slave != "upper":
        yield rule("slave", '"upper" with effects.symmetry, which models the upper arm alone')


def _published(scene: Scene) -> Iterator[Broken]:
    """Openings of published values are on the way of the programme."""
    way, end = (0.0, *turns(scene.load.opening)), max(scene.load.opening)
    for i, value in enumerate(scene.published):
        if value.opening is None:
            continue
        leg, opening = value.leg, ("published", i, "opening")
        if value.opening > end:
            yield opening, f"<= {end:g}, the largest load.opening", value.opening
        elif leg is not None and leg >= len(way):
            yield ("published", i, "leg"), f"<= {len(way) - 1}, the number of legs of load.opening", leg
        elif leg is not None:
            low, high = sorted(way[leg - 1 : leg + 1])
            if not low <= value.opening <= high:
                yield opening, f">= {low:g} and <= {high:g}, leg {leg} of load.opening", value.opening
