"""The page on the Python interface: every public name is on it, and every example runs."""

from __future__ import annotations

import re
from pathlib import Path

import iga_files
import pytest

import iga
import verify
from verify import verification
from verify.runs.jobs import Job

PAGE = Path(__file__).parents[1] / "docs" / "pages" / "guide" / "python.md"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_every_example_runs(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")

    def few(source: str, scene: verify.Scene, *_: object) -> list[Job]:
        """Two quick methods instead of all."""
        return [Job(source, scene, "beam", "beam"), Job(source, scene, "lefm", "lefm")]

    monkeypatch.setattr(verification, "planned", few)
    monkeypatch.chdir(tmp_path)
    Path("plate.iga").write_text(iga_files.SMALL)
    text, names = PAGE.read_text(), {"__name__": "__main__"}
    for block in BLOCK.finditer(text):
        code = "\n" * text[: block.start(1)].count("\n") + block[1]
        exec(compile(code, str(PAGE), "exec"), names)
    assert Path("at-hand/report.html").stat().st_size > 50_000
    assert read(Path("at-hand/dcb-czm1/nurbs")) == read(names["result"])
    assert Path("verified/verdict.json").exists() and names["passed"] is True


def read(run: Path | verify.Result) -> list[float]:
    return (verify.read_curve(run)[1] if isinstance(run, Path) else run.load).tolist()


@pytest.mark.parametrize("package", [iga, verify], ids=["iga", "verify"])
def test_every_public_name_is_in_the_table_and_in_an_example(package):
    text = PAGE.read_text()
    table = re.findall(r"^\| (.+?) \|", text, re.MULTILINE)
    code = "\n".join(BLOCK.findall(text))
    for name in set(package.__all__) - {"__version__"}:
        assert any(f"`{name}`" in cell for cell in table), name
        assert f"{package.__name__}.{name}" in code, name
