"""R-curves: a rise is told where there is one, with its numbers, and not where there is none."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_tests import NOISY, TESTS, Rig, recorded, specimen
from skips import SHARED

from verify.cli import main
from verify.reduction.r_curve import noise_of, r_curve, rises
from verify.reduction.reduce import reduce
from verify.reduction.scheme import Settings
from verify.studies.reduce.wording import remarks

LAB = SHARED / "lab"
#: Test -> its precrack in the file, and the mean of the laboratory's own G on growth (README of the folder).
MEANS = {"01": (37.64, 0.901), "03": (25.39, 0.883), "06": (41.527, 0.887), "08": (37.027, 0.836)}


def test_initiation_plateau_and_length_come_back():
    random, x = np.random.default_rng(1), np.linspace(0.0, 40.0, 800)
    G = 1.0 - 0.6 * np.maximum(1.0 - x / 15.0, 0.0) + 0.02 * random.standard_normal(x.size)
    found = r_curve(x, G)
    assert (found.initiation, found.plateau) == pytest.approx((0.4, 1.0), abs=0.02) and found.reached
    assert found.length == pytest.approx(15.0, abs=0.7)
    assert not r_curve(x[:250], G[:250]).reached
    noises = [noise_of(0.003 * random.standard_normal(20) + np.linspace(0.0, 1.0, 20)) for _ in range(100)]
    assert np.mean(noises) == pytest.approx(0.003, rel=0.2)


@pytest.mark.parametrize(
    ("found", "told"),
    [
        ([(0.40, 0.007), (0.20, 0.007), (0.40, 0.007), (0.42, 0.009), (0.55, 0.010)], True),
        ([(0.0355, 2e-4), (0.0216, 1.5e-4), (0.0051, 1.4e-4), (0.0004, 5e-5)], False),  # schemes do not agree
        ([(0.40, 0.007), (0.41, 0.09)], False),  # noise
        ([(-0.0023, 2e-5)], False),
        ([(float("nan"), float("nan"))], False),
    ],
)
def test_a_rise_is_beyond_noise_and_schemes(found, told):
    assert rises(found) is told


@pytest.mark.parametrize("kind", TESTS)
@pytest.mark.parametrize("read", [True, False])
@pytest.mark.parametrize("rig", [Rig(), Rig(modulus=0.9), *(replace(NOISY, seed=seed) for seed in range(3))])
def test_a_constant_toughness_does_not_rise(kind, read, rig):
    test = recorded(kind, rig)
    test = test if read else replace(test, crack=np.full(test.load.size, np.nan))
    assert reduce(test, specimen(kind), Settings(machine=rig.machine)).r_curve is None


@pytest.mark.parametrize("name", MEANS)
def test_files_of_a_laboratory(name, tmp_path, monkeypatch, capsys):
    """Fibres bridge in all four; MBT is within 7 % of the laboratory's own mean."""
    file = LAB / f"DCB-{name}_Toughness.csv"
    if not file.exists():
        pytest.skip(f"{file.name} is not there")
    monkeypatch.chdir(tmp_path)
    precrack, own = MEANS[name]
    (tmp_path / "lab.toml").write_text(
        f'specimen = {{ kind = "dcb", length = 150.0, arm_thickness = 2.7, precrack = {precrack}, width = 25.0 }}\n'
        "material = { young = 33e3, poisson = 0.3 }\ninterface = { strength = 20.0, toughness = 1.0 }\n"
    )
    assert main(["reduce", str(file), "--scene", "lab.toml", "--opening", "Disp", "--load", "Force", "--crack",
                 "CrackExt"]) == 0  # fmt: skip
    said = capsys.readouterr()
    mean = next(float(line.split()[-8]) for line in said.out.splitlines() if line.startswith("MBT "))
    assert "G rises along the crack" in said.err and mean == pytest.approx(own, rel=0.07)


def test_friction_of_an_enf_is_named():
    found = reduce(recorded("enf", Rig()), replace(specimen("enf"), friction=0.3))
    part = 100.0 * 4.0 / 3.0 * 0.3 * found.coupon.h / found.coupon.precrack
    assert any(f"+{part:.2f} % of G from the crack" in text for text in remarks(found))
    assert not any("friction" in text for text in remarks(reduce(recorded("enf", Rig()), specimen("enf"))))
