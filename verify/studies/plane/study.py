"""Plane problems on meshes from CAD: patch test, errors against an exact field, convergence rates.

A mesh around a circle about the origin is solved as a part of an infinite plate with a hole (Kirsch 1898), any other
mesh with a smooth field. The tractions of the exact field act on the whole boundary. The first mesh is that of the
file, the others are its Bezier refinements (`iga.mesh.refinement`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from iga.elements.bulk import gradient
from iga.elements.elasticity import isotropic
from iga.elements.kinematics import small_stress
from iga.elements.plane_elasticity import no_rigid_motion, solve, stiffness, traction_forces
from iga.elements.shape_functions import block_basis, side_bases
from iga.files.iga_format import mesh as mesh_of
from iga.files.iga_reader import read_iga
from iga.mesh.boundary import boundary_chains
from iga.mesh.extraction import Mesh
from iga.mesh.quadrature import square
from iga.mesh.refinement import bezier_refined
from iga.mesh.soundness import UNITY, dependence, faults, missed_unity, unity_fault
from verify.studies.plane.errors import Errors, errors
from verify.support.refusal import Refusal
from verify.theory.plane_fields import PlaneField, kirsch, smooth, uniform
from verify.verdict import Check

SOLID: Mapping[str, Any] = {"young": 1.0, "poisson": 0.3, "plane": "stress"}
_GRID = 7  # sampling points per direction of an element


@dataclass(frozen=True)
class Limits:
    """Size of the study, and tolerances of its checks.

    cuts, unknowns : largest numbers of refinements and of unknowns
    patch : error of the patch test, which is rounding
    error : relative L2 error of the displacement on the finest mesh
    rate, settled : difference to the expected rate; difference of the last two rates up to which the last is checked
    growth : relative growth of the error in energy on nested spaces, which is rounding
    """

    cuts: int = 3
    unknowns: int = 100_000
    patch: float = 1e-10
    error: float = 1e-3
    rate: float = 0.25
    settled: float = 0.25
    growth: float = 1e-6


PLANE_LIMITS = Limits()


@dataclass(frozen=True, eq=False)
class Plate:
    """A body from a file; the chains ``boundary-0``, ... are its whole boundary."""

    name: str
    mesh: Mesh
    hole: float | None  # radius of a hole about the origin

    @property
    def boundary(self) -> list:
        return [chain for name, chain in self.mesh.chains.items() if name.startswith(_BOUNDARY)]


@dataclass(frozen=True)
class Level:
    """One mesh of the sequence; the rates are those from the previous mesh, NaN where that has other functions."""

    name: str
    elements: int
    unknowns: int
    errors: Errors
    rate: float
    energy_rate: float


@dataclass(frozen=True, eq=False)
class PlaneStudy:
    """Results of one file; at the points ``X_euvi`` (n_e, m, m, 2) numerical and exact stress xx (n_e, m, m)."""

    name: str
    problem: str
    order: int  # expected order in L2 of the refinements
    patch: Errors
    levels: tuple[Level, ...]
    X_euvi: np.ndarray
    found_euv: np.ndarray
    exact_euv: np.ndarray
    checks: tuple[Check, ...]


def load_plate(source: str) -> Plate:
    """Read an `.iga` file.

    Raises
    ------
    Refusal : the file cannot be read, is malformed, or holds no plane mesh that a solver can use.
    """
    path = Path(source)
    try:
        mesh = mesh_of(read_iga(path))
        stiffness(mesh, isotropic(**SOLID))  # refuses elements with a negative Jacobian
        if unsound := (*faults(mesh), *dependence(mesh)):
            raise ValueError("; ".join([*unsound, *unity_fault(mesh)]))
        chains = {f"{_BOUNDARY}{i}": chain for i, chain in enumerate(boundary_chains(mesh))}
        mesh = replace(mesh, chains=chains)
        return Plate(path.stem, mesh, _hole(mesh))
    except OSError as error:
        raise Refusal(f"SCENE: must be a file that can be read, got {source!r}: {error.strerror}") from None
    except ValueError as error:
        text = str(error)
        raise Refusal(text if text.startswith(source) else f"{source}: {text}") from None


def study(plate: Plate) -> PlaneStudy:
    """Solve the patch test and the sequence of meshes; a few seconds."""
    field, problem = _field(plate)
    u_Ai = _solved(plate.mesh, plate.boundary, field)
    levels = tuple(_levels(plate, field))
    constant = uniform(1.0, -0.4, 0.3, **SOLID)
    patch = _errors(plate.mesh, _solved(plate.mesh, plate.boundary, constant), constant)
    order = max(max(block.degrees) for block in plate.mesh.blocks) + 1
    X, found, exact = _sampled(plate.mesh, u_Ai, field)
    checks = (_unity(plate), *_checks(plate.name, patch, levels, order))
    return PlaneStudy(plate.name, problem, order, patch, levels, X, found, exact, checks)


def settled(levels: tuple[Level, ...]) -> bool:
    """Whether the last two rates agree, so that the last one is asymptotic."""
    rates = [level.rate for level in levels[-2:]]
    return len(rates) == 2 and abs(rates[1] - rates[0]) <= PLANE_LIMITS.settled


def lines(found: PlaneStudy) -> list[str]:
    """The table of errors in plain text."""
    head = f"{found.name}: {found.problem}"
    rows = [
        f"  {level.name:22} {level.unknowns:7} unknowns  L2 {level.errors.displacement:.2e}  energy "
        f"{level.errors.energy:.2e}"
        + ("" if np.isnan(level.rate) else f"  rates {level.rate:.2f} {level.energy_rate:.2f}")
        for level in found.levels
    ]
    return [head, *rows]


_BOUNDARY = "boundary-"


def _hole(mesh: Mesh) -> float | None:
    """Radius of a circle about the origin that has whole sides on it and the body outside; None without one."""
    sides = side_bases(mesh, list(mesh.chains.values()), 2)
    radius = min(float(np.linalg.norm(side.X_eqI, axis=-1).min()) for side in sides)
    for side in sides:
        on_e = np.all(np.linalg.norm(side.X_eqI, axis=-1) <= radius * (1.0 + 1e-9), axis=1)
        inwards_e = np.all(np.sum(side.X_eqI * side.n_eqI, axis=-1) < 0.0, axis=1)
        if radius > 0.0 and np.any(on_e & inwards_e):
            return radius
    return None


def _field(plate: Plate) -> tuple[PlaneField, str]:
    if plate.hole is not None:
        text = f"piece of an infinite plate in tension along x, with a hole of radius {plate.hole:.6g} (Kirsch 1898)"
        return kirsch(plate.hole, 1.0, **SOLID), text
    low, high = plate.mesh.P_AI.min(0), plate.mesh.P_AI.max(0)
    centre, size = complex(*(0.5 * (low + high))), float(np.max(high - low))
    return smooth(centre, size, 1.0, **SOLID), "smooth field without body force (exponential and sine potentials)"


def _levels(plate: Plate, field: PlaneField) -> Iterator[Level]:
    """The mesh of the file, its Bezier elements with shared control points, and these halved repeatedly."""
    mesh, last = plate.mesh, (float("nan"),) * 2
    for cuts in range(-1, PLANE_LIMITS.cuts):
        if cuts >= 0:
            mesh = bezier_refined(mesh, 0 if cuts == 0 else 1)
        boundary = replace(plate, mesh=mesh).boundary
        found = _errors(mesh, _solved(mesh, boundary, field), field)
        here = found.displacement, found.energy
        rates = [float(np.log2(a / b)) if cuts > 0 else float("nan") for a, b in zip(last, here, strict=True)]
        name = "the file" if cuts < 0 else "Bezier elements" if cuts == 0 else f"each cut into {4**cuts}"
        yield Level(name, mesh.elements, 2 * len(mesh.P_AI), found, *rates)
        last = here
        p = max(max(block.degrees) for block in mesh.blocks)
        if 2 * (2 if cuts >= 0 else 1) ** 2 * mesh.elements * p**2 > PLANE_LIMITS.unknowns:
            return


def _checks(name: str, patch: Errors, levels: tuple[Level, ...], order: int) -> Iterator[Check]:
    worst = max(patch.displacement, patch.stress)
    yield Check("patch-test", name, worst, PLANE_LIMITS.patch, "exact", "A constant stress is found exactly.")
    energy = np.array([level.errors.energy for level in levels])
    growth = float(np.max(np.append(energy[1:] / energy[:-1] - 1.0, 0.0)))
    meaning = "The spaces are nested: the error in energy never grows."
    yield Check("nested-energy", name, growth, PLANE_LIMITS.growth, "exact", meaning)
    finest = levels[-1].errors.displacement
    meaning = "Displacement on the finest mesh against the exact field, relative L2."
    yield Check("exact-field", name, finest, PLANE_LIMITS.error, "analytical", meaning)
    if settled(levels):
        meaning = "The rate in L2 under refinement is p + 1."
        yield Check("rate", name, levels[-1].rate - order, PLANE_LIMITS.rate, "analytical", meaning)


def _unity(plate: Plate) -> Check:
    meaning = "The functions of the file add up to 1: tolerance for the digits of a file."
    return Check("sum-of-functions", plate.name, missed_unity(plate.mesh), UNITY, "exact", meaning)


def _solved(mesh: Mesh, boundary: list, field: PlaneField) -> np.ndarray:
    f_Ai = traction_forces(mesh, boundary, field.traction)
    return solve(stiffness(mesh, isotropic(**SOLID)), f_Ai, no_rigid_motion(mesh))


def _errors(mesh: Mesh, u_Ai: np.ndarray, field: PlaneField) -> Errors:
    return errors(mesh, isotropic(**SOLID), u_Ai, field, up_to_rigid=True)


def _sampled(mesh: Mesh, u_Ai: np.ndarray, field: PlaneField) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, numerical and exact stress xx on a grid in every element, off its sides, where maps may degenerate."""
    at, ones = np.linspace(1e-4, 1.0 - 1e-4, _GRID), np.ones(_GRID)
    X, found = [], []
    for block in mesh.blocks:
        basis = block_basis(mesh, block, *square((at, ones), (at, ones)))
        X.append(basis.X_eqI)
        found.append(small_stress(isotropic(**SOLID), gradient(basis, u_Ai))[0][0, 0])
    X_euvi = np.concatenate(X).reshape(-1, _GRID, _GRID, 2)
    return X_euvi, np.concatenate(found).reshape(X_euvi.shape[:3]), field.stress(X_euvi)[..., 0, 0]
