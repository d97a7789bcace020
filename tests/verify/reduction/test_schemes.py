"""Every scheme on curves that its formula describes exactly."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_tests import NOISY, TESTS, Rig, recorded, specimen

from verify.curves.read import CurveError
from verify.reduction.corrections import smooth
from verify.reduction.data import Measured, _turn
from verify.reduction.dcb import factors
from verify.reduction.reduce import reduce
from verify.reduction.scheme import Settings
from verify.scene.load import load_scene
from verify.theory.lefm import LefmProblem, solve

G = 0.3


def values(found):
    return {one.name: one.propagation.value for one in found.schemes if not one.missing}


def curve(C, dC, cracks, b=20.0):
    """A crack that grows at G along a compliance C(a); its first length is the precrack."""
    P = np.sqrt(2.0 * b * G / dC(cracks))
    start = np.linspace(0.0, 1.0, 40, endpoint=False)
    d = np.concatenate([start * C(cracks[0]) * P[0], C(cracks) * P])
    return Measured("made", d, np.append(start * P[0], P), np.append(np.full(40, cracks[0]), cracks))


def unread(test):
    return replace(test, crack=np.full(test.crack.size, np.nan))


DCB = replace(specimen("dcb"), width=20.0, precrack=50.0, length=150.0)
ENF = replace(specimen("enf"), width=20.0, precrack=38.0)
CRACKS, SHORT = np.linspace(50.0, 90.0, 60), np.linspace(38.0, 47.0, 40)
CUBIC = curve(lambda a: 2e-6 * (a + 4.0) ** 3, lambda a: 6e-6 * (a + 4.0) ** 2, CRACKS)
POWER = curve(lambda a: 3e-6 * a**2.8, lambda a: 2.8 * 3e-6 * a**1.8, CRACKS)
WITH_CONSTANT = curve(lambda a: 2e-3 + 4e-8 * a**3, lambda a: 1.2e-7 * a**2, SHORT)
OF_PRECRACKS = Settings(calibration=tuple((a, 2e-3 + 4e-8 * a**3) for a in (20.0, 30.0, 40.0)))


@pytest.mark.parametrize(
    ("test", "coupon", "settings", "scheme", "constants"),
    [
        (CUBIC, DCB, Settings(), "MBT", {"Delta": 4.0}),
        (CUBIC, DCB, Settings(), "MCC", {"A1": 1.0 / (2.0 * DCB.h * np.cbrt(2e-6))}),
        (POWER, DCB, Settings(), "CC", {"n": 2.8}),
        (WITH_CONSTANT, ENF, Settings(), "CC", {"m": 4e-8, "A": 2e-3}),
        (unread(WITH_CONSTANT), ENF, OF_PRECRACKS, "CC", {"m": 4e-8, "A": 2e-3}),
    ],
)
def test_a_scheme_is_exact_for_the_compliance_that_it_assumes(test, coupon, settings, scheme, constants):
    (found,) = (one for one in reduce(test, coupon, settings).schemes if one.name == scheme)
    assert {name: value.value for name, value in found.constants.items()} == pytest.approx(constants)
    assert found.initiation["5%/max"].value == pytest.approx(G, rel=1e-3)
    if np.isfinite(test.crack).any():
        assert found.propagation.value == pytest.approx(G, rel=1e-10) and found.scatter < 1e-10
        assert found.initiation["VIS"].value == pytest.approx(G)


@pytest.mark.parametrize("kind", TESTS)
def test_the_compliance_gives_toughness_and_modulus_back(kind):
    """No crack length is read, the modulus of the scene is wrong by 10 %, and the machine gives way."""
    test = recorded(kind, Rig(modulus=0.9, machine=2e-4, toe=0.2, readings=2))
    found = reduce(unread(test), specimen(kind), Settings(machine=2e-4))
    cbbm = next(one for one in found.schemes if one.name == "CBBM")
    assert cbbm.propagation.value == pytest.approx(TESTS[kind][1], rel=1e-4)
    assert cbbm.constants["E_f"].value == pytest.approx(0.9 * found.coupon.young, rel=1e-4)
    assert found.toe == pytest.approx(0.2, rel=1e-3)
    assert cbbm.initiation["5%/max"].value == pytest.approx(TESTS[kind][1], rel=5e-3)
    assert {one.name for one in found.schemes if one.missing} == {"MBT", "CC", "MCC", "J"} & {
        s.name for s in found.schemes
    }


def test_a_machine_that_is_not_taken_off_shows():
    off = values(reduce(recorded("dcb", Rig(machine=2e-3)), specimen("dcb")))["CBBM"] / TESTS["dcb"][1] - 1.0
    assert abs(off) > 0.01


def test_factors_of_large_openings_are_those_of_the_theory():
    """A crack that grows by the LEFM theory with F and N, which are 3 % and more."""
    scene = load_scene("dcb-as4peek")
    dcb = specimen("dcb")
    problem = LefmProblem(
        dcb.length, dcb.h, dcb.precrack, dcb.width, dcb.young, dcb.transverse, dcb.shear, scene.interface.toughness,
        30.0, "finite", "factors",
    )  # fmt: skip
    rows = solve(problem).rows
    d, P, a = (np.array([row[key] for row in rows]) for key in ("opening", "load", "crack_length"))
    test = Measured("lefm", d, P, a)
    with_them = reduce(test, dcb, Settings((0.02, 0.2), toe=False, large=True))
    without = values(reduce(test, dcb, Settings((0.02, 0.2), toe=False)))
    for name in ("MBT", "MCC", "CBT"):
        assert values(with_them)[name] == pytest.approx(scene.interface.toughness, rel=2e-3)
    assert abs(without["CBT"] / scene.interface.toughness - 1.0) > 0.02


def test_factors_of_blocks():
    """ASTM D5528, annex A1, at one point, by hand."""
    F, N = factors(10.0, 50.0, True, (5.0, 8.0))
    assert F == pytest.approx(1.0 - 0.3 * 0.04 - 1.5 * 50.0 / 2500.0)
    assert N == pytest.approx(1.0 - 0.16**3 - 1.125 * (1.0 - 0.16**2) * 0.02 - 9.0 / 35.0 * 0.04)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_j_of_rotations(sign):
    """Of a simple beam: theta = 6 P a^2 / (E b h^3), on either side of the specimen."""
    theta, path = np.linspace(0.0, 0.3, 7), Path("test.csv")
    both = _turn(path, sign * np.array([-theta, theta]))
    assert both == pytest.approx(2.0 * np.sin(theta)) and _turn(path, sign * theta[None]) == pytest.approx(both)
    with pytest.raises(CurveError, match="must have different signs"):
        _turn(path, sign * np.array([theta, 1.01 * theta]))
    with pytest.raises(CurveError, match="less than a right angle"):
        _turn(path, sign * np.degrees([-theta, theta]))


@pytest.mark.parametrize(("kind", "slides"), [("dcb", 0.0), ("enf", 1.0), ("4enf", 1.0), ("mmb", np.nan)])
def test_j_is_all_of_one_mode_where_the_specimen_says_so(kind, slides):
    test = recorded(kind, Rig(rows=400))
    found = reduce(replace(test, J=np.full(400, G)), specimen(kind)).schemes[-1]
    assert (found.propagation.value, found.mixture) == pytest.approx((G, slides), nan_ok=True)


@pytest.mark.parametrize("softer", [0.0, 0.03])
def test_rows_on_which_the_specimen_unloads_do_not_count(softer):
    """Nor where unloading is softer than loading, as that of laminates with bridging fibres is."""
    middle, back = 70, np.append(np.linspace(1.0, 0.0, 20), np.linspace(0.0, 1.0, 20))
    loads = back * (1.0 - softer * 4.0 * back * (1.0 - back) * (np.arange(40) < 20))
    there = {
        name: np.insert(values, middle, part * values[middle - 1])
        for name, values, part in (
            ("opening", CUBIC.opening, back), ("load", CUBIC.load, loads), ("crack", CUBIC.crack, np.ones(40))
        )
    }  # fmt: skip
    whole, found = reduce(CUBIC, DCB), reduce(replace(CUBIC, **there), DCB)
    assert values(found) == pytest.approx(values(whole), rel=1e-3)
    assert found.grown.sum() == whole.grown.sum() + 2  # both ends of the loop are where it left the curve
    pairs = zip(found.schemes, whole.schemes, strict=True)
    assert all(one.G.size == other.G.size + 2 for one, other in pairs if not one.missing)  # of the R-curve


def test_a_crack_grows_while_the_opening_of_a_snap_back_falls():
    """An ENF specimen from a short crack, driven by its sliding: the opening falls by 29 % and grows again."""
    enf = replace(ENF, precrack=0.35 * 51.0)
    cracks = np.linspace(enf.precrack, 0.9 * 51.0, 80)
    test = curve(lambda a: 1e-8 * (2.0 * 51.0**3 + 3.0 * a**3), lambda a: 9e-8 * a**2, cracks)
    assert test.opening[40:].min() < 0.75 * test.opening[40]
    found = reduce(test, enf)
    assert found.grown.sum() > 70 and not found.unloads.any()


def test_vis_is_after_the_linear_part_though_the_precrack_was_read_longer():
    longer = replace(CUBIC, crack=np.where(CUBIC.crack == 50.0, 50.1, CUBIC.crack))
    found = reduce(longer, DCB)
    assert longer.crack[found.points["VIS"]] == 50.1
    assert found.schemes[0].initiation["VIS"].value == pytest.approx(G, rel=0.01)


def test_noise_is_told_from_the_curve():
    found = smooth(recorded("dcb", NOISY))
    assert found.noise == pytest.approx(0.003 * found.rows.load.max(), rel=0.1) and found.width == 13
    assert smooth(recorded("dcb", Rig())).width == 1
