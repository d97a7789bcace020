"""What `debond export` writes is a mesh that a scene may name, with its groups."""

import numpy as np
import pytest

from verify.cli import main
from verify.export.mesh import merged, scene_mesh
from verify.meshes.read import read_mesh
from verify.methods.solve import solve
from verify.scene.load import load_scene


def test_an_exported_test_on_rollers_is_solved_as_the_built_in_one(tmp_path):
    coarse = ["dolfinx.elements=70", "dolfinx.layers=2", "load.opening=1.0"]
    overrides = [word for setting in coarse for word in ("--set", setting)]
    assert main(["export", "mmb50-as4peek", "--format", "gmsh", *overrides, "--out", str(tmp_path)]) == 0
    file = tmp_path / "mmb50-as4peek.msh"
    made = load_scene("mmb50-as4peek", coarse)
    nodes = read_mesh(file)
    loads = [np.unique(nodes.X_nI[nodes.nodes[f"upper_load_{i}"], 0])[[0, -1]] for i in (1, 2)]
    assert np.allclose(loads, [load.extent for load in made.specimen.loads if load.extent])
    groups = [f'specimen.mesh="{file}"', 'specimen.groups.bond="upper_bond"']
    given = solve(load_scene("mmb50-as4peek", [*coarse, *groups]), "lagrange")
    own = solve(made, "dolfinx")
    assert given.complete and given.load[-1] == pytest.approx(own.load[-1], rel=0.005)


@pytest.mark.parametrize("degree", [1, 2])
def test_cells_of_a_bond_are_the_bond_of_the_scene(degree, tmp_path):
    """Bodies of degree 2 have cells of degree 1 between them; where they are not on the bond, they are refused."""
    words = ["--elements", "40", "--set", f"dolfinx.degree={degree}", "--out", str(tmp_path)]
    assert main(["export", "dcb-czm1", "--format", "vtu", *words]) == 0
    found = read_mesh(tmp_path / "dcb-czm1.vtu")
    assert {size: len(conn) for size, conn in found.conn_kea.items()} == {4 * degree: 80}
    on_it = found.X_nI[found.nodes["COH2D4"]]
    assert np.all(on_it[:, 1] == 0.0) and (on_it[:, 0].min(), on_it[:, 0].max()) == (4.0, 14.0)
    words = [f"specimen.mesh='{tmp_path / 'dcb-czm1.vtu'}'", "specimen.precrack=2.909090909090909"]
    with pytest.raises(ValueError, match="group COH2D4: must lie on Y = 0 from X = 2.90909 to 14, got 4 to 14"):
        solve(load_scene("dcb-czm1", words), "lagrange")


@pytest.mark.parametrize("name", ["enf-as4peek", "slb"])
def test_cohesive_elements_of_abaqus_are_the_bond_of_the_scene(name, tmp_path):
    """Read as its faces, beside a point of reference as CAE writes it; elsewhere the file is of another specimen."""
    words = ["--elements", "60", "--layers", "1", "--out", str(tmp_path)]
    assert main(["export", name, "--format", "abaqus", *words]) == 0
    file = tmp_path / f"{name}.inp"
    file.write_text(file.read_text().replace("*ELEMENT", "*Node\n999999, 1., 2., 0.\n*ELEMENT", 1))
    coarse = ["load.opening=0.2", "dolfinx.elements=60", "dolfinx.layers=1"]
    given = solve(load_scene(name, [f'specimen.mesh="{file}"', *coarse]), "lagrange")
    assert given.load[-1] == pytest.approx(solve(load_scene(name, coarse), "dolfinx").load[-1], rel=0.005)
    head, bond = file.read_text().split("*ELEMENT, TYPE=COH2D4, ELSET=bond\n")
    file.write_text(f"{head}*ELEMENT, TYPE=COH2D4, ELSET=bond\n{bond.split(chr(10), 1)[1]}")
    with pytest.raises(ValueError, match="group COH2D4: must lie on Y = 0 from X = "):
        solve(load_scene(name, [f'specimen.mesh="{file}"', *coarse]), "lagrange")


@pytest.mark.parametrize("name", ["mmb50-as4peek", "moments", "slb"])
@pytest.mark.parametrize("degree", [1, 2])
def test_weights_are_those_of_unit_tractions(name, degree):
    """A rigid motion by 1 has the mean 1, a rotation by 1 the mean rotation 1; the faces of the precrack match."""
    scene = load_scene(name, [f"dolfinx.degree={degree}", "dolfinx.elements=70"])
    mesh = scene_mesh(scene)
    for faces, wanted in ((mesh.loaded, scene.specimen.loads), (mesh.resting, scene.specimen.supports)):
        for number, act in enumerate(wanted, 1):
            parts = [face for face in faces if face.name.endswith(f"_{number}")]
            assert len(parts) == (2 if act.body is None else 1)
            node_n, weight_n = (
                np.concatenate(each) for each in zip(*((p.node_n, p.weight_n) for p in parts), strict=True)
            )
            turned = -mesh.X_nI[node_n, 1] if act.couple else np.ones(len(node_n))
            assert weight_n @ turned == pytest.approx(1.0)
            assert {part.component for part in parts} == {0 if act.couple else 1}
    assert [face.factor for face in mesh.loaded] == [load.share for load in scene.specimen.loads]
    lower, upper = mesh.X_nI[mesh.crack_kb].transpose(1, 0, 2)
    assert np.array_equal(lower, upper) and np.ptp(lower[:, 0]) == pytest.approx(scene.specimen.tip)
    joined = merged(mesh)
    assert np.array_equal(joined.X_nI[joined.crack_kb[:, 0]], lower)
    assert len(np.unique(joined.crack_kb)) == 2 * len(lower) - 1, "the arms share the end of the precrack"
