"""Pages where the packages for them are missing."""

import subprocess
import sys
from pathlib import Path

import pytest

from verify.support.say import write_page


def test_a_page_that_cannot_be_drawn_is_a_sentence(tmp_path, monkeypatch, capsys):
    (tmp_path / "a_page.py").write_text("import not_installed\n")
    monkeypatch.syspath_prepend(tmp_path)
    write_page("a_page")
    assert capsys.readouterr().err == "debond: no report: not_installed is missing; pip install 'debond[report]'\n"


#: Imports every page with nothing else of the project there.
IMPORTS = """
import sys
from importlib import import_module
for name in ("report", "studies.pairs_page", *(f"studies.{one}.page" for one in ("cost", "hard", "law", "reduce"))):
    for known in [known for known in sys.modules if known.partition(".")[0] in ("verify", "iga", "fem_reference")]:
        del sys.modules[known]
    assert callable(import_module(f"verify.{name}").write)
"""


def test_a_page_can_be_imported_first():
    """As the command whose page it is does: no circle of imports."""
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    command = [sys.executable, "-c", IMPORTS]
    assert subprocess.run(command, cwd=Path(__file__).parents[3], capture_output=True, text=True).stderr == ""
