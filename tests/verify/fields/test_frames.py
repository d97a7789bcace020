"""Frames for ParaView: which ones are written, and that they say what the solver has found."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from iga_files import real
from vtu_files import arrays

from iga.delamination.meshes import drawn
from iga.elements.bulk import gradient
from iga.elements.shape_functions import block_basis
from iga.files.cad_body import body_mesh
from iga.interface.surface import surface
from iga.mesh.bernstein import bernstein, tensor
from verify.cli import main, parser
from verify.fields.cells import vtk_order
from verify.fields.frames import Frames, bezier_values, cleared, solid_cells, through_thickness
from verify.methods.solve import prepare
from verify.result import Result, steps_from_rows
from verify.runs.jobs import Job
from verify.runs.run import Keep, run
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene

ORTHOTROPIC = {"E1": 140e3, "E2": 10e3, "G12": 5e3, "nu12": 0.3}
PEEL = {
    "name": "peel",
    "units": "N, mm, MPa",
    "specimen": {
        "kind": "peel", "strip_length": 60.0, "strip_thickness": 2.0, "substrate_length": 45.0,
        "substrate_thickness": 6.0, "bond_length": 30.0, "plane": "strain",
    },
    "strip": ORTHOTROPIC,
    "substrate": {"young": 5e3, "poisson": 0.3},
    "interface": {"strength": 6.0, "toughness": 0.1, "ductility": 10.0, "penalty": 1e3},
    "load": {"opening": [0.6, 0.3]},
    "discretization": {"dofs": 500, "steps": 6},
}  # fmt: skip


def dcb(*overrides: str, name: str = "dcb-czm1") -> Scene:
    coarse = ("load.opening=0.6", "discretization.dofs=280", "discretization.steps=8")
    return load_scene(name, [*coarse, *overrides])


def nothing_but(opening: float) -> dict:
    """A frame of one cell and two points of an interface, in which nothing moves."""
    X_bI = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])[None]
    cell = {
        "body": 0, "degrees": (1, 1), "X_ebI": X_bI, "u_ebi": 0.0 * X_bI, "w_eb": None,
        "stress_eqv": np.zeros((1, 4, 3)), "along_eqk": np.zeros((1, 4, 2)),
    }  # fmt: skip
    names = ("s_q", "gap_q", "traction_q", "damage_q", "history_q")
    bond = {"X_qi": X_bI[0, :2], "u_qi": np.zeros((2, 2)), "bonded_q": np.ones(2, dtype=bool)}
    return {"opening": opening, "load": 0.0, "cells": [cell], "bond": bond | dict.fromkeys(names, np.zeros(2))}


def series(folder: Path, name: str = "fields") -> list[tuple[float, Path]]:
    """Times and files of a collection."""
    sets = ElementTree.parse(folder / f"{name}.pvd").getroot().iter("DataSet")
    return [(float(one.get("timestep")), folder / one.get("file")) for one in sets]


def filmed(folder: Path, openings: list[float], count: int, **programme) -> list[float]:
    """Times of the frames of a path that goes through these openings."""
    frames = Frames(folder, dcb(*(f"load.{key}={value}" for key, value in programme.items())), "nurbs", count)
    for opening in openings:
        frames(opening, lambda opening=opening: nothing_but(opening))
    frames.finish()
    times = [time for time, _ in series(folder)]
    assert times == [time for time, _ in series(folder, "interface")] == sorted(set(times))
    return times


def test_frames_are_spread_over_the_programme(tmp_path):
    """One where each tenth of the way has been gone, the first and the last; never one twice."""
    openings = np.linspace(0.0, 0.6, 37)
    assert filmed(tmp_path, openings, 10) == pytest.approx(openings[[0, *np.ceil(3.6 * np.arange(1, 11)).astype(int)]])
    assert len(filmed(tmp_path / "few", [0.0, 0.3, 0.6], 10)) == 3
    assert filmed(tmp_path / "cut", [0.0, 0.1, 0.2, 0.25], 3) == [0.0, 0.2, 0.25]


def test_time_goes_on_where_the_opening_goes_back(tmp_path):
    path = [0.0, 0.3, 0.6, 0.45, 0.2, 0.5, 0.9]
    times = filmed(tmp_path, path, 100, opening=[0.6, 0.2, 0.9])
    assert times == pytest.approx([0.0, 0.3, 0.6, 0.75, 1.0, 1.3, 1.7])
    told = [arrays(file)[0] for _, file in series(tmp_path)]
    assert [found["opening"][0, 0] for found in told] == path
    assert [found["TimeValue"][0, 0] for found in told] == times


def test_files_are_whole_at_any_time(tmp_path):
    """After every frame the collections name what is there, and nothing half written lies about."""
    frames = Frames(tmp_path, dcb(), "nurbs", 6)
    for number, opening in enumerate((0.0, 0.1, 0.2, 0.3)):
        frames(opening, lambda: nothing_but(0.0))
        for name in ("fields", "interface"):
            files = [file for _, file in series(tmp_path, name)]
            assert len(files) == number + 1 and all(file.exists() for file in files)
    assert sorted(path.name.split("_")[0] for path in tmp_path.rglob("*.vtu")) == 4 * ["fields"] + 4 * ["interface"]
    (tmp_path / "frames" / "mine.vtu").touch()
    cleared(tmp_path)
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["mine.vtu"]


@dataclass
class Watched:
    """Frames that remember what the solver had where one was written."""

    frames: Frames
    written: list

    def __call__(self, opening, make):
        before = len(self.frames._times)
        self.frames(opening, make)
        if len(self.frames._times) > before:
            self.written.append(make.args)


CASES = {
    "nurbs": ("nurbs", dcb()),
    "turned half": ("nurbs", dcb("effects.symmetry=true", "pose.angle=30", "pose.mirror=true", name="dcb-czm1-linear")),
    "Lagrange": ("lagrange", dcb("discretization.degree=2", "effects.kinematics='linear'", "specimen.plane='strain'")),
    "adaptive": ("tspline", dcb("discretization.adaptive=true", "discretization.dofs=400", "load.opening=1.4")),
    "peel": ("tspline", parse_scene(PEEL, [])),
}


def rational(problem):
    """The problem on arms whose weights change through them: the same rectangles, in rational functions."""
    meshes = drawn(problem).meshes
    return replace(problem, meshes=tuple(replace(m, w_A=1.0 + 2.0 * np.abs(m.P_AI[:, 1])) for m in meshes))


def unstructured() -> Scene:
    """Two squares of a file with extraordinary points, one on the other."""
    path = real("square_unstructured")
    body = body_mesh(path)
    ends = surface(body, body.chains["bottom"], 0).bezier_points(body.P_AI)[:, 0, 0]
    tip = float(ends[np.argmin(np.abs(ends - 0.5))])
    shape = ("specimen.length=1.0", "specimen.arm_thickness=1.0", f"specimen.precrack={tip}", "discretization.steps=4")
    return dcb(f"specimen.mesh=['{path}']", *shape, "load.opening=2e-4", "interface.strength=40.0")


@pytest.mark.parametrize("case", [*CASES, "rational", "unstructured"])
def test_files_say_what_the_solver_found(case, tmp_path):
    method, scene = CASES[case] if case in CASES else ("tspline", unstructured() if case == "unstructured" else dcb())
    watched = Watched(Frames(tmp_path, scene, method, 4), [])
    solver, problem = prepare(scene, method).problem
    solution = solver.solve(rational(problem) if case == "rational" else problem, on_frame=watched)
    assert solution.status == "complete" and len(watched.written) >= 4
    for (_, file), (specimen, point) in zip(series(tmp_path), watched.written, strict=True):
        found, _ = arrays(file)
        assert found["opening"][0, 0] == point.opening and found["load"][0, 0] == point.state.load
        assert set(found["types"].ravel().tolist()) == {70 if method == "lagrange" else 77}
        assert found["body"].ravel().tolist() == [
            number for number, mesh in enumerate(specimen.meshes) for _ in range(mesh.elements)
        ]
        # elsewhere all are one; the file of the plug-in has them so to its last digits
        assert ("RationalWeights" in found) == (case in ("rational", "unstructured"))
        first = 0
        for body in specimen.bodies:
            u_Ai = point.state.u_d.reshape(-1, 2)[body.points]
            for block in body.mesh.blocks:
                first = compared(found, first, body, block, u_Ai, specimen.system.bulk.kinematics, method, scene)
        assert first == len(found["offsets"])
    if case == "adaptive":
        assert len({specimen.meshes[0].elements for specimen, _ in watched.written}) > 1
    for (_, file), (specimen, point) in zip(series(tmp_path, "interface"), watched.written, strict=True):
        interface_compared(arrays(file)[0], specimen, point)


def compared(found, first, body, block, u_Ai, kinematics, method, scene) -> int:
    """Hold a block of elements against the solver's own functions at points; the number of the next cell."""
    p, q = block.degrees
    n_e, n_b = len(block.conn_ea), (p + 1) * (q + 1)
    assert np.all(found["HigherOrderDegrees"][first : first + n_e] == [p, q, 0])
    start = 0 if first == 0 else found["offsets"][first - 1, 0]
    rows = slice(start, start + n_b * n_e)
    s, t = np.meshgrid(np.linspace(0.0, 1.0, p + 1), np.linspace(0.0, 1.0, q + 1))
    points_q = np.stack([s.ravel(), t.ravel()], -1)
    basis = block_basis(body.mesh, block, points_q, np.ones(n_b))
    if method == "lagrange":
        shape_qb = np.eye(n_b)[:, vtk_order((p, q))]
    else:
        shape_qb = tensor(bernstein(p, points_q[:, 0]), bernstein(q, points_q[:, 1]))[:, vtk_order((p, q))]

    w_eb = found["RationalWeights"][rows].reshape(n_e, n_b) if "RationalWeights" in found else np.ones((n_e, n_b))

    def at_points(name):
        values_eqk = shape_qb @ (found[name][rows].reshape(n_e, n_b, -1) * w_eb[..., None])
        return values_eqk / (w_eb @ shape_qb.T)[..., None]

    size = np.abs(body.mesh.P_AI).max()
    assert np.abs(at_points("Points")[..., :2] - basis.X_eqI).max() < 1e-13 * size
    u_eqi = np.einsum("eqa,eai->eqi", basis.N_eqa, u_Ai[basis.conn_ea])
    assert np.abs(at_points("displacement")[..., :2] - u_eqi).max() < 1e-12 * max(np.abs(u_eqi).max(), 1e-3)
    sigma = kinematics.cauchy(body.D, gradient(basis, u_Ai))
    stress, largest = at_points("stress"), max(np.abs(sigma).max(), 1e-3)
    # linear: the stress is a polynomial of the element; finite: nearly one
    near = (1e-11 if kinematics.linear else 0.02) * largest
    for component, (i, j) in ((0, (0, 0)), (1, (1, 1)), (3, (0, 1))):
        assert np.abs(stress[..., component] - sigma[i, j]).max() < near
    if scene.specimen.plane == "stress":
        assert np.all(stress[..., [2, 4, 5]] == 0.0)
    if method == "lagrange":
        assert stress[..., 2] == pytest.approx(0.2 * (stress[..., 0] + stress[..., 1]), abs=1e-11 * largest)
    return first + n_e


