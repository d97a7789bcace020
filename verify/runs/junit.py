"""A verification as JUnit XML, which CI systems show: a test case a check."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

from verify.checks.judgement import Gap, Judgement, gap_of
from verify.verdict import Check

#: What XML 1.0 cannot hold, in whatever spelling.
NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write(path: Path, judgement: Judgement) -> None:
    """Write one test suite; its class names are SCENE.METHOD, its failures broken checks and demands that are not met.

    A check that could not judge, and a method that is not installed, are skipped with their reason. Where the demands
    of `--strict` or `--require` forbid that, they have failed: the suite fails where the verification does.
    """
    cases = [_checked(scene, check, judgement) for scene, check in judgement.checks]
    cases += [_left_out(gap, judgement) for gap in judgement.gaps if not gap.check]
    counts = {tag: str(sum(case.find(tag) is not None for case in cases)) for tag in ("failure", "skipped")}
    about = {"tests": str(len(cases)), "failures": counts["failure"], "errors": "0", "skipped": counts["skipped"]}
    root = ElementTree.Element("testsuites")
    suite = ElementTree.SubElement(root, "testsuite", {"name": "debond verify", **about, "time": "0"})
    suite.extend(cases)
    ElementTree.indent(root)
    path.write_bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))


def _checked(scene: str, check: Check, judgement: Judgement) -> ElementTree.Element:
    method, _, against = check.subject.partition(" / ")
    case = _case(scene, method, f"{check.name} / {against}" if against else check.name)
    numbers = f"{abs(check.value):.3g} must be at most {check.tolerance:.3g}"
    if check.state == "broken":
        _outcome(case, "failure", numbers, f"{check.meaning}\n{check.kind}")
    elif not check.passed:
        gap = gap_of(scene, check)
        _outcome(case, "failure" if gap in judgement.lacking else "skipped", check.unresolved, check.meaning)
    return case


def _left_out(gap: Gap, judgement: Judgement) -> ElementTree.Element:
    case = _case(gap.scene, gap.subject, "completed")
    _outcome(case, "failure" if gap in judgement.lacking else "skipped", gap.why, "not run")
    return case


def _case(scene: str, method: str, name: str) -> ElementTree.Element:
    about = {"classname": f"{scene}.{method}", "name": name}
    return ElementTree.Element("testcase", {**{key: _clean(text) for key, text in about.items()}, "time": "0"})


def _outcome(case: ElementTree.Element, tag: str, message: str, text: str) -> None:
    ElementTree.SubElement(case, tag, {"message": _clean(message)}).text = _clean(text)


def _clean(text: str) -> str:
    return NO_XML.sub("\ufffd", text)
