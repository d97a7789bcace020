"""Two load-opening curves, of one's own or of somebody else's code."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from verify.curve import curve_error
from verify.refusal import Refusal


class CurveError(Refusal):
    """A file that holds no curve."""


def read_curve(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Opening (n,) and load (n,) of a file or of the folder of a run.

    A header must name ``opening`` and ``load``, in any order among others; without one the first two columns count.
    Commas, semicolons, tabs and blanks separate; lines that begin with # are skipped.

    Raises
    ------
    CurveError
        Naming the file and the line.
    """
    path = path / "curve.csv" if path.is_dir() else path
    try:
        text = path.read_bytes().decode()
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or "not a text in UTF-8"
        raise CurveError(f"{path}: must be a file with a curve, got: {why}") from None
    lines = [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1)]
    rows = [(i, _cells(line)) for i, line in lines if line and not line.startswith("#")]
    if not rows:
        raise CurveError(f"{path}: must hold a curve of at least 2 points, got an empty file")
    columns, body = _columns(path, rows)
    points = np.array([_point(path, i, cells, columns) for i, cells in body])
    if len(points) < 2 or not np.ptp(points[:, 0]) > 0:
        raise CurveError(f"{path}: must hold at least 2 points of different opening, got {len(points)}")
    if np.max(points[:, 0]) <= 0:
        raise CurveError(f"{path}: the openings must go above 0, got at most {np.max(points[:, 0]):g}")
    return points[:, 0], points[:, 1]


def compare(a: Path, b: Path) -> dict[str, float]:
    """Curve error of ``a`` against ``b`` over the openings that both reach, and the ratio of their peaks minus one."""
    (opening_a, load_a), (opening_b, load_b) = read_curve(a), read_curve(b)
    end = float(min(opening_a.max(), opening_b.max()))
    return {
        "curve_error": curve_error((opening_a, load_a), (opening_b, load_b), end),
        "peak_difference": float(load_a.max() / load_b.max() - 1) if load_b.max() else np.nan,
        "end": end,
    }


def _cells(line: str) -> list[str]:
    separator = next((s for s in ",;\t" if s in line), None)
    return [cell.strip().strip('"') for cell in line.split(separator)]


def _columns(path: Path, rows: list[tuple[int, list[str]]]) -> tuple[tuple[int, int], list[tuple[int, list[str]]]]:
    """Which columns are opening and load, and the rows below the header."""
    number, first = rows[0]
    if all(_is_number(cell) for cell in first):
        if len(first) < 2:
            raise CurveError(f"{path}:{number}: must have two columns, opening and load, got 1")
        return (0, 1), rows
    names = [cell.lower() for cell in first]
    missing = [name for name in ("opening", "load") if name not in names]
    if missing:
        raise CurveError(f"{path}:{number}: the header must name {' and '.join(missing)}, got {', '.join(first)[:100]}")
    return (names.index("opening"), names.index("load")), rows[1:]


def _point(path: Path, line: int, cells: list[str], columns: tuple[int, int]) -> tuple[float, float]:
    opening, load = (cells[c] if c < len(cells) else "nothing" for c in columns)
    if not (_is_number(opening) and _is_number(load)):
        raise CurveError(f"{path}:{line}: opening and load must be finite numbers, got {opening[:30]} and {load[:30]}")
    return float(opening), float(load)


def _is_number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False
