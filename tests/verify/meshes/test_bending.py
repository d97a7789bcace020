"""Mesh files of specimens on rollers: the curve is that of the meshes that are made; groups lie on the patches."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from verify.methods.solve import prepare, solve
from verify.scene.load import load_scene
from verify.scene.parse import SceneError
from verify.scene.schema import Scene

#: A coarse test with a short programme, of one row of points a mesh.
COARSE = {
    "enf-as4peek": ["dolfinx.elements=70", "dolfinx.layers=2", "dolfinx.degree=2", "load.opening=1.0"],
    "mmb50-as4peek": ["dolfinx.elements=70", "dolfinx.layers=2", "dolfinx.degree=2", "load.opening=1.0"],
}


def lines(name: str) -> np.ndarray:
    """Element boundaries along the specimen, at the ends of all rollers."""
    return np.asarray(prepare(load_scene(name, COARSE[name]), "dolfinx").problem.specimen().X)


def arm(X: np.ndarray, Y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 3) and elements of 9 nodes between these lines."""
    x, y = (np.sort(np.concatenate([line, (line[1:] + line[:-1]) / 2])) for line in (X, Y))
    points = np.stack([*(g.ravel() for g in np.meshgrid(x, y)), np.zeros(x.size * y.size)], axis=1)
    n = len(x)
    first = (2 * n * np.arange(len(Y) - 1)[:, None] + 2 * np.arange(len(X) - 1)).ravel()
    shape = [0, 2, 2 * n + 2, 2 * n, 1, n + 2, 2 * n + 1, n, n + 1]
    return points, first[:, None] + shape


def written(scene: Scene, X: np.ndarray, path: Path, **groups: tuple[float, float, float]) -> Path:
    """A mesh of both arms on the lines ``X``; groups of nodes are flags at (lowest X, highest X, Y)."""
    above, below = scene.specimen.thicknesses
    upper, conn = arm(X, np.array([0.0, 0.4, 1.0]) * above)
    lower, under = arm(X, -np.array([1.0, 0.4, 0.0]) * below)
    points = np.concatenate([upper, lower])
    x, y = points[:, 0], points[:, 1]
    flags = {
        name: ((x > low - 1e-9) & (x < high + 1e-9) & (np.abs(y - at) < 1e-9)).astype(int)
        for name, (low, high, at) in groups.items()
    }
    meshio.Mesh(points, [("quad9", conn), ("quad9", under + len(upper))], point_data=flags).write(path)
    return path


@pytest.mark.parametrize(
    ("name", "method"),
    [
        pytest.param(name, method, marks=pytest.mark.slow if i == j else ())
        for i, name in enumerate(COARSE)
        for j, method in enumerate(("lagrange", "dolfinx"))
    ],
)
def test_the_curve_is_that_of_the_meshes_that_are_made(name, method, tmp_path):
    made = load_scene(name, [*COARSE[name], "discretization.degree=2"])
    file = written(made, lines(name), tmp_path / "arms.vtu")
    given = solve(load_scene(name, [*COARSE[name], f'specimen.mesh="{file}"']), method)
    own = solve(load_scene(name, COARSE[name]), "dolfinx")
    opening = np.linspace(0.0, 1.0, 50)
    load, other = (np.interp(opening, np.abs(run.opening), np.abs(run.load)) for run in (given, own))
    assert given.complete and np.abs(load - other).max() < 0.005 * other.max()


def test_groups_lie_on_the_rollers(tmp_path):
    scene = load_scene("enf-as4peek", COARSE["enf-as4peek"])
    ((low, high),) = (load.extent for load in scene.specimen.loads)
    top, bottom = scene.specimen.thicknesses[0], -scene.specimen.thicknesses[1]
    X, end = lines("enf-as4peek"), scene.specimen.lengths[0]
    held = (0.0, end, bottom)
    for k, (groups, wrong) in enumerate(
        [
            ({"load": (low, high, top)}, ""),
            ({"load": (low, high, bottom)}, "must have nodes of every load, got none on the top from X = 50.5 to 51.5"),
            ({"load": (low - 3.0, high, top)}, r"must have nodes on the top from X = 50.5 to 51.5 alone, got one at"),
            ({"support": held}, r"alone, got one at"),
            (
                {"support": (0.0, 0.5, bottom)},
                "must have nodes of every support, got none on the bottom from X = 101.5",
            ),
        ]
    ):
        file = written(scene, X, tmp_path / f"{k}.vtu", **groups)
        on_file = load_scene("enf-as4peek", [*COARSE["enf-as4peek"], f'specimen.mesh="{file}"', "load.opening=0.05"])
        if not wrong:
            assert solve(on_file, "lagrange").complete
            continue
        with pytest.raises(ValueError, match=wrong):
            prepare(on_file, "lagrange").mesh  # noqa: B018


def test_dolfinx_needs_corners_where_rollers_end(tmp_path):
    scene = load_scene("enf-as4peek", COARSE["enf-as4peek"])
    X = lines("enf-as4peek")
    inner = X[np.abs(X - 50.5) > 1e-9]
    file = written(scene, inner, tmp_path / "arms.vtu")
    on_file = load_scene("enf-as4peek", [*COARSE["enf-as4peek"], f'specimen.mesh="{file}"', "load.opening=0.05"])
    with pytest.raises(ValueError, match=r"must lie at X = 50\.5 on the top, where a roller ends, for dolfinx, got"):
        prepare(on_file, "dolfinx").problem  # noqa: B018
    assert solve(on_file, "lagrange").complete


def test_spline_files_are_for_arms_that_are_pulled_apart():
    with pytest.raises(
        SceneError, match=r"specimen\.mesh: must be a \.msh, \.inp, \.vtu, \.e or \.med file of both arms"
    ):
        load_scene("enf-as4peek", ['specimen.mesh="arch.iga"'])
