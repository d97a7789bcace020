"""Pages where the packages for them are missing."""

from __future__ import annotations

from pathlib import Path

import pytest

from verify.say import write_page


def test_a_page_that_cannot_be_drawn_is_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    (tmp_path / "a_page.py").write_text("import not_installed\n")
    monkeypatch.syspath_prepend(tmp_path)
    write_page("a_page")
    assert capsys.readouterr().err == "debond: no report: not_installed is missing; pip install 'debond[report]'\n"
