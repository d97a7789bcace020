"""Every method against an independent fine-mesh computation, and the identities that NURBS must keep at every step."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from verify.checks.identities import run_checks
from verify.curves.curve import curve_error
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.names import METHODS
from verify.methods.solve import solve
from verify.scene.load import load_scene

REFERENCE = Path(__file__).parents[5] / "shared" / "reference"
SCENES = {
    "dcb-czm1": "dcb_czm1_finite",
    "dcb-czm2": "dcb_czm2_finite",
    "dcb-czm1-linear": "dcb_czm1_linear",
    "dcb-czm2-linear": "dcb_czm2_linear",
}
#: method -> largest curve error
LIMITS = {"nurbs": 0.003, "lagrange": 0.02, "dolfinx": 0.002, "beam": 0.005}


def reference(scene: str) -> tuple[np.ndarray, np.ndarray]:
    file = REFERENCE / f"{SCENES[scene]}.csv"
    if not file.exists():
        pytest.skip(f"the reference curve {file.name} is not at hand")
    with file.open() as lines:
        rows = [(float(row["opening"]), float(row["load"])) for row in csv.DictReader(lines)]
    return tuple(np.array(rows).T)


@pytest.mark.parametrize(
    ("scene", "method"),
    [  # without --slow each method on one scene
        pytest.param(scene, method, marks=() if i == j else pytest.mark.slow)
        for i, scene in enumerate(SCENES)
        for j, method in enumerate(reversed(LIMITS))
    ],
)
def test_curve_error_and_identities(scene, method):
    if method == "dolfinx" and not dolfinx_installed():
        pytest.skip("DOLFINx is not installed")
    expected = reference(scene)
    model = load_scene(scene)
    result = solve(model, method)
    error = curve_error((result.opening, result.load), expected, 3.0)
    limit = 0.002 if method == "beam" and "linear" in scene else LIMITS[method]
    print(f"{scene} {method}: {error:.4%} of {limit:.1%}, {result.dofs} unknowns")
    assert error <= limit
    assert result.dofs <= 1956 or method == "dolfinx"
    assert [check for check in run_checks(model, result) if not check.passed] == []


def test_a_wrong_toughness_is_noticed():
    """The test above would not be one if it passed with the physics broken: 2 % more toughness is 1 % more load."""
    expected = reference("dcb-czm1-linear")
    result = solve(load_scene("dcb-czm1-linear", ["interface.toughness=0.102"]), "beam")
    assert curve_error((result.opening, result.load), expected, 3.0) > 0.002


def test_the_guide_names_every_method():
    guide = (Path(__file__).parents[4] / "docs" / "pages" / "guide" / "methods.md").read_text()
    assert set(re.findall(r"^\| `(\w+)` \|", guide, re.M)) == set(METHODS)
