"""Peel tests: runs give the toughness of their bond back, files what they were made of."""

import json
from dataclasses import replace
from math import pi, radians
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.reduction.coupon import coupon
from verify.reduction.data import Measured
from verify.reduction.reduce import reduce
from verify.reduction.scheme import Settings
from verify.scene.load import load_scene


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def value(*words: str) -> dict:
    assert main(["reduce", *words, "--out", "out"]) == 0
    return json.loads(Path("out/reduce.json").read_text())["schemes"]["peel"]


@pytest.mark.parametrize("name", ["peel-120", pytest.param("peel-soft", marks=pytest.mark.slow)])
def test_a_run_and_its_file_give_the_toughness_back(name, folder):
    """Arms that hardly turn, and one that stands upright; of the file with rotations in degrees."""
    scene = load_scene(name)
    assert coupon(scene).h == scene.specimen.strip_thickness
    assert main(["solve", name, "--method", "beam", "--out", "run"]) == 0
    found = value("run")
    assert found["propagation"]["value"] == pytest.approx(0.1, rel=0.01) and found["input"] == 0.1
    curve, evidence = (np.genfromtxt(f"run/{name}.csv", delimiter=",", names=True) for name in ("curve", "evidence"))
    d, P, slope = curve["opening"], curve["load"], evidence["face_slope_top"]
    turned = np.degrees(np.arcsin(np.clip(slope, 0.0, 1.0)))
    rows = [f"{a:.8g},{b / 1e3:.8g},{c:.8g}" for a, b, c in zip(d, P, turned, strict=True)]
    Path("test.csv").write_text("\n".join(["opening (mm),load (kN),turned", *rows]))
    words = ["test.csv", "--scene", name, "--rotations", "turned", "--rotation-scale", str(pi / 180.0)]
    assert value(*words)["propagation"]["value"] == pytest.approx(0.1, rel=0.01)


def peeled(angle: float, toughness: float = 0.4, noise: float = 0.01) -> tuple[Measured, float]:
    """Of peel-soft: load from 0 to the steady one in a tenth of the travel, noise, and the steady load."""
    of, random = coupon(load_scene("peel-soft")), np.random.default_rng(3)
    half = of.width * (1.0 - np.cos(angle)), 1.0 / (2.0 * of.young * of.h)
    P = (-half[0] + np.sqrt(half[0] ** 2 + 4.0 * half[1] * toughness * of.width**2)) / (2.0 * half[1])
    d = np.linspace(0.0, 40.0, 800)
    load = P * (np.minimum(d / 4.0, 1.0) + noise * random.standard_normal(d.size))
    return Measured("test", d, load, np.full(d.size, np.nan)), float(P)


@pytest.mark.parametrize("degrees", [45.0, 90.0, 180.0])
def test_the_stretched_strip_of_kinloch_lau_williams(degrees):
    """P^2 / (2 b^2 h E) is 12 % of G at 45 degrees."""
    test, P = peeled(radians(degrees))
    of = replace(coupon(load_scene("peel-soft")), angle=radians(degrees))
    (one,) = reduce(test, of, Settings()).schemes
    assert one.propagation.value == pytest.approx(0.4, rel=2e-3) and one.propagation.half_width < 4e-3
    assert one.scatter == pytest.approx(0.4 * 0.01, rel=1.2)
    growth = (40.0 - 4.0) / (1.0 - np.cos(radians(degrees)))
    assert one.growth.max() == pytest.approx(growth, rel=0.02) and one.count == pytest.approx(0.72 * 800, rel=0.03)


def test_units_of_a_header_and_the_angle(folder, capsys):
    test, _ = peeled(pi)
    rows = [f"{d / 25.4:.8g},{P / 1e3:.8g}" for d, P in zip(test.opening, test.load, strict=True)]
    Path("test.csv").write_text("\n".join(["Extension [in],Force (kN)", *rows]))
    words = ["test.csv", "--scene", "peel-soft", "--opening", "Extension", "--load", "Force"]
    found = value(*words, "--peel-angle", "180")
    assert found["propagation"]["value"] == pytest.approx(0.4, rel=2e-3)
    said = capsys.readouterr().err
    assert said.count("by its header") == 2 and "what plastic bending dissipates is left out" in said.replace("\n", " ")
    for more, sentence in (
        (["--peel-angle", "200"], "--peel-angle: must be in (0, 180]"),
        (["--fit"], "--fit: needs a curve from its linear part on"),
    ):
        assert main(["reduce", *words, *more]) == 2
        assert sentence in capsys.readouterr().err
    assert main(["reduce", "test.csv", "--scene", "dcb-czm1", "--peel-angle", "90", *words[3:]]) == 2
    assert "got 90 of the kind 'dcb'" in capsys.readouterr().err
