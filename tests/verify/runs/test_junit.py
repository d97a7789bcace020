"""JUnit XML of a verification: what a CI system reads in it, and that no text of a user breaks it."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

from verify import verification
from verify.checks.judgement import Demands, Gap, Judgement
from verify.cli import main
from verify.runs import junit
from verify.runs.jobs import Job
from verify.verdict import Check

HOSTILE = '<&">]]>\x00\x1b\ud800 "ä"'
CHECKS = (
    ("dcb", Check("energy", "nurbs", 1e-4, 5e-3, "exact", "Nothing is lost.")),
    ("dcb", Check("curve", "nurbs / dolfinx", -0.02, 5e-3, "cross-code", HOSTILE)),
    ("dcb", Check("peak", "nurbs", float("nan"), 5e-3, "cross-code", "A peak.")),
    ("dcb", Check("j-integral", "nurbs", 0.1, 1e-2, "exact", "J.", unresolved="too coarse; refine")),
)
GAPS = (
    Gap("dcb", "dolfinx", "", "DOLFINx is not installed"),
    Gap("dcb", "nurbs", "j-integral", "too coarse; refine", "unresolved"),
)


def suite(file: Path) -> ElementTree.Element:
    """The suite, of the structure that pytest itself writes and that the readers of CI systems ask for."""
    root = ElementTree.parse(file).getroot()
    (found,) = root
    assert root.tag == "testsuites" and found.tag == "testsuite" and {case.tag for case in found} <= {"testcase"}
    assert {"name", "tests", "failures", "errors", "skipped", "time"} <= found.attrib.keys()
    for case in found:
        assert {"classname", "name", "time"} <= case.attrib.keys() and len(case) <= 1
        assert all(one.tag in ("failure", "skipped") and one.get("message") for one in case)
    for key, tag in (("failures", "failure"), ("skipped", "skipped"), ("tests", ".")):
        assert int(found.get(key)) == len(found.findall(f"testcase/{tag}"))
    return found


def outcomes(file: Path) -> list[tuple[str, str]]:
    cases = suite(file)
    return [(case.get("classname") + ":" + case.get("name"), case[0].tag if len(case) else "") for case in cases]


def test_states_are_outcomes(tmp_path):
    file = tmp_path / "junit.xml"
    junit.write(file, Judgement(CHECKS, GAPS, Demands()))
    assert outcomes(file) == [
        ("dcb.nurbs:energy", ""),
        ("dcb.nurbs:curve / dolfinx", "failure"),
        ("dcb.nurbs:peak", "failure"),
        ("dcb.nurbs:j-integral", "skipped"),
        ("dcb.dolfinx:completed", "skipped"),
    ]
    skipped = [case.get("message") for case in suite(file).iter("skipped")]
    assert skipped == ["too coarse; refine", "DOLFINx is not installed"]
    text = suite(file).find("testcase/failure").text
    assert '<&">]]>' in text and '"ä"' in text and "0.02 must be at most 0.005" in suite(file)[1][0].get("message")


@pytest.mark.parametrize(("demands", "failed"), [(Demands(True), 4), (Demands(required=("dolfinx",)), 3)])
def test_what_is_demanded_has_failed_where_it_was_not_judged(tmp_path, demands, failed):
    junit.write(tmp_path / "junit.xml", Judgement(CHECKS, GAPS, demands))
    assert int(suite(tmp_path / "junit.xml").get("failures")) == failed


def test_the_command_writes_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(verification, "planned", lambda source, scene, *_: [Job(source, scene, "beam", "beam")])
    words = ["verify", "dcb-czm1-linear", "--no-ladder", "--out", str(tmp_path / "out"), "--junit"]
    assert main([*words, str(tmp_path / "ci" / "junit.xml")]) == 0
    found = outcomes(tmp_path / "ci" / "junit.xml")
    assert len(found) > 3 and {name.partition(":")[0] for name, _ in found} == {"dcb-czm1-linear.beam"}
    capsys.readouterr()
    assert main([*words, str(tmp_path)]) == 2
    assert f"--junit: must be a file that can be written, got {str(tmp_path)!r}: " in capsys.readouterr().err
