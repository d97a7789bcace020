"""Every example runs from top to bottom, its assertions hold, and it is a page that ends in one."""

import ast
import re
import runpy
import shutil
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]
SCRIPTS = sorted((PROJECT / "examples").glob("*.py"))
LONG = {
    "first_comparison",
    "what_accuracy_costs",
    "oscillation",
    "paper",
    "j_integral",
    "process_zone",
    "data_reduction",
    "t_junctions",
    "verify_your_own_code",  # as tests/test_own_code.py
}  # 10 s each on a core of their own
each = pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
once = pytest.mark.parametrize(
    "script",
    [pytest.param(path, id=path.stem, marks=[pytest.mark.slow] if path.stem in LONG else []) for path in SCRIPTS],
)


def cells(script: Path) -> list[tuple[str, str]]:
    """Heading and text of every cell."""
    parts = re.split(r"^# %%(.*)\n", script.read_text(), flags=re.MULTILINE)
    assert parts[0] == "", "a page begins with a cell"
    return list(zip(parts[1::2], parts[2::2], strict=True))


@once
def test_example(script, tmp_path, monkeypatch):
    copy = shutil.copy(script, tmp_path)  # pictures are written beside the script, or in a folder there
    monkeypatch.setattr(sys, "argv", [copy, "--quick"])
    runpy.run_path(str(copy), run_name="__main__")
    assert max(picture.stat().st_size for picture in tmp_path.rglob("*.png")) > 10_000


@each
def test_an_example_reads_as_a_page(script):
    first, *_ = page = cells(script)
    assert first[0] == " [markdown]" and re.match(r"# # \S", first[1])
    for kind, text in page:
        assert kind in ("", " [markdown]") and text.strip()
        if kind:
            assert all(line.startswith("#") for line in text.strip().splitlines()), text


@each
def test_the_last_cell_asserts_a_computed_number(script):
    kind, text = cells(script)[-1]
    asserted = [node.test for node in ast.parse(text).body if isinstance(node, ast.Assert)]
    assert kind == "" and asserted and isinstance(ast.parse(text).body[-1], ast.Assert)
    for test in asserted:
        compared = [node for node in ast.walk(test) if isinstance(node, ast.Compare)]
        assert compared
        for compare in compared:
            sides = [compare.left, *compare.comparators]
            assert any(isinstance(n, ast.Name) for side in sides for n in ast.walk(side)), "numbers against numbers"
            assert any(isinstance(n, ast.Constant) for side in sides for n in ast.walk(side)), "no limit is stated"
