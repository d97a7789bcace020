"""Unloading of a damaged specimen: straight with small displacements, bent by geometry alone with finite kinematics."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from iga.laws.traction_law import TractionLaw
from verify.checks.identities import run_checks
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.verdict import Check

#: A stocky specimen of carbon and epoxy, a stocky one of aluminium, and a slender one.
ORTHOTROPIC = (
    "dcb-czm1",
    "specimen={kind='dcb', length=50.0, arm_thickness=4.0, precrack=16.0, width=20.0, plane='strain'}",
    "material={E1=150e3, E2=8e3, G12=3e3, nu12=0.3, nu23=0.5}",
    "interface={strength=30.0, toughness=0.4}",
)
ISOTROPIC = (
    "dcb-czm1",
    "specimen={kind='dcb', length=40.0, arm_thickness=3.0, precrack=12.0, width=10.0}",
    "material={young=70e3, poisson=0.3}",
    "interface={strength=20.0, toughness=0.5}",
)
SLENDER = ("dcb-czm1",)
FINITE, COARSE = "effects.kinematics=finite", "discretization.dofs=900"


def scene_of(words: tuple[str, ...], *more: str) -> Scene:
    return load_scene(words[0], [*words[1:], *more])


def secant(scene: Scene, result: Result) -> Check:
    return next(check for check in run_checks(scene, result) if check.name == "secant")


@pytest.mark.parametrize(
    ("words", "programme", "method", "part"),
    [
        (ORTHOTROPIC, "[1.2]", "nurbs", 0.1),
        (ORTHOTROPIC, "[0.3, 0.03, 0.5]", "nurbs", 0.1),
        (ORTHOTROPIC, "[0.3, 0.03, 0.5]", "lagrange", 0.1),
        (ISOTROPIC, "[0.3, 0.05, 0.9]", "tspline", 0.1),
        ((*ISOTROPIC, "specimen.arm_thickness=1.0"), "[0.5, 0.05, 0.9, 0.1]", "nurbs", 0.1),
        (SLENDER, "[2.0, 0.4, 4.0]", "nurbs", 0.1),
        (("adcb-czmtestkit-a", "effects.symmetry=false"), "[1.0, 0.1]", "nurbs", 1.0),
    ],
)
def test_finite_kinematics_bend_the_line_by_what_the_energy_says(
    words: tuple[str, ...], programme: str, method: str, part: float
) -> None:
    """`part`: of the tolerance, which the geometric term itself exceeds on the stocky arms."""
    scene = scene_of(words, FINITE, COARSE, f"load.opening={programme}")
    found = secant(scene, solve(scene, method))
    assert found.value <= part * found.tolerance


def softer(result: Result, by: float) -> Result:
    """Bears less on every opening below the largest one so far, and stores as much less."""
    below = result.opening < np.maximum.accumulate(result.opening)
    part = np.where(below, 1.0 - by, 1.0)
    return replace(result, steps=result.steps | {n: part * result.steps[n] for n in ("load", "stored_energy")})


def steeper(result: Result, by: float) -> Result:
    """Unloads to an opening that is not zero, and comes back there; the energy is that of the springs."""
    top = np.maximum.accumulate(result.opening)
    below = result.opening < top
    x = np.where(below, result.opening, top) / np.where(top == 0.0, 1.0, top)
    load = result.load * np.where(below, 1.0 + by - by / np.where(x == 0.0, 1.0, x), 1.0)
    energy = result.steps["stored_energy"] * np.where(below, load / np.where(result.load == 0.0, 1.0, result.load), 1.0)
    return replace(result, steps=result.steps | {"load": load, "stored_energy": energy})


def arched(result: Result, by: float) -> Result:
    """A bond that unloads along a parabola once it is damaged, with the energy of one: no geometry is as large."""
    top = np.maximum.accumulate(result.opening)
    x, spring = result.opening / np.where(top == 0.0, 1.0, top), 0.5 * result.load * result.opening
    damaged = result.steps["dissipated_energy"] > 1e-6 * np.max(result.steps["dissipated_energy"])
    energy = result.steps["stored_energy"] - by * spring * np.where(damaged, 1.0 - 2.0 / 3.0 * x, 0.0)
    load = result.load * np.where(damaged, 1.0 - by * (1.0 - x), 1.0)
    return replace(result, steps=result.steps | {"load": load, "stored_energy": energy})


@pytest.mark.parametrize("fault", [softer, steeper, arched])
@pytest.mark.parametrize("kinematics", ["linear", "finite"])
@pytest.mark.parametrize("words", [ORTHOTROPIC, ISOTROPIC, SLENDER])
def test_unloading_off_the_secant_by_three_percent(
    fault: Callable[[Result, float], Result], kinematics: str, words: tuple[str, ...]
) -> None:
    programme = "[2.0, 0.3, 4.0]" if words is SLENDER else "[0.3, 0.05, 0.5]"
    scene = scene_of(words, f"effects.kinematics={kinematics}", COARSE, f"load.opening={programme}")
    right = solve(scene, "nurbs")
    assert secant(scene, right).state == "holds"
    found = secant(scene, fault(right, 0.03))
    assert found.state == "broken"


@pytest.mark.parametrize("name", ["enf-as4peek", "slb"])
def test_a_bond_that_slides(name: str) -> None:
    end = 3.5 if name == "enf-as4peek" else 2.0
    scene = load_scene(name, [f"load.opening=[{end}, {0.1 * end}]", "effects.kinematics=linear"])
    right = solve(scene, "nurbs")
    assert secant(scene, right).value < 1e-6
    assert all(secant(scene, fault(right, 0.03)).state == "broken" for fault in (softer, steeper))


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_a_bond_that_keeps_an_opening(kinematics: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its points unload 3 % steeper than along their secants, in the solver itself."""
    traction = TractionLaw.traction

    def steep(
        self: TractionLaw, g: np.ndarray, k: np.ndarray, closed: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        p, slope, k_new = traction(self, g, k, closed)
        unloads = (g > 0.0) & (g < k_new) & (k_new > self.g_max)
        stiff = self.secant(k_new)
        return (
            np.where(unloads, stiff * (1.03 * g - 0.03 * k_new), p),
            np.where(unloads, 1.03 * stiff, slope),
            k_new,
        )

    monkeypatch.setattr(TractionLaw, "traction", steep)
    scene = scene_of(ISOTROPIC, f"effects.kinematics={kinematics}", COARSE, "load.opening=[0.3, 0.05, 0.5]")
    assert secant(scene, solve(scene, "nurbs")).state == "broken"
