"""Pages where the packages for them are missing."""

from __future__ import annotations

import sys

import pytest

from verify.say import write_page


def test_a_page_that_cannot_be_drawn_is_a_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in [name for name in sys.modules if name.startswith("verify.report")]:
        monkeypatch.delitem(sys.modules, name)
    write_page("verify.report")
    assert capsys.readouterr().err == "debond: no report: matplotlib is missing; pip install 'debond[report]'\n"
