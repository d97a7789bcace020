"""The bodies and the interface at some steps of a run, for ParaView: `fields.pvd` and `interface.pvd` of its folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np

from iga.bases.names import BASES
from iga.mesh.bernstein import bernstein, tensor
from verify.fields.cells import Cells, grid, three_columns
from verify.fields.vtk_xml import Grid, write_collection, write_grid
from verify.scene.materials import plane_strain_constants
from verify.scene.schema import Scene

#: VTK_VERTEX and VTK_POLY_LINE of vtkCellType.h.
VERTEX, POLY_LINE = 1, 4

#: Part of the way between two frames by which a step that falls short of one is as good as there.
NEAR = 1e-6

#: Folder of the frames, beside the collections of them, and the two series.
FRAMES_FOLDER, SERIES = "frames", ("fields", "interface")


#: Makes a frame, see `iga.output.frames`; None on a rank that does not write.
Make = Callable[[], Mapping[str, Any] | None]


class Frames:
    """Writes a frame whenever the opening has gone another part of its way along the programme, and the last state.

    Called by a solver at every converged step, see `iga.run.OnFrame`. The collections are whole after every frame.

    Their time is the opening; where the opening goes down, it is how far it has gone in all, as time does not run back.

    Parameters
    ----------
    folder : of the run
    method : that of the solver; elements of a basis that is only continuous become Lagrange cells
    count : frames on the whole way, besides the first
    writes : whether this process does; under MPI all of them make frames, and one writes
    """

    def __init__(self, folder: Path, scene: Scene, method: str, count: int, writes: bool = True) -> None:
        way = (0.0, *scene.load.opening)
        self._part = sum(abs(b - a) for a, b in zip(way, way[1:], strict=False)) / count
        self._folder, self._writes = folder, writes
        self._through_bk = through_thickness(scene)
        self._in_nodes = method in BASES and not BASES[method].smooth
        self._opening, self._back, self._due = 0.0, 0.0, 0.0
        self._times: list[float] = []
        self._left: Make | None = None

    def __call__(self, opening: float, make: Make) -> None:
        self._back += max(self._opening - opening, 0.0)
        self._opening = opening
        self._left = make
        if self._time >= self._due - NEAR * self._part:
            self._due = self._part * (np.floor(self._time / self._part + NEAR) + 1.0)
            self._write(make)

    def finish(self) -> None:
        """Write the last state, if it has not been."""
        if self._left is not None:
            self._write(self._left)

    @property
    def _time(self) -> float:
        return self._opening + 2.0 * self._back

    def _write(self, make: Make) -> None:
        made, self._left = make(), None
        if made is None or not self._writes:
            return
        number, whole = len(self._times), {"TimeValue": self._time, "opening": made["opening"], "load": made["load"]}
        self._times.append(self._time)
        (self._folder / FRAMES_FOLDER).mkdir(parents=True, exist_ok=True)
        cells = [solid_cells(part, self._through_bk[part["body"]]) for part in made["cells"]]
        cells = [nodal(part) for part in cells] if self._in_nodes else cells
        grids = (grid(cells, whole), interface_grid(made["bond"], whole))
        for name, found in zip(SERIES, grids, strict=True):
            write_grid(self._folder / FRAMES_FOLDER / f"{name}_{number:04d}.vtu", found)
            files = ((time, f"{FRAMES_FOLDER}/{name}_{i:04d}.vtu") for i, time in enumerate(self._times))
            write_collection(self._folder / f"{name}.pvd", files)


def cleared(folder: Path) -> None:
    """Remove the frames of an earlier run."""
    for name in SERIES:
        for path in (folder / f"{name}.pvd", *(folder / FRAMES_FOLDER).glob(f"{name}_[0-9]*.vtu")):
            path.unlink(missing_ok=True)


def solid_cells(part: Mapping[str, Any], through_k: np.ndarray) -> Cells:
    """Elements with displacement, stress (xx, yy, zz, xy, yz, xz), its equivalent of von Mises, and the body's number.

    Parameters
    ----------
    part : as `iga.output.frames` and `fem_reference.output.frames` tell them; without weights they are Lagrange
        elements, and the stresses are those at their nodes.
    through_k : (2,) of this body, see `through_thickness`.
    """
    told = np.moveaxis(part["stress_eqv"], -1, 0)
    if len(told) == 3:  # in the plane
        told = np.stack([*told[:2], part["along_eqk"] @ through_k, told[2], *np.zeros((2, *told[2].shape))])
    xx, yy, zz, xy, yz, xz = told
    normal, shear = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2, xy**2 + yz**2 + xz**2
    values_eqf = np.stack([*told, np.sqrt(0.5 * normal + 3.0 * shear)], -1)
    degrees, X_ebI, u_ebi, w_eb = (part[name] for name in ("degrees", "X_ebI", "u_ebi", "w_eb"))
    if w_eb is not None:
        values_eqf = bezier_values(values_eqf, w_eb, degrees, part["points_q"])
    fields = {"displacement": u_ebi, "stress": values_eqf[..., :6], "von Mises stress": values_eqf[..., 6:]}
    return Cells(degrees, X_ebI, w_eb, fields, {"body": np.full(len(X_ebI), part["body"])})


def bezier_values(
    values_eqf: np.ndarray, w_eb: np.ndarray, degrees: tuple[int, ...], points_q: np.ndarray
) -> np.ndarray:
    """Bezier values (n_e, n_b, n_f) with the weights of the element that interpolate values at its n_b points."""
    B_qb = _bernstein(degrees, points_q)
    w_eq = w_eb @ B_qb.T
    return np.linalg.solve(B_qb, values_eqf * w_eq[..., None]) / w_eb[..., None]


def nodal(cells: Cells) -> Cells:
    """Polynomial Bezier elements as Lagrange elements: the values at evenly spaced nodes."""
    p, q = cells.degrees
    t, s = np.meshgrid(np.linspace(0.0, 1.0, q + 1), np.linspace(0.0, 1.0, p + 1), indexing="ij")
    B_nb = _bernstein(cells.degrees, np.stack([s.ravel(), t.ravel()], -1))
    fields = {name: B_nb @ values for name, values in cells.fields.items()}
    return Cells(cells.degrees, B_nb @ cells.X_ebI, None, fields, cells.of_cells)


def interface_grid(bond: Mapping[str, np.ndarray], whole: Mapping[str, float]) -> Grid:
    """A line along the interface through its quadrature points, on the face whose points these are; of a solid the
    points alone."""
    n, plane = len(bond["s_q"]), bond["X_qi"].shape[1] == 2
    names = ("distance", "gap", "traction", "damage", "history", "bonded")
    keys = ("s_q", "gap_q", "traction_q", "damage_q", "history_q", "bonded_q")
    sliding = {"slip": "slip_q", "shear traction": "shear_q"}  # where the bond slides
    known = {**dict(zip(names, keys, strict=True)), **{name: key for name, key in sliding.items() if key in bond}}
    values = {name: bond[key].astype(float) for name, key in known.items()}
    return Grid(
        points=three_columns(bond["X_qi"]),
        connectivity=np.arange(n),
        offsets=np.array([n]) if plane else np.arange(n) + 1,
        types=np.array([POLY_LINE]) if plane else np.full(n, VERTEX),
        point_data={"displacement": three_columns(bond["u_qi"]), **values},
        whole=whole,
    )


def through_thickness(scene: Scene) -> np.ndarray:
    """S_33 in parts of S_11 and S_22 along the axes of the material, for each body (2, 2); nothing in plane stress.

    In plane strain E_33 = 0: ``S_33 = nu12 E2 / E1 S_11 + nu23 S_22`` with E3 = E2, nu13 = nu12, and nu23 = nu12
    where it is left out.
    """
    if scene.specimen.plane == "stress":
        return np.zeros((2, 2))
    constants = map(plane_strain_constants, scene.materials)
    return np.array([[c["nu12"] * c["E2"] / c["E1"], c["nu23"]] for c in constants])


def _bernstein(degrees: tuple[int, ...], points_q: np.ndarray) -> np.ndarray:
    return reduce(tensor, map(bernstein, degrees, points_q.T))
