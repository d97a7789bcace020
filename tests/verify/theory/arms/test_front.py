"""Fine elements that follow the process zone."""

from dataclasses import replace

import numpy as np
import pytest

from verify.methods.solve import prepare
from verify.scene.load import load_scene
from verify.theory.arms.front import followed, model


@pytest.mark.parametrize("scene", ["plain-4", "enf-as4peek"])
def test_what_a_bond_remembers_stays_where_elements_stay(scene):
    """Damage far ahead of the fine elements moves them; points of elements that stay keep theirs to the last digit, and
    displacements that every mesh has are carried over exactly."""
    made = model(prepare(load_scene(scene, ["beam.order=3"]), "beam").problem)
    problem, one = made.structure.problem, made.structure
    x, tip = one.at_points, min(problem.bonded)
    progress = np.where(made.interface.bonded, np.clip(1.5 - (x - tip) / (4.0 * problem.zone), 0.0, 1.0), 0.0)
    rng = np.random.default_rng(3)
    slopes = rng.normal(size=one.unknowns)
    c = (one.mesh.places[:, None] * slopes + rng.normal(size=one.unknowns)).ravel()  # linear along the arms
    state = replace(made.rest, x=c, history=replace(made.rest.history, progress=progress))
    found = followed(made, state)
    assert found is not None
    new, moved = found
    there = new.structure.at_points
    same = np.isin(there, x)
    assert 0.2 < same.mean() < 1.0 and new.fine[1] > made.fine[1]
    at = np.searchsorted(x.ravel(), there[same])
    assert np.array_equal(moved.history.progress[same], progress.ravel()[at])
    assert followed(new, moved) is None, "fine elements are there now"
    y, z = new.structure.functionals(moved.x), one.functionals(c)
    assert y[same] == pytest.approx(z.reshape(-1, z.shape[-1])[at], rel=1e-9, abs=1e-9 * np.abs(z).max())