def interface_compared(found, specimen, point):
    """Quadrature points, in order along the specimen, with what the solver has there."""
    interface, order = specimen.system.interface, np.argsort(specimen.distance(specimen.system.interface.X_qi))
    assert found["types"].tolist() == [[4]] and found["offsets"].tolist() == [[interface.points]]
    assert np.all(np.diff(found["distance"].ravel()) > 0)
    assert np.array_equal(found["Points"][:, :2], interface.X_qi[order])
    assert np.array_equal(found["gap"].ravel(), point.response.contact.g_q[order])
    assert np.array_equal(found["traction"].ravel(), point.response.p_q[order])
    assert np.array_equal(found["history"].ravel(), point.state.k_q[order])
    damage = np.where(found["bonded"].ravel() > 0.0, interface.law.damage(point.state.k_q[order]), 1.0)
    assert np.array_equal(found["damage"].ravel(), damage)
    u_qi = np.einsum("qa,qai->qi", interface.N_qa, point.state.u_d.reshape(-1, 2)[interface.conn_qa])
    assert found["displacement"][:, :2] == pytest.approx(u_qi[order], abs=1e-13)


def test_values_are_met_with_any_weights():
    """Bezier values of a rational element give the values that they are made of, and a constant gives itself."""
    rng = np.random.default_rng(3)
    points_q, w_eb = rng.random((12, 2)), 0.5 + rng.random((5, 12))
    values_eqf = rng.normal(size=(5, 12, 2))
    values_eqf[..., 1] = 4.0
    c_ebf = bezier_values(values_eqf, w_eb, (2, 3), points_q)
    B_qb = tensor(bernstein(2, points_q[:, 0]), bernstein(3, points_q[:, 1]))
    again = np.einsum("qb,eb,ebf->eqf", B_qb, w_eb, c_ebf) / (w_eb @ B_qb.T)[..., None]
    assert again == pytest.approx(values_eqf, abs=1e-9)
    assert c_ebf[..., 1] == pytest.approx(4.0, abs=1e-9)


