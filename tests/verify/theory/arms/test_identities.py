"""Identities of the arms at every step of whole scenes, far closer than the checks ask for."""

import pytest

from verify.checks.identities import run_checks
from verify.methods.solve import solve
from verify.result import CURVE_COLUMNS, EVIDENCE_COLUMNS
from verify.scene.load import load_scene

LINEAR, FINITE, COARSE = "effects.kinematics=linear", "effects.kinematics=finite", "discretization.steps=60"
#: What a run may use of the tolerance of a check; the bond unloads and loads again in some.
PARTS = {"energy-ledger": 0.05, "j-integral": 1.0, "j-loads": 1.0, "secant": 0.1, "penetration": 0.1}
SCENES = [
    ("dcb-czm1", FINITE),
    ("dcb-czm1", LINEAR, "load.opening=[0.6, 0.2, 0.9]"),
    ("peel-60", FINITE),
    ("mmb50-as4peek", LINEAR),
    ("enf-as4peek", LINEAR, "interface.friction=0.4", "load.opening=[5.4, 3.0, 5.6]"),
    ("adcb-czmtestkit-b", LINEAR, "load.opening=4.0"),
    *(
        pytest.param(words, marks=pytest.mark.slow)
        for words in (
            ("dcb-czm2", FINITE),
            ("peel-soft", FINITE),
            ("enf-as4peek", FINITE),
            ("slb", LINEAR),
            ("adcb-czmtestkit-b", FINITE, "load.opening=4.0"),
            ("4enf", FINITE, "interface.friction=0.39", "load.opening=[4.74, 4.4]"),
            ("adcb-czmtestkit-b", FINITE, "load.opening=4.0", "beam.order=3"),
            ("dcb-czm1", FINITE, "beam.order=3"),
        )
    ),
]


@pytest.mark.parametrize("words", SCENES, ids=str)
def test_identities_at_every_step(words):
    scene = load_scene(words[0], [COARSE, *words[1:]])
    run = solve(scene, "beam")
    names = {name for name in run.steps if not name.startswith("support_")}
    assert run.complete and set(CURVE_COLUMNS) <= names <= {*CURVE_COLUMNS, *EVIDENCE_COLUMNS}
    found = {check.name: abs(check.value) / check.tolerance for check in run_checks(scene, run)}
    falls = 8.0 if words[0] == "slb" else 1.0  # of its steep fall few rows are there
    assert {name: used for name, used in found.items() if used > falls * PARTS.get(name, 1.0)} == {}
    balances = {"arm-balance", "supports"} if scene.interface.slides and "supports" in found else {"interface-force"}
    assert found.keys() >= {"completed", "energy-ledger"} and (scene.interface.slides or found.keys() >= balances)


def test_a_beam_too_coarse_for_j_names_the_elements_that_resolve_it():
    scene = load_scene("tijs-dcb", ["beam.order=3"])
    (check,) = (check for check in run_checks(scene, solve(scene, "beam")) if check.name == "j-integral")
    assert check.state == "unresolved" and "beam.in_a_zone = 6.7 resolves it" in check.unresolved
