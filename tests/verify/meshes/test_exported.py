"""What `debond export` writes is a mesh that a scene may name, with its groups."""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.cli import main
from verify.export.groups import GROUP_FILES
from verify.meshes.read import read_mesh
from verify.methods.solve import solve
from verify.scene.load import load_scene

SHORT = ["load.opening=0.2"]


@pytest.mark.parametrize("merged", [False, True])
@pytest.mark.parametrize("kind", GROUP_FILES)
def test_an_exported_mesh_is_solved_as_the_built_in_one(kind: str, merged: bool, tmp_path: Path) -> None:
    words = ["--elements", "40", "--out", str(tmp_path), *["--merged"] * merged]
    assert main(["export", "dcb-czm1", "--format", kind, *words]) == 0
    file = tmp_path / f"dcb-czm1.{GROUP_FILES[kind].ending}"
    assert {name: len(elements) for name, elements in read_mesh(file).elements.items()} == {"upper": 40, "lower": 40}
    group = "bond" if merged else "upper_bond"
    scene = load_scene("dcb-czm1", [f'specimen.mesh="{file}"', f'specimen.groups.bond="{group}"', *SHORT])
    given = solve(scene, "lagrange")
    made = solve(load_scene("dcb-czm1", ["discretization.degree=2", "discretization.dofs=960", *SHORT]), "lagrange")
    assert given.complete and given.load.max() == pytest.approx(made.load.max(), rel=0.01)
    missing = load_scene("dcb-czm1", [f'specimen.mesh="{file}"', 'specimen.groups.bond="none"', *SHORT])
    with pytest.raises(ValueError, match=r"group none \(specimen.groups.bond\) is missing, the file has .*bond"):
        solve(missing, "lagrange")
