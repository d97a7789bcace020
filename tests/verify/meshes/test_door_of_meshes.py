"""Whatever is in a deck, or in a file that is called a mesh: it is exported, or refused with a sentence."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import strategies as st
from odd_inputs import ANY_TEXT, DECK, LOWER, answered, deck_texts, few_and_many

from verify.export.command import FORMATS
from verify.meshes.read import MESH_ENDINGS

ENDINGS = st.sampled_from([*sorted(MESH_ENDINGS), ".vtk", ""])


def exported(mesh: Path, kind: str, capsys: pytest.CaptureFixture) -> tuple[int, str]:
    words = ("--set", f"specimen.mesh='{mesh}'", "--out", str(mesh.parent / "out"))
    return answered(capsys, "export", "dcb-czm1-linear", "--format", kind, *words)


def test_the_deck_is_one(tmp_path, capsys):
    (tmp_path / "x.inp").write_text(DECK)
    (tmp_path / "lower.inp").write_text(LOWER)
    assert exported(tmp_path / "x.inp", "abaqus", capsys) == (0, "")


def deck_is_answered(texts: tuple[str, str], kind: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    for name, text in zip(("x.inp", "lower.inp"), texts, strict=True):
        (tmp_path / name).write_bytes(text.encode("utf-8", "surrogatepass"))
    code, said = exported(tmp_path / "x.inp", kind, capsys)
    assert code != 2 or said.startswith("debond: ")


def file_is_answered(content: bytes, ending: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / f"x{ending}").write_bytes(content)
    code, said = exported(tmp_path / f"x{ending}", "csv", capsys)
    assert code == 2 and "specimen.mesh: " in said


test_decks, test_many_decks = few_and_many(
    deck_is_answered, many=2000, texts=deck_texts(), kind=st.sampled_from(FORMATS)
)
test_files, test_many_files = few_and_many(file_is_answered, many=500, content=ANY_TEXT, ending=ENDINGS)
