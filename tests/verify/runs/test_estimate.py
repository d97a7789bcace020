"""How long runs are expected to take: by their steps, their unknowns and their method."""

from __future__ import annotations

import numpy as np
import pytest

from verify.methods.names import METHODS
from verify.runs.estimate import seconds, steps, unknowns
from verify.scene.load import load_scene
from verify.scene.process_zone import bulk_length, slender_length

#: Arms in which the process zone is as long as in an unbounded body.
THICK = ("load.opening=28", "specimen.arm_thickness=3.0", "interface.strength=120")


def test_unknowns_are_those_aimed_at():
    dofs = "discretization.dofs=1001"
    whole, mirrored = (load_scene("dcb-czm1", [dofs, f"effects.symmetry={s}"]) for s in ("false", "true"))
    assert [unknowns(scene, "nurbs") for scene in (whole, mirrored)] == [1001, 500]
    assert unknowns(whole, "beam") == unknowns(whole, "code of another") == 1000
    elements = load_scene("dcb-czm1", ["dolfinx.elements=100", "dolfinx.degree=2"])
    assert unknowns(elements, "dolfinx") == 2 * 2 * 201 * 3, "two arms, two components, one element through each"


@pytest.mark.parametrize(
    ("method", "steady", "per_step"),
    [(name, one.besides, one.per_step) for name, one in METHODS.items()] + [("code of another", 2.0, 0.03)],
)
def test_time_goes_with_steps_and_unknowns(method, steady, per_step):
    scene = load_scene("dcb-czm1", ["discretization.steps=40", "discretization.dofs=4000"])
    per_run = per_step * steps(scene, method) * unknowns(scene, method) / 1000
    assert seconds(scene, method) == pytest.approx(steady + per_run) and per_run > 0.0


def test_steps_beyond_those_of_an_intact_bond_go_with_the_lengths_of_the_zone():
    """A crack that runs through the whole bond has it all to grow; without growth twenty are enough."""
    few = "discretization.steps=2"
    assert steps(load_scene("dcb-czm1", [few, "load.opening=1e-6"]), "nurbs") == 20
    assert steps(load_scene("dcb-czm1", ["discretization.steps=21", "load.opening=1e-6"]), "nurbs") == 21
    shorter = []
    for name, *more in (("dcb-czm1", "load.opening=28"), ("peel-120", "load.opening=150"), ("dcb-czm1", *THICK)):
        scene = load_scene(name, [few, *more])
        specimen = scene.specimen
        shorter.append(bulk_length(scene) < slender_length(scene))
        bond = specimen.bond_length if specimen.kind == "peel" else specimen.length - specimen.precrack
        zones = bond / min(slender_length(scene), bulk_length(scene))
        assert steps(scene, "nurbs") == round(20 + 8.2 * zones)
    assert len(set(shorter)) == 2, "of slender arms the one length is shorter, of thick ones the other"
    chosen = []
    for bend, factor in (("0.01", 1), ("0.005", 1), ("0.00005", 10)):
        scene = load_scene("dcb-czm1", ["discretization.steps=auto", f"discretization.bend={bend}"])
        chosen.append(steps(scene, "tspline") / factor)
    assert np.ptp(chosen) < 0.5 and 40 < chosen[0] < 80, "steps of a bend go with its root"


def test_a_path_takes_more_steps_where_its_front_asks_for_them():
    """Counted on the paths of both codes: 86 steps on dcb-czm1 where 40 are asked for, 200 on peel-120."""
    for name, counted, part in (("dcb-czm1", 86, 0.1), ("peel-120", 200, 0.2)):
        assert steps(load_scene(name, ["discretization.steps=40"]), "nurbs") == pytest.approx(counted, rel=part)
    for more in ((), ("load.opening=0.1",)):
        assert steps(load_scene("dcb-czm1", ["discretization.steps=150", *more]), "nurbs") == 150
    chosen = load_scene("dcb-czm1", ["discretization.steps=auto"])
    assert steps(chosen, "nurbs") == steps(chosen, "dolfinx") < 86 and steps(chosen, "beam") == 150


def test_arms_that_slide_take_more_steps_and_a_long_crack_takes_more():
    """Five minutes were announced as one: a crack that crosses thirty zones takes ten times the steps."""
    opens, slides = (load_scene(name, ["discretization.steps=auto"]) for name in ("plain-39", "plain-0"))
    short = load_scene("plain-39", ["load.opening=1e-6"])
    assert steps(opens, "nurbs") > 8 * steps(short, "nurbs") and steps(slides, "nurbs") > 2 * steps(opens, "nurbs")


def test_a_beam_takes_longer_with_its_order_and_where_arms_slide():
    opens, slides, third = (
        seconds(load_scene(name, more), "beam")
        for name, more in (("plain-39", ()), ("plain-0", ()), ("plain-39", ("beam.order=3",)))
    )
    assert slides > 3.0 * opens and third > 1.5 * opens
