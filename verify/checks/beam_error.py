"""How far the cohesive beam is from a plane specimen: the error of the theory itself, which it can be held to.

An arm of a dcb gives way across, which a beam does not, and its bonded face is not its axis: where the arm bends, the
face comes up to meet it by Poisson's ratio. The two act against one another. Both change how far the arm turns at the
tip of the bond, as a longer or shorter crack would, and so count by the thickness over the free length.
"""

from __future__ import annotations

from math import sqrt

from verify.scene.effects import simulated
from verify.scene.materials import elastic_constants
from verify.scene.process_zone import across_modulus, bending_modulus, poisson
from verify.scene.schema import Scene

#: On slender arms, which hardly have what a beam leaves out; the finite one also lacks the St. Venant-Kirchhoff bulk.
ANALYTICAL = {"linear": 0.002, "finite": 0.005}
#: Under a strip it leaves out how the corner of a substrate gives way: 0.41 % of the curve where the bond begins there.
ON_SUBSTRATE = 0.015
#: Error of the theory beyond which no curve is held against the beam.
NO_JUDGE = 0.03
#: What is stated at the least: NURBS and beam were 1e-4 to 8e-4 apart where there is nothing that the beam leaves out.
LEAST = 0.001
#: The root of the elastic squeeze at which Poisson's ratio acts by half.
SATURATED = 0.04
#: Shares of Poisson's ratio and of the give across, what is left where they cancel, and the margin on the fit.
POISSON, ACROSS, APART, MARGIN = 0.12, 0.126, 0.15, 1.5


def tolerance(scene: Scene) -> float | None:
    """Distance that a curve may keep from the beam's (relative L2); None where the beam is no judge.

    What a finite beam lacks besides is there on stocky arms as well.
    """
    if scene.specimen.clamped:
        return ON_SUBSTRATE
    error, slender = theory_error(scene), ANALYTICAL[simulated(scene)["kinematics"]]
    return None if error > NO_JUDGE else max(slender, error + slender - ANALYTICAL["linear"])


def meaning(scene: Scene) -> str:
    """What the theory is good for on the arms of a scene."""
    if scene.specimen.clamped:
        return f"it leaves out the corner of the substrate, up to {ON_SUBSTRATE:.1%}"
    slenderness = f"a0 / h = {scene.specimen.free_length / scene.specimen.loaded_thickness:.3g}"
    return f"its own error with {slenderness} on this bond is up to {100.0 * theory_error(scene):.2g} %"


def theory_error(scene: Scene) -> float:
    """Bound of the distance between the curves of the beam and of a plane dcb (relative L2 over the opening); of a peel
    ON_SUBSTRATE.

    ``1.5 h / a0 (|P - S| + 0.15 (P + S))`` with ``P = 0.12 nu' t / (t + 0.04)``, ``t^2 = s D``, and ``S = 0.126 (s E1 /
    E2)^(1/2) (G12 / E1)^(1/4)``, of the ductility D and the `squeeze` s, whose root goes as (h / l)^2 with the length l
    of the process zone. Fitted to how far NURBS that resolve their zone are from the beam, on 90 random scenes of a0 /
    h from 4 to 75, E1 / E2 from 1 to 15, E1 / G12 from 2 to 27, l / h from 0.3 to 10 and D from 2 to 50, in both planes
    and kinematics: 1.2 to 3.2 times the distance, where that is more than 0.1 %.
    """
    if scene.specimen.clamped:
        return ON_SUBSTRATE
    body, arm, root = scene.specimen, scene.materials[0], sqrt(squeeze(scene))
    constants, along = elastic_constants(arm), bending_modulus(arm, body.plane)
    elastic = root * scene.interface.ductility**0.5
    turned_up = POISSON * poisson(arm, body.plane) * elastic / (elastic + SATURATED)
    stretched = (along / across_modulus(arm, body.plane)) ** 0.5 * (constants["G12"] / constants["E1"]) ** 0.25
    given_way = ACROSS * root * stretched
    turned = abs(turned_up - given_way) + APART * (turned_up + given_way)
    return max(LEAST, MARGIN * turned * body.loaded_thickness / body.free_length)


def squeeze(scene: Scene) -> float:
    """How far a traction as large as the strength squeezes an arm, in parts of the opening that breaks the bond.

    ``h p_max / (E2 g_u)`` of a dcb; 0 of a peel, whose strip has the same layer under it in the beam.
    """
    if scene.specimen.clamped:
        return 0.0
    law, body = scene.interface, scene.specimen
    across = across_modulus(scene.materials[0], body.plane)
    return body.loaded_thickness * law.strength**2 / (2.0 * across * law.toughness)
