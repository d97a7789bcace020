"""Closed forms of the specimens: against difference quotients, against beams assembled from their parts, and back."""

from dataclasses import replace

import numpy as np
import pytest

from verify.reduction.coupon import REDUCED, coupon
from verify.reduction.flexure import flexure
from verify.scene.load import load_scene
from verify.scene.specimens.bending import bent_arms

SCENES = {
    "dcb": "dcb-as4peek",
    "adcb": "adcb-czmtestkit-a",
    "enf": "enf-as4peek",
    "els": "enf-as4peek",
    "4enf": "4enf",
    "slb": "slb",
    "mmb": "mmb50-as4peek",
}
each = pytest.mark.parametrize("kind", [kind for kind in REDUCED if kind != "peel"])  # which does not bend


def of(kind):
    found = coupon(load_scene(SCENES[kind]))
    return replace(found, kind=kind)


@each
def test_release_is_the_slope_of_the_compliance(kind):
    """P^2 / (2 b) dC/da, Irwin and Kies 1954."""
    specimen = of(kind)
    beam, E, a, P = flexure(specimen), specimen.young, 1.3 * specimen.precrack, 2.0
    step = 1e-4 * a
    slope = (beam.compliance(a + step, E) - beam.compliance(a - step, E)) / (2.0 * step)
    assert np.sum(beam.release(P, a, E)) == pytest.approx(P**2 / (2.0 * specimen.width) * slope, rel=1e-8)


@each
def test_the_crack_and_the_modulus_come_back_from_the_compliance(kind):
    specimen = of(kind)
    beam, E = flexure(specimen), specimen.young
    a = np.linspace(0.5, 1.3, 9) * specimen.precrack
    assert beam.crack(beam.compliance(a, E), E) == pytest.approx(a, rel=1e-10)
    assert beam.modulus(float(beam.compliance(a[3], E)), float(a[3])) == pytest.approx(E, rel=1e-12)
    assert np.isnan(beam.crack(-1.0, E))


@pytest.mark.parametrize("kind", ["adcb", "enf", "4enf", "slb", "mmb"])
def test_without_corrections_it_is_two_arms_as_beams(kind):
    """Overhangs, so that no roller is cut off at an end and shortens the span."""
    scene = load_scene(SCENES[kind], ["specimen.overhang=5.0"] if kind != "adcb" else [])
    specimen, arms = coupon(scene), bent_arms(scene)
    beam = replace(flexure(specimen), correction=0.0, shear=0.0, shear_a=0.0)
    for a in (specimen.precrack, 1.2 * specimen.precrack):
        tip = scene.specimen.place(a)
        assert beam.compliance(a, specimen.young) == pytest.approx(arms.compliance(tip), rel=1e-9)
        opened, slid = beam.release(1.0, a, specimen.young)
        release, mixture = arms.release(tip)
        assert opened + slid == pytest.approx(release * arms.compliance(tip) ** 2, rel=1e-9)
        if beam.separate:
            assert slid / (opened + slid) == pytest.approx(mixture, abs=1e-9)


@pytest.mark.parametrize(
    ("kind", "plan"), [("dcb", lambda a, L: 8.0 * a**3), ("els", lambda a, L: (L**3 + 3.0 * a**3) / 2.0)]
)
def test_without_corrections_it_is_a_cantilever(kind, plan):
    specimen = of(kind)
    beam, scale = replace(flexure(specimen), correction=0.0, shear=0.0, shear_a=0.0), specimen.width * specimen.h**3
    assert scale * beam.compliance(30.0, 1.0) == pytest.approx(plan(30.0, specimen.length))


def test_a_compliance_below_that_of_shear_has_no_modulus():
    beam = flexure(of("enf"))
    assert np.isnan(beam.modulus(0.5 * beam.shear, 30.0))


def test_a_short_lever_presses_the_arms_together():
    """ASTM D6671 has (3 c - L)^2, which grows again below c = L / 3; G_I is that of no lever then."""
    G_I, G_II = flexure(replace(of("mmb"), lever=10.0)).release(100.0, 30.0, 1e5)
    assert G_I == 0.0 and G_II > 0.0


def test_the_arm_that_alone_carries_half_of_the_load_of_a_slb_shears_twice_as_much():
    """6/5 (P/2)^2 a / (G b h) of one arm less that of both, over P^2."""
    of = coupon(load_scene("slb"))
    assert flexure(of).shear_a == pytest.approx(0.15 / (of.shear * of.width * of.h), rel=1e-12)
