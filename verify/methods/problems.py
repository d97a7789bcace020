"""A scene in the terms that several solvers share: keys of their problems."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from verify.methods.method import Unsuitable
from verify.scene.bond.bond import bond_of
from verify.scene.bond.interface import BOND_TO_CONTACT
from verify.scene.materials import axial_modulus, elastic_constants, plane_compliance
from verify.scene.schema import Scene, counted_steps
from verify.theory.bond import Bond

if TYPE_CHECKING:
    from verify.theory.law import KnownLaw
    from verify.theory.mixed_law import MixedBond

#: Fractions of the largest opening at which fields are stored: before and near the peak, during growth, at the end.
SNAPSHOT_FRACTIONS = (0.1, 0.2, 0.5, 1.0)


def common_keys(scene: Scene, effects: Mapping[str, Any]) -> dict[str, Any]:
    """Width, plane, load and effects, which every solver calls by the same names, whatever the specimen."""
    specimen = scene.specimen
    return {
        "width": specimen.width,
        "plane": specimen.plane,
        "opening": scene.load.opening,
        "load_at": scene.load.at,
        "kinematics": effects["kinematics"],
        "snapshot_openings": tuple(f * max(0.0, *scene.load.opening) for f in SNAPSHOT_FRACTIONS),
    }


def rectangles(scene: Scene, rectangle: Callable[..., Any], moduli: Callable[..., Any]) -> tuple[Any, ...]:
    """The upper and the lower body in a solver's own terms: length, thickness and elastic constants."""
    sizes, constants = scene.specimen, [elastic_constants(material) for material in scene.materials]
    return tuple(map(rectangle, sizes.lengths, sizes.thicknesses, (moduli(**one) for one in constants)))


def arms_problem(scene: Scene, effects: Mapping[str, Any], order: int) -> Any:
    """The problem of a scene for ``verify.theory.arms``, with displacements of an order through the thickness."""
    from verify.scene.effects import crack_at_the_end
    from verify.scene.process_zone import zone_length
    from verify.theory.arms.problem import ArmsProblem, Load, Support

    specimen, keys = scene.specimen, common_keys(scene, effects)
    count = 1 if specimen.symmetric and not effects["shear"] else 2
    return ArmsProblem(
        bodies=_bodies(scene, order)[:count],
        lengths=specimen.lengths[:count],
        bonded=specimen.bonded,
        loads=tuple(Load(*load) for load in specimen.loads),
        supports=tuple(Support(*support) for support in specimen.supports),
        bond=known_law(bond_of(with_contact_of_arms(scene), effects)),
        zone=zone_length(scene),
        reach=crack_at_the_end(scene),
        loaded_at=specimen.loaded_at,
        order=order,
        in_a_zone=scene.beam.in_a_zone,
        points=counted_steps(scene),
        **{name: keys[name] for name in ("width", "opening", "kinematics", "snapshot_openings")},
    )


def known_law(bond: Bond) -> KnownLaw | MixedBond:
    """The law of ``verify.theory`` with the numbers of a bond."""
    from verify.scene.bond.opening import opening_law
    from verify.theory.law import KnownLaw
    from verify.theory.mixed_law import MixedBond

    if bond.slides:
        return MixedBond(**vars(bond))
    law = opening_law(bond)
    if not isinstance(law, KnownLaw):
        raise Unsuitable(f"interface.law: must be one that the beam knows, got {bond.law!r}")
    return law


def with_contact_of_arms(scene: Scene) -> Scene:
    """The scene with a contact no stiffer than an arm across its thickness, or than by default on its bond.

    What lies beyond changes no curve by more than the arms give, and the zones of contact of faces on a bond ten
    thousand times as soft alternate from iteration to iteration.
    """
    across = (
        elastic_constants(material)["E2"] / thickness
        for material, thickness in zip(scene.materials, scene.specimen.thicknesses, strict=True)
    )
    bond = known_law(bond_of(scene, {"shear": scene.interface.slides, "irreversible": True, "contact": True}))
    stiffest = max(*across, BOND_TO_CONTACT * bond.slopes[0])
    if scene.interface.penalty <= stiffest:
        return scene
    return scene.model_copy(update={"interface": scene.interface.model_copy(update={"penalty": stiffest})})


def _bodies(scene: Scene, order: int) -> tuple[Any, ...]:
    """The upper and the lower body; under a strip of order 1 an elastic layer."""
    from numpy.linalg import inv

    from verify.theory.arms.problem import Arm
    from verify.theory.layer import Layer

    specimen = scene.specimen
    found: list[Any] = []
    for i, (material, thickness) in enumerate(zip(scene.materials, specimen.thicknesses, strict=True)):
        constants, clamped = elastic_constants(material), i >= specimen.arms
        if clamped and order == 1:
            found.append(Layer.of((specimen.lengths[i], thickness), plane=specimen.plane, **constants))
            continue
        young, stiffness = axial_modulus(material, specimen.plane), inv(plane_compliance(material, specimen.plane))
        found.append(Arm(thickness, young, constants["E2"], constants["G12"], stiffness, clamped))
    return tuple(found)
