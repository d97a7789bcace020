"""Which way a path goes."""

import numpy as np
import pytest

from verify.methods.solve import solve
from verify.scene.load import load_scene


def test_a_crack_in_a_bond_that_heals_does_not_turn_back_at_a_corner_of_its_law():
    """Behind the plateau the path bends by more than a right angle in opening and progress."""
    words = ["interface.law=trapezoidal", "interface.plateau=0.69", "load.opening=3.75", "beam.in_a_zone=2"]
    run = solve(load_scene("enf-as4peek", [*words, "effects.irreversible=false"]), "beam")
    assert run.complete and run.steps["crack_length"][-1] > 40.0
    assert np.min(run.opening[np.argmax(run.load) :]) > 3.5


@pytest.mark.parametrize("shape", [["trapezoidal", "plateau=0.69"], ["exponential-softening", "decay=8"]])
def test_a_traction_that_falls_steeply_is_followed_in_as_many_rows(shape):
    law, key = shape
    words = [f"interface.law={law}", f"interface.{key}", "load.opening=6"]
    run = solve(load_scene("mmb50-as4peek", words), "beam")
    assert run.complete and run.opening.size < 200


@pytest.mark.parametrize("law", ["bilinear", "exponential-softening"])
def test_a_bond_that_heals_gives_back_what_it_took(law):
    """Over a crack that runs, closes and runs again the work is what arms and bond store."""
    words = [f"interface.law={law}", "load.opening=[4.4, 2.5, 4.6]", "beam.in_a_zone=2"]
    steps = solve(load_scene("enf-as4peek", [*words, "effects.irreversible=false"]), "beam").steps
    left = steps["external_work"] - steps["stored_energy"]
    assert np.abs(left).max() < 2e-4 * steps["external_work"].max() and not steps["dissipated_energy"].any()
