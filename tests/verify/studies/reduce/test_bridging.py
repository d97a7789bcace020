"""Laws by which fibres bridge: truth, curve of the cohesive beam, law, and back."""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.methods.solve import solve
from verify.reduction.coupon import coupon
from verify.reduction.data import Measured
from verify.reduction.reduce import reduce
from verify.result import Result
from verify.scene.bond.opening import law_of
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.scene.toml import scene_file
from verify.studies.reduce import bridging
from verify.studies.reduce.bridging import Bridging, bridged

WIDTH, PRECRACK, ROWS = 25.4, 50.0, 1000


@dataclass(frozen=True)
class Truth:
    """A tip of a strength and a toughness, and lines of (stress, end) that bridge; a test with noise of the load."""

    strength: float
    tip: float
    lines: tuple[tuple[float, float], ...]
    thickness: float
    ductility: float
    noise: float

    @property
    def bridging(self) -> float:
        return sum(0.5 * stress * end for stress, end in self.lines)

    @property
    def ends(self) -> float:
        return max(end for _, end in self.lines)

    def stress(self, w: float) -> float:
        return sum(stress * max(1.0 - w / end, 0.0) for stress, end in self.lines)

    @property
    def scene(self) -> Scene:
        """The opening goes on until the precrack has opened 1.4 times as far as anything bridges."""
        broken = 2.0 * self.tip / self.strength
        corners = sorted({broken / self.ductility, broken, *(end for _, end in self.lines)})
        peak = self.strength, *[0.0] * len(corners)
        table = [[w, self.stress(w) + first] for w, first in zip(corners, peak, strict=False)]
        EI = 123.4e3 * WIDTH * self.thickness**3 / 12.0
        M, L = ((self.tip + self.bridging) * WIDTH * EI) ** 0.5, np.linspace(PRECRACK, 1000.0, 200000)
        w = M / L / (3.0 * EI) * (L - PRECRACK) ** 2 * (2.0 * L + PRECRACK)
        a = max(L[np.searchsorted(w, 1.4 * max(self.ends, 5.0 * broken))], PRECRACK + 35.0)
        zone = 2.0 * (EI / WIDTH * self.ends / sum(stress for stress, _ in self.lines)) ** 0.25
        return load_scene(
            "dcb-as4peek",
            (
                f'interface={{law="tabular", table={table}}}', f"specimen.length={float(a + 3.0 * zone + 20.0)!r}",
                f"specimen.precrack={PRECRACK}", f"specimen.arm_thickness={self.thickness!r}", "beam.in_a_zone=12",
                f"load.opening={float(2.0 * M * a**2 / (3.0 * EI))!r}", 'effects.kinematics="linear"',
            ),
        )  # fmt: skip


def truths() -> list[Truth]:
    """Twenty of the ranges in which laminates are; every second with 0.5 % noise, two of four with a kink."""
    random, made = np.random.default_rng(20), []
    for i in range(20):
        ranges = ((10.0, 60.0), (0.1, 0.5), (0.1, 1.5), (0.3, 5.0))
        strength, tip, toughness, stress = (float(np.exp(random.uniform(*np.log(one)))) for one in ranges)
        thickness, ductility = float(random.uniform(1.5, 4.0)), float(random.uniform(12.0, 50.0))
        end = 2.0 * toughness / stress
        kinked = (0.7 * stress, 0.25 * end / 0.475), (0.3 * stress, end / 0.475)
        lines = kinked if i % 4 >= 2 else ((stress, end),)
        made.append(Truth(strength, tip, lines, thickness, ductility, 0.005 * (i % 2)))
    return made


TRUTHS = truths()
#: The truth whose bridges are gone at twice the opening at which its tip breaks; the error of its law is 14 %.
NOT_APART = 9


@cache
def run(truth: Truth, code: str = "beam") -> Result:
    return solve(truth.scene, code)


def recorded(truth: Truth, code: str = "beam") -> Measured:
    opening, load, random = run(truth, code).opening, run(truth, code).load, np.random.default_rng(1)
    d = np.linspace(0.0, opening[-1], ROWS)
    P = np.interp(d, opening, load)
    return Measured("test", d, P + truth.noise * P.max() * random.standard_normal(ROWS), np.full(ROWS, np.nan))


def found(i: int) -> Bridging:
    truth = TRUTHS[i]
    return bridged(reduce(recorded(truth), coupon(truth.scene)), truth.scene)


