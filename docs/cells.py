"""Examples as pages: the cells of a script in percent format, run one after the other with what each prints and draws.

python cells.py SCRIPT FOLDER     runs the script; writes FOLDER/STEM.md and the pictures
python cells.py SCRIPT.ipynb      writes the script of that name as a notebook
"""

from __future__ import annotations

import contextlib
import io
import json
import re
import shutil
import sys
import tempfile
import textwrap
from dataclasses import dataclass
from pathlib import Path

MARK = re.compile(r"^# %%(.*)\n", re.MULTILINE)


@dataclass(frozen=True)
class Cell:
    """Prose, in Markdown without its comment signs, or code with the line of the script where it begins."""

    text: str
    prose: bool
    line: int


@dataclass(frozen=True)
class Output:
    """What a cell has printed, and the names of the pictures that it has drawn."""

    printed: str = ""
    pictures: tuple[str, ...] = ()


def split(source: str) -> tuple[Cell, ...]:
    """The cells of a script.

    Raises
    ------
    ValueError : code before the first mark, a mark of an unknown kind, or code in a cell of prose.
    """
    parts = MARK.split(source)
    if parts[0].strip():
        raise ValueError("the script begins without a cell: # %%")
    cells, line = [], 1 + parts[0].count("\n")
    for kind, text in zip(parts[1::2], parts[2::2], strict=True):
        if kind.strip() not in ("", "[markdown]"):
            raise ValueError(f"line {line}: a cell is # %% or # %% [markdown], got # %%{kind}")
        prose = bool(kind.strip())
        cells.append(Cell(_prose(text, line) if prose else text.strip("\n"), prose, line + 1))
        line += 1 + text.count("\n")
    return tuple(cells)


def _prose(text: str, line: int) -> str:
    rows = text.strip("\n").split("\n")
    for number, row in enumerate(rows):
        if row.strip() and not row.startswith("#"):
            raise ValueError(f"line {line + 1 + number}: prose is commented out, got {row!r}")
    return "\n".join(row.removeprefix("#").removeprefix(" ") for row in rows)


def run(script: Path, folder: Path) -> list[tuple[Cell, Output]]:
    """Run a script cell by cell; pictures go into the folder, whatever it writes beside itself goes nowhere."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    done, drawn = [], set()
    with tempfile.TemporaryDirectory() as elsewhere:
        copy = shutil.copy(script, elsewhere)
        names = {"__name__": "__main__", "__file__": str(copy)}
        for cell in split(script.read_text(encoding="utf-8")):
            printed, pictures = io.StringIO(), []
            if not cell.prose:
                code = compile("\n" * (cell.line - 1) + cell.text, str(script), "exec")
                with contextlib.redirect_stdout(printed):
                    exec(code, names)
                for number in sorted(set(pyplot.get_fignums()) - drawn):
                    pictures.append(f"{script.stem}-{number}.png")
                    pyplot.figure(number).savefig(folder / pictures[-1], dpi=130)
                    drawn.add(number)
            done.append((cell, Output(printed.getvalue(), tuple(pictures))))
    return done


def page(script: Path, done: list[tuple[Cell, Output]]) -> str:
    """The script as Markdown, with what it printed and drew."""
    parts = []
    for cell, output in done:
        parts.append(cell.text if cell.prose else _fenced("python", cell.text))
        if output.printed.strip():
            rows = [row for text in output.printed.rstrip().split("\n") for row in _folded(text)]
            parts.append(_fenced("text", "\n".join(rows)))
        parts += [f"![what {script.name} draws]({name})" for name in output.pictures]
    parts.append(f"This page is a script, [{script.name}]({script.name}), as it ran when the page was made.")
    return "\n\n".join(parts) + "\n"


def notebook(source: str) -> str:
    """A script as a Jupyter notebook, format 4.5, whose cells have not been run."""
    parts = []
    for number, cell in enumerate(split(source)):
        shown = {"id": f"cell-{number}", "metadata": {}, "source": cell.text.strip("\n").splitlines(keepends=True)}
        of_code = {} if cell.prose else {"execution_count": None, "outputs": []}
        parts.append({"cell_type": "markdown" if cell.prose else "code", **shown, **of_code})
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    whole = {"cells": parts, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def _fenced(language: str, text: str) -> str:
    return f"```{language}\n{text}\n```"


def _folded(row: str) -> list[str]:
    return textwrap.wrap(row, 110, subsequent_indent="    ", drop_whitespace=False) or [""]


if __name__ == "__main__":
    script, folder = Path(sys.argv[1]).with_suffix(".py"), Path(sys.argv[-1])
    if len(sys.argv) == 2:
        folder.write_text(notebook(script.read_text(encoding="utf-8")), encoding="utf-8")
        sys.exit()
    sys.argv = [str(script), "--quick"]  # what an example may take, and others do not read
    (folder / f"{script.stem}.md").write_text(page(script, run(script, folder)), encoding="utf-8")
