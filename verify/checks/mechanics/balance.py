"""By how much forces and moments may miss their balance: what Newton's tolerance and rounding leave of them.

A solver that stops at a residual of norm R leaves sums of forces of that size, and moments of that size times the
length. The norms are those that the solvers stop by, estimated from the scene.
"""

from __future__ import annotations

import numpy as np

from verify.methods.method import Prepared
from verify.result import Result
from verify.scene import process_zone

#: What any code has to balance to where less than that is to be expected.
LEAST = 1e-8
#: More than that no specimen explains.
MOST = 1e-3
#: Rounding of the forces of an element of ``iga``, in units of the machine epsilon, as ``iga.system.system.rounding``
#: has it.
ROUNDING = 40.0
#: Rounding of a whole assembled system, in units of the machine epsilon: equal elements round alike, and their errors
#: add up (up to 2.4 were measured).
ALIKE = 5.0
#: Displacement of closed points in DOLFINx, in units of the opening that breaks the bond.
CONTACT = 10.0


def force_tolerance(prepared: Prepared, result: Result) -> float:
    """Force that may be missing, over the peak load."""
    return float(np.clip(_residual(prepared, result), LEAST, MOST))


def moment_tolerance(prepared: Prepared, result: Result) -> float:
    """Moment that may be missing, over that of the peak load about the tip: that force, as far away as the specimen is
    long."""
    lever = prepared.scene.specimen.extent / prepared.scene.specimen.free_length
    return float(np.clip(lever * _residual(prepared, result), LEAST, MOST))


def _residual(prepared: Prepared, result: Result) -> float:
    """Norm of the residual that a run may end its steps with, over its peak load; 0 where nothing is known of it.

    An arm that bends holds forces of a / h times its load against each other in each of its elements; their norm, of
    which ``iga`` leaves its tolerance, is ``2 a / h sqrt(n_elements)`` (0.2 to 2.2 of ``a / h sqrt(n_elements)`` were
    measured). Rounding leaves ``eps K u``: K = E w (h / l + l / h) is the stiffness of an element of length l, and u
    what it multiplies: the displacement of the whole specimen in DOLFINx, and in ``iga`` where the bulk is linear; else
    that of an element relative to itself, l times the slope of the arm. DOLFINx makes one correction more than its
    tolerance asks for; its contact is as stiff as the penalty, where the arms have hardly moved apart.
    """
    scene, load = prepared.scene, float(np.max(np.abs(result.load), initial=0.0))
    if not prepared.method.has_mesh or load == 0.0 or not result.elements:
        return 0.0
    body = scene.specimen
    length, h, eps = prepared.element, body.loaded_thickness, float(np.finfo(float).eps)
    modulus = max(process_zone.bending_modulus(material, body.plane) for material in scene.materials)
    stiffness, moved = modulus * body.width * (h / length + length / h), float(np.max(np.abs(result.opening)))
    whole = ALIKE * float(np.sqrt(result.dofs)) * eps * stiffness * moved / load
    if prepared.method.code != "iga":
        law = scene.interface
        closed = CONTACT * law.penalty * length * body.width * 2.0 * law.toughness / law.strength
        return whole + float(np.sqrt(result.dofs)) * eps * closed / load
    from iga.path.solver import DEFAULT

    slope = min(1.0, 0.75 * moved / body.free_length)  # of one of two arms at its end, 3/2 of its mean
    relative = float(np.sqrt(result.elements)) * ROUNDING * eps * stiffness * slope * length / load
    left = float(np.sqrt(result.elements)) * 2.0 * DEFAULT.tolerance * body.free_length / h
    return left + (whole if prepared.effects["kinematics"] == "linear" else relative)