def test_thickness_does_not_change_in_plane_strain():
    """With the stress through the thickness, the strain of the solid there is zero: E3 = E2, nu13 = nu23 = nu12."""
    scene = parse_scene(PEEL, [])
    strip, substrate = through_thickness(scene)
    E1, E2, nu = ORTHOTROPIC["E1"], ORTHOTROPIC["E2"], ORTHOTROPIC["nu12"]
    S_1, S_2 = 100.0, -7.0
    assert -nu / E1 * S_1 - nu / E2 * S_2 + (strip @ [S_1, S_2]) / E2 == pytest.approx(0.0, abs=1e-12)
    assert substrate == pytest.approx([0.3, 0.3])
    assert np.all(through_thickness(dcb()) == 0.0)


def test_equivalent_stress():
    """Uniaxial tension, pure shear, and tension with the thickness held: sigma sqrt(1 - nu + nu^2)."""
    part = nothing_but(0.0)["cells"][0] | {
        "stress_eqv": np.array([[(5.0, 0.0, 0.0), (0.0, 0.0, 2.0), (5.0, 5.0, 0.0), (5.0, 0.0, 0.0)]]),
        "along_eqk": np.array([[(0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (5.0, 0.0)]]),
    }
    fields = solid_cells(part, np.array([0.3, 0.3])).fields
    expected = [5.0, 2.0 * np.sqrt(3.0), 5.0, 5.0 * np.sqrt(1 - 0.3 + 0.09)]
    assert fields["von Mises stress"][0, :, 0] == pytest.approx(expected)
    assert fields["stress"][0, 3].tolist() == [5.0, 0.0, 1.5, 0.0, 0.0, 0.0]


def stub(scene, method, on_step, on_frame=None):
    """A solver that comes to opening 0.3 and stops."""
    rows = [dict.fromkeys(("opening", "load", "newton_iterations"), d) for d in (0.0, 0.3)]
    for row in rows:
        if on_frame is not None:
            on_frame(row["opening"], lambda row=row: nothing_but(row["opening"]))
    return Result(method, steps_from_rows(rows), status="stopped: here")


def test_a_run_leaves_the_frames_that_are_asked_for(tmp_path, monkeypatch):
    monkeypatch.setattr("verify.runs.run.checks_of", lambda *_: ())
    run(prepare(dcb(), "nurbs"), tmp_path, solver=stub, keep=Keep(frames=1))
    assert [time for time, _ in series(tmp_path)] == [0.0, 0.3]  # the last state as well, though it came short
    run(prepare(dcb(), "nurbs"), tmp_path, solver=stub)
    assert not list(tmp_path.rglob("*.pvd")) and not list(tmp_path.rglob("*.vtu"))


def test_studies_ask_for_none():
    words = Job("dcb-czm1", dcb(), "nurbs", "nurbs").command(Path())
    assert "--fields" in words and parser().parse_args(words).frames == 0
    assert parser().parse_args(["solve", "dcb-czm1", "--fields"]).frames == 30


def test_a_method_without_bodies_says_that_it_has_no_frames(tmp_path, capsys):
    assert main(["solve", "dcb-czm1-linear", "--method", "lefm", "--fields", "--out", str(tmp_path)]) == 0
    assert "--fields: the method lefm has no bodies to draw" in "".join(capsys.readouterr())
    assert not list(tmp_path.rglob("*.pvd"))


@pytest.mark.parametrize("value", ["-1", "2.5", "many"])
def test_frames_are_counted(value, capsys):
    with pytest.raises(SystemExit) as stopped:
        parser().parse_args(["solve", "dcb-czm1", "--fields", f"--frames={value}"])
    assert stopped.value.code == 2
    assert f"argument --frames: must be an integer >= 0, got '{value}'" in capsys.readouterr().err
