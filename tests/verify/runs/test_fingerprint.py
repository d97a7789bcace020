"""What a kept run rests on: solvers, theory, checks and scenes, whose change makes it again; no page, no command."""

from __future__ import annotations

import shutil

import pytest

from verify.runs import fingerprint as fingerprints
from verify.runs.fingerprint import PROJECT, fingerprint
from verify.scene.load import load_scene

#: Files of the project, and the methods of which a word changed there makes a run again.
RESTS_ON = {
    "verify/command_line/doctor.py": (),
    "verify/pages/text.py": (),
    "verify/report/section.py": (),
    "verify/studies/cost/study.py": (),
    "verify/theory/law.py": ("nurbs", "dolfinx", "beam"),
    "verify/theory/arms/solve.py": ("nurbs", "dolfinx", "beam"),
    "verify/checks/identities.py": ("nurbs", "dolfinx", "beam"),
    "verify/checks/mechanics/j_integral.py": ("nurbs", "dolfinx", "beam"),
    "verify/scene/effects.py": ("nurbs", "dolfinx", "beam"),
    "verify/methods/built_in/iga.py": ("nurbs", "dolfinx", "beam"),
    "verify/result.py": ("nurbs", "dolfinx", "beam"),
    "iga/path/newton.py": ("nurbs",),
    "fem_reference/model/forms.py": ("dolfinx",),
}


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The source of the project, to be changed."""
    place = tmp_path_factory.mktemp("project")
    for name in ("verify", "iga", "fem_reference"):
        shutil.copytree(PROJECT / name, place / name, ignore=lambda folder, names: {"__pycache__"} & set(names))
    return place


@pytest.mark.parametrize("file", RESTS_ON)
def test_a_word_changed_makes_again_what_rests_on_it(file, copy, monkeypatch):
    scene, methods = load_scene("dcb-czm1"), ("nurbs", "dolfinx", "beam")
    monkeypatch.setattr(fingerprints, "PROJECT", copy)

    def keys() -> list[str]:
        fingerprints._content.cache_clear()  # of a process whose source stays as it is
        return [fingerprint(scene, method) for method in methods]

    before, text = keys(), (copy / file).read_text()
    assert before == keys()
    try:
        (copy / file).write_text(text + "# another word\n")
        changed = tuple(m for m, old, new in zip(methods, before, keys(), strict=True) if old != new)
    finally:
        (copy / file).write_text(text)
        fingerprints._content.cache_clear()
    assert changed == RESTS_ON[file]


def test_the_hash_tells_what_else_a_result_rests_on(monkeypatch):
    scene = load_scene("dcb-czm1")
    same = fingerprint(scene, "nurbs")
    assert same == fingerprint(load_scene("dcb-czm1"), "nurbs")
    others = [
        fingerprint(load_scene("dcb-czm1", ["interface.strength=4.001"]), "nurbs"),
        fingerprint(scene, "tspline"),
        fingerprint(scene, "nurbs", "repeat 1"),
    ]
    for name, value in (("machine", {"processor": "another"}), ("versions", {"numpy": "1"})):
        with monkeypatch.context() as changed:
            changed.setattr(fingerprints, name, lambda value=value: value)
            others.append(fingerprint(scene, "nurbs"))
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    others.append(fingerprint(scene, "nurbs"))
    assert len({same, *others}) == 1 + len(others)
