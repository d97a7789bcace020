"""Frames in VTK, which ParaView is made of: the geometry and the fields of the cells that it reads."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pyvista", exc_type=ImportError)  # VTK loads libraries of the machine

import pyvista as pv
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

from iga.elements.shape_functions import block_basis
from iga.mesh.bezier import homogeneous, jacobian
from iga.mesh.quadrature import gauss, square
from tests.verify.fields.test_cells import quarter_ring
from verify.fields.cells import write_vtu
from verify.fields.frames import Frames
from verify.methods.solve import prepare
from verify.scene.load import load_scene
from verify.scene.schema import Scene


def scene(*overrides: str, name: str = "dcb-czm1") -> Scene:
    coarse = ("load.opening=1.5", "discretization.dofs=400", "discretization.steps=20")
    return load_scene(name, [*coarse, *overrides])


CASES = {
    "nurbs": ("nurbs", scene("pose.angle=30")),
    "Lagrange": ("lagrange", scene("discretization.degree=4")),
}


@pytest.fixture(scope="module", params=CASES)
def run(request, tmp_path_factory):
    """Folder of the frames, method, and specimen and point of the last one."""
    method, scene = CASES[request.param]
    folder, kept = tmp_path_factory.mktemp("run"), []
    frames = Frames(folder, scene, method, 3)

    def on_frame(opening, make):
        frames(opening, make)
        kept[:] = make.args

    solver, problem = prepare(scene, method).problem
    assert solver.solve(problem, on_frame=on_frame).status == "complete"
    frames.finish()
    return folder, method, *kept


def last(folder: Path, name: str):
    """The last grid of a series as pyvista's reader of collections finds it."""
    reader = pv.get_reader(str(folder / f"{name}.pvd"))
    reader.set_active_time_value(reader.time_values[-1])
    (found,) = reader.read()
    return found


def evaluated(grid, cell: int, s: float, t: float, *more) -> np.ndarray:
    """A field, the last word, at parameters of a cell, by VTK's own shape functions."""
    *r, field = more
    element = grid.GetCell(cell)
    weights = [0.0] * element.GetNumberOfPoints()
    element.EvaluateLocation(reference(0), [s, t, *(r or [0.0])], [0.0] * 3, weights)
    ids = [element.GetPointIds().GetId(i) for i in range(len(weights))]
    return weights @ np.asarray(grid.point_data[field])[ids]


def test_deformed_bodies_are_what_the_solver_deformed(run):
    """Warp By Vector and what VTK draws of it, against Gauss quadrature of the deformed elements."""
    folder, _, specimen, point = run
    warped = last(folder, "fields").warp_by_vector("displacement")
    area = 0.0
    for body in specimen.bodies:
        x_Ai = body.mesh.P_AI + point.state.u_d.reshape(-1, 2)[body.points]
        for block in body.mesh.blocks:
            points_q, weights_q = square(gauss(5), gauss(5))
            H_ebI = homogeneous(x_Ai, body.mesh.w_A, block)
            area += float(np.sum(jacobian(H_ebI, block.degrees, points_q) * weights_q))
    assert drawn_area(warped) == pytest.approx(area, rel=1e-6)


def test_a_solid_is_made_of_hexahedra(tmp_path):
    """Its place, displacement and stress, by VTK's own functions."""
    coarse = ("specimen.length=60", "specimen.width=6", "discretization.in_a_zone=1", "discretization.elements_width=2")
    solid, kept = load_scene("dcb-solid-cfrp", [*coarse, "load.opening=0.5", "discretization.degree=2"]), []
    frames = Frames(tmp_path, solid, "nurbs", 1)
    solver, problem = prepare(solid, "nurbs").problem
    assert solver.solve(problem, on_frame=lambda opening, make: kept.append((opening, make))).status == "complete"
    frames(*kept[-1])
    specimen, point = kept[-1][1].args
    grid, (body,) = last(tmp_path, "fields"), specimen.bodies
    assert {grid.GetCell(i).GetClassName() for i in range(grid.n_cells)} == {"vtkBezierHexahedron"}
    assert np.array(grid.bounds) == pytest.approx([0.0, 60.0, 0.0, 1.5, 0.0, 3.0])
    places_qk, u_Ai = np.random.default_rng(3).random((3, 3)), point.state.u_d.reshape(-1, 3)
    basis = block_basis(body.mesh, body.mesh.blocks[0], places_qk, np.ones(3))
    for e in (0, grid.n_cells // 2, grid.n_cells - 1):
        for q, place_k in enumerate(places_qk):
            u_i = basis.N_eqa[e, q] @ u_Ai[basis.conn_ea[e]]
            assert evaluated(grid, e, *place_k, "displacement") == pytest.approx(u_i, abs=1e-9)
    assert np.abs(grid.point_data["displacement"]).max() == pytest.approx(0.25, rel=0.01)
    bond = last(tmp_path, "interface")
    assert bond.n_cells == bond.n_points == specimen.system.interface.points
    # by hand from the strain of an edge: an arm of E bent to d / 2 has 1.5 E h d / (2 a^2) at its clamped end
    bent = grid.point_data["stress"][:, 0]
    assert np.abs(bent).max() == pytest.approx(1.5 * 130e3 * 1.5 * 0.25 / 50.0**2, rel=0.2)


def surface(grid, level: int):
    """The grid in triangles, as ParaView draws it at this nonlinear subdivision level."""
    drawn = vtkDataSetSurfaceFilter()
    drawn.SetInputData(grid)
    drawn.SetNonlinearSubdivisionLevel(level)
    drawn.Update()
    return pv.wrap(drawn.GetOutput())


def drawn_area(grid) -> float:
    """Area of the triangles, with the length of their sides taken to nothing (Richardson)."""
    coarse, middle, fine = (surface(grid, level).area for level in (3, 4, 5))
    once, again = (4.0 * middle - coarse) / 3.0, (4.0 * fine - middle) / 3.0
    return (16.0 * again - once) / 15.0


def test_rational_edges_are_round(tmp_path):
    """A ring, and the ring that a displacement makes of it: points of the drawn edges lie on their circles."""
    ring = quarter_ring()
    write_vtu(ring, tmp_path / "ring.vtu", {"displacement": 2.0 * ring.P_AI})
    grid = pv.read(tmp_path / "ring.vtu")
    for bodies, factor in ((grid, 1.0), (grid.warp_by_vector("displacement"), 3.0)):
        edge = surface(bodies, 4).extract_feature_edges(
            boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
        )
        x, y = edge.points[:, 0] / factor, edge.points[:, 1] / factor
        inside = np.minimum(x, y) > 1e-6  # the straight edges lie on the axes
        r = np.hypot(x, y)[inside]
        assert len(r) > 20 and np.minimum(np.abs(r - 1.0), np.abs(r - 2.0)).max() < 1e-6
        assert drawn_area(bodies) == pytest.approx(0.75 * np.pi * factor**2, rel=1e-6)
