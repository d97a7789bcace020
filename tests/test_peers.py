"""The plug-ins for other codes: installed as a user would, run, and held against NURBS."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from verify.curves.read import read_curve
from verify.methods.solve import solve
from verify.scene.load import load_scene
from verify.testing import assert_curves_close

PROJECT = Path(__file__).resolve().parents[1]
PEERS = PROJECT / "examples" / "peers"
SCENE = "dcb-czm1-linear"
UNREACHED = re.compile(r"No matching distribution|Could not find a version|new connection|name resolution", re.I)

pytestmark = pytest.mark.slow


def installed(peer, package, site):
    """The environment in which the plug-in and its code are installed, besides what is there."""
    pip = [sys.executable, "-m", "pip", "install", "--no-deps", "--target", str(site)]
    got = subprocess.run([*pip, package], capture_output=True, text=True, timeout=600)
    if got.returncode and UNREACHED.search(got.stderr):
        pytest.skip(f"{package} cannot be had for this Python, or from here")
    assert got.returncode == 0, got.stderr
    source = shutil.copytree(PEERS / peer, site.with_name(f"{site.name}-{peer}"))  # where a build may leave its files
    got = subprocess.run([*pip, str(source)], capture_output=True, text=True, timeout=600)
    assert got.returncode == 0, got.stderr
    return os.environ | {"PYTHONPATH": os.pathsep.join(map(str, (site, PROJECT)))}


def curve(method, environment, out, *settings, scene=SCENE):
    """The curve of ``debond solve``."""
    words = ["solve", scene, "--method", method, *(word for one in settings for word in ("--set", one))]
    command = [sys.executable, "-P", "-m", "verify", *words, "--out", str(out)]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600)
    assert run.returncode == 0, run.stderr
    return read_curve(out)


@pytest.fixture(scope="module")
def scikit_fem(tmp_path_factory):
    return installed("scikit_fem", "scikit-fem", tmp_path_factory.mktemp("site"))


def test_scikit_fem_draws_the_curve_of_nurbs(scikit_fem, tmp_path):
    """0.10 % apart, on 112 quadratic elements along each arm; 2 % more toughness would be seen."""
    found, nurbs = curve("scikit-fem", scikit_fem, tmp_path / "right"), solve(load_scene(SCENE), "nurbs")
    assert_curves_close(found, nurbs, curve=0.005, peak=0.005)
    tougher = curve("scikit-fem", scikit_fem, tmp_path / "wrong", "interface.toughness=0.102")
    with pytest.raises(AssertionError):
        assert_curves_close(tougher, nurbs, curve=0.005)


@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        ("dcb-czm1", ("discretization.steps=60", "dolfinx.elements=56")),
        (SCENE, ("load.opening=[1.5, 0.5, 1.5, 2.0]", "effects.irreversible=true")),
        (SCENE, ("effects.contact=false",)),
    ],
)
def test_scikit_fem_has_the_effects_of_a_scene(scikit_fem, tmp_path, scene, settings):
    """Finite rotations, unloading along the secant, faces that pass through each other."""
    found, known = curve("scikit-fem", scikit_fem, tmp_path, *settings, scene=scene), load_scene(scene, settings)
    assert_curves_close(found, solve(known, "nurbs"), curve=0.005, programme=known.load.opening)


def test_scikit_fem_takes_part_in_the_study_of_cost(scikit_fem):
    script = "from verify.studies.cost.grid import of_plugins; print(*(one.name for one in of_plugins()))"
    run = subprocess.run([sys.executable, "-P", "-c", script], env=scikit_fem, capture_output=True, text=True)
    assert run.returncode == 0 and {"scikit-fem-p1", "scikit-fem-p2"} <= set(run.stdout.split()), run.stderr


@pytest.fixture(scope="module")
def akantu(tmp_path_factory):
    return installed("akantu", "akantu", tmp_path_factory.mktemp("site"))


def test_akantu_draws_the_curve_of_nurbs(akantu, tmp_path):
    """0.10 % apart, on 112 quadratic elements along each arm; 2 % more toughness would be seen."""
    found, nurbs = curve("akantu", akantu, tmp_path / "right"), solve(load_scene(SCENE), "nurbs")
    assert_curves_close(found, nurbs, curve=0.005, peak=0.005)
    tougher = curve("akantu", akantu, tmp_path / "wrong", "interface.toughness=0.102")
    with pytest.raises(AssertionError):
        assert_curves_close(tougher, nurbs, curve=0.005)


def test_akantu_closes_a_gap_with_the_stiffness_of_the_scene(akantu, tmp_path):
    """Without contact that of the bond, which moves the curve by 0.6 %."""
    setting = "effects.contact=false"
    found = curve("akantu", akantu, tmp_path, setting, "discretization.steps=60")
    assert_curves_close(found, solve(load_scene(SCENE, [setting]), "nurbs"), curve=0.005)


def test_akantu_says_what_it_is_not_made_for(akantu, tmp_path):
    for number, setting in enumerate(('effects.kinematics="finite"', "load.opening=[1.5, 0.5, 2.0]")):
        with pytest.raises(AssertionError, match="akantu: "):
            curve("akantu", akantu, tmp_path / str(number), setting)


def test_pyfem_draws_the_curve_of_nurbs(tmp_path_factory, tmp_path):
    """0.14 % apart, on 112 quadratic elements along each arm with two linear interface elements each, in 60 steps."""
    pyfem = installed("pyfem", "pyfem-tue", tmp_path_factory.mktemp("site"))
    settings = ("effects.contact=false", "discretization.steps=60")
    found = curve("pyfem", pyfem, tmp_path, *settings)
    assert_curves_close(found, solve(load_scene(SCENE, settings[:1]), "nurbs"), curve=0.005, peak=0.005)
    other = solve(load_scene(SCENE, [*settings[:1], "interface.toughness=0.102"]), "nurbs")
    with pytest.raises(AssertionError):
        assert_curves_close(found, other, curve=0.005)
