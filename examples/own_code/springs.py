"""One arm as a shear-flexible beam on springs: a solver that debond runs and judges like its own methods."""

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import spsolve

from verify.result import Result

ELEMENTS, STEPS = 560, 75


def unsuitable(scene):
    """Why the solver is not made for a scene, or nothing: what it leaves out it must not be asked for."""
    if scene.specimen.kind != "dcb" or scene.specimen.plane != "stress" or not hasattr(scene.material, "young"):
        return "only for a dcb of an isotropic material in plane stress"
    return "" if scene.effects.kinematics == "linear" else 'effects.kinematics: must be "linear"'


def solve(scene, on_step):
    """Load over opening by displacement control; ``on_step`` is called with every converged row."""
    s, h, E = scene.specimen, scene.specimen.arm_thickness, scene.material.young
    bending, shear = E * s.width * h**3 / 12, 5 / 6 * E / (2 + 2 * scene.material.poisson) * s.width * h
    free = round(ELEMENTS * s.precrack / s.length)
    x = np.append(np.linspace(0, s.precrack, free + 1)[:-1], np.linspace(s.precrack, s.length, ELEMENTS - free + 1))
    sides = s.width * np.diff(np.maximum(x, s.precrack)) / 2
    bonded = np.append(sides, 0) + np.append(0, sides)  # area of the bond that each node stands for
    K = beam(np.diff(x), bending, shear)
    u, largest, opened, loads = np.zeros(2 * x.size), np.zeros(x.size), [0.0], [0.0]
    on_step({"opening": 0.0, "load": 0.0})
    for opening in np.concatenate([np.linspace(a, b, STEPS + 1)[1:] for a, b in legs(scene.load.opening)]):
        u[0], correction = opening / 2, np.inf
        for _ in range(60):
            p, slope = traction(scene.interface, 2 * u[::2], largest)
            force = K @ u
            force[::2] += bonded * p
            if correction < 1e-9 * h:
                break
            springs = np.stack([2 * bonded * slope, 0 * slope], axis=1).ravel()
            tangent = (K + diags(springs)).tocsc()[1:, 1:]
            du = spsolve(tangent, force[1:])
            u[1:], correction = u[1:] - du, np.abs(du[1::2]).max()
        else:
            break
        largest = np.maximum(largest, 2 * u[::2])
        opened, loads = [*opened, opening], [*loads, force[0]]
        on_step({"opening": opening, "load": force[0]})
    status = "complete" if opened[-1] == scene.load.opening[-1] else f"stopped: no convergence at {opening:g}"
    steps = {"opening": np.array(opened), "load": np.array(loads)}
    return Result("springs", steps, status, dofs=u.size, elements=ELEMENTS)


solve.unsuitable = unsuitable


def legs(programme):
    """Beginning and end of every leg."""
    return zip((0.0, *programme), programme, strict=False)


def beam(L, bending, shear):
    """Stiffness of beam elements with shear, exact between their nodes (Przemieniecki 1968, eq. 5.116)."""
    f = 12 * bending / (shear * L**2)
    rows = [[12 + 0 * L, 6 * L, -12 + 0 * L, 6 * L], [6 * L, (4 + f) * L**2, -6 * L, (2 - f) * L**2]]
    rows += [[-12 + 0 * L, -6 * L, 12 + 0 * L, -6 * L], [6 * L, (2 - f) * L**2, -6 * L, (4 + f) * L**2]]
    values = np.array(rows) * bending / (L**3 * (1 + f))
    dofs = 2 * np.arange(L.size) + np.arange(4)[:, None]
    i, j = np.broadcast_to(dofs[:, None], values.shape), np.broadcast_to(dofs[None], values.shape)
    return coo_matrix((values.ravel(), (i.ravel(), j.ravel()))).tocsr()


def traction(law, gap, largest):
    """Traction and its slope: secant below the largest gap so far, softening beyond it, a penalty on closing."""
    g_u = 2 * law.toughness / law.strength
    g_max = g_u / law.ductility
    k = np.clip(np.maximum(gap, largest), g_max, g_u)
    secant = law.strength * (g_u - k) / (g_u - g_max) / k
    softens = (gap >= largest) & (gap > g_max) & (gap < g_u)
    slope = np.where(softens, -law.strength / (g_u - g_max), secant)
    return np.where(gap < 0, law.penalty, secant) * gap, np.where(gap < 0, law.penalty, slope)