def off(truth: Truth, one: Bridging) -> tuple[float, float]:
    """Toughness and stress above the tip against the truth: of areas, and in the mean over the end openings."""
    law, known = law_of(one.scene), law_of(truth.scene)
    w = np.linspace(max(one.law.first, 2.0 * truth.tip / truth.strength), truth.ends, 2000)
    above = [total.toughness - float(total.area(w[0])) for total in (law, known)]
    stress = np.abs(law.traction(w) - known.traction(w)).sum() / known.traction(w).sum()
    return above[0] / above[1] - 1.0, float(stress)


#: A line ends at twice the opening from which the law is resolved: a part of the tip counts as bridging.
SHORT_LINES = pytest.mark.xfail(strict=True, reason="toughness above the tip is 11 % (2) and 15 % (19) too large")


@pytest.mark.parametrize(
    ("i", "corrections"),
    [
        (4, (1, 1)),
        *(
            pytest.param(i, (3, 7), marks=[pytest.mark.slow, *([SHORT_LINES] if i in (2, 19) else [])])
            for i in range(20)
        ),
    ],
)
def test_a_law_comes_back_and_draws_the_test(i, corrections, monkeypatch):
    """Toughness above the tip within 10 %, stress within 15 %; and the curve of the law is that of the test."""
    monkeypatch.setattr(bridging, "CORRECTIONS", corrections)
    truth, one = TRUTHS[i], found(i)
    toughness, stress = off(truth, one)
    assert ("cannot be told from the tip" in " ".join(one.sentences)) == (i == NOT_APART)
    assert i == NOT_APART or (abs(toughness) < 0.1 and stress < 0.15)
    assert one.misfit < one.noise + 0.005


@pytest.mark.slow
@pytest.mark.parametrize(("i", "code", "back"), [(4, "dolfinx", "nurbs"), (13, "nurbs", "dolfinx")])
def test_a_law_comes_back_from_another_code(i, code, back):
    """Truth and round trip by codes of the plane, the law by the beam: stiffness, peak, and the law itself."""
    truth = TRUTHS[i]
    one = bridged(reduce(recorded(truth, code), coupon(truth.scene)), truth.scene)
    test, again = run(truth, code), solve(one.scene, back)
    toughness, stress = off(truth, one)
    assert abs(toughness) < 0.1 and stress < 0.15
    d = np.linspace(0.0, test.opening[np.argmax(test.load >= 0.5 * test.load.max())], 100)
    P, own = (np.interp(d, each.opening, each.load) for each in (test, again))
    assert own @ P / (P @ P) == pytest.approx(1.0, abs=5e-3)
    assert again.load.max() == pytest.approx(test.load.max(), rel=5e-3)


@pytest.mark.slow
def test_what_cannot_be_told_from_the_tip_is_said():
    """Bridges that are gone at three times the opening at which the tip breaks, on thick arms; a tip of 30 MPa."""
    truth = Truth(30.0, 0.3, ((5.0, 0.05),), 3.0, 20.0, 0.0)
    one = bridged(reduce(recorded(truth), coupon(truth.scene)), truth.scene)
    assert "cannot be told from the tip" in " ".join(one.sentences)
    assert sum(one.law.toughness) == pytest.approx(truth.tip + truth.bridging, rel=0.02)


def test_the_command_writes_a_scene_with_the_law(tmp_path, monkeypatch, capsys):
    """With a measured end opening, of a run that knows it; the page, and what is refused."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(bridging, "CORRECTIONS", (0, 0))
    truth = TRUTHS[4]
    Path("mine.toml").write_text(scene_file(truth.scene))
    steps = run(truth).steps
    rows = np.stack([steps["opening"], steps["load"], steps["tip_opening"]], axis=1)
    np.savetxt("test.csv", rows, delimiter=",", header="opening,load,end", comments="")
    words = ["reduce", "test.csv", "--scene", "mine.toml", "--bridging"]
    assert main([*words, "--end-opening", "end", "--out", "out"]) == 0
    said = json.loads(Path("out/reduce.json").read_text())["bridging"]
    above = said["above"] / float(law_of(truth.scene).toughness - law_of(truth.scene).area(said["first_opening"]))
    assert above == pytest.approx(1.0, abs=0.05) and "Bridging law" in Path("out/reduce.html").read_text()
    assert np.allclose(law_of(load_scene("out/bridging.toml")).table, said["table"])
    for more, sentence in (
        (["--scene", "enf-as4peek"], "--bridging: must be for dcb"),
        (["--scene", "enf-as4peek", "--end-opening", "end"], "end opening: must be of a dcb"),
        (["--linear", "0.98,1"], "10 rows with a resolved end opening or more"),
    ):
        assert main([*words, *more]) == 2
        assert sentence in capsys.readouterr().err.replace("\n", " ")
