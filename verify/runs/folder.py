"""The folder of a run: curve.csv and evidence.csv are written step by step, result.json and fields at the end."""

from __future__ import annotations

import csv
import errno
import hashlib
import json
import math
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, fields
from io import FileIO
from pathlib import Path
from typing import Any

import numpy as np

from verify.curves.of_run import Midpoints
from verify.result import CURVE_COLUMNS, EVIDENCE_COLUMNS, SLIDING_COLUMNS, Result, Snapshot, support_columns
from verify.support.checked_files import ANY, NUMBER, Damaged, number, read_json
from verify.support.refusal import Refusal

TABLES = ("curve.csv", "evidence.csv")
FILES = (*TABLES, "result.json", "fields.npz", "error.log")

#: errno values of a disk that is full, over a quota or limit, read-only, or broken.
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EIO)


class CurveWriter:
    """Writes every row immediately, so that a killed run leaves a valid, shorter file.

    ``evidence.csv`` has the converged points alone; ``curve.csv`` also the middle of every step, if it is asked for.
    """

    def __init__(self, folder: Path, middles: bool = False) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        for name in reversed(FILES):  # files of an earlier run are none of this one; curve.csv, its mark, last
            (folder / name).unlink(missing_ok=True)
        self._folder = folder
        self._curve_columns: tuple[str, ...] = CURVE_COLUMNS
        self._curve = _opened(folder / "curve.csv", self._curve_columns)
        self._evidence: FileIO | None = None
        self._columns: tuple[str, ...] = ()
        self._middle_of = Midpoints() if middles else None
        self.interpolated = 0

    def __call__(self, row: Mapping[str, float]) -> None:
        middle = None if self._middle_of is None else self._middle_of(row)
        if middle is not None:
            self._drawn(middle)
            self.interpolated += 1
        if self._evidence is None:
            self._begin(row)
        else:
            self._drawn(row)
        assert self._evidence is not None
        _append(self._evidence, self._columns, row)

    def _begin(self, row: Mapping[str, float]) -> None:
        """The columns that the first row has, and zeros for all of curve.csv, the crack length included."""
        known = (*CURVE_COLUMNS, *EVIDENCE_COLUMNS, *support_columns(row))
        self._columns = tuple(name for name in known if name in row)
        self._evidence = _opened(self._folder / "evidence.csv", self._columns)
        if any(name in row for name in SLIDING_COLUMNS):
            self._curve.close()
            self._curve_columns = (*CURVE_COLUMNS, *SLIDING_COLUMNS)
            self._curve = _opened(self._folder / "curve.csv", self._curve_columns)
        self._drawn(dict.fromkeys(self._curve_columns, 0.0))

    def _drawn(self, row: Mapping[str, float]) -> None:
        _append(self._curve, self._curve_columns, dict.fromkeys(self._curve_columns, math.nan) | dict(row))

    def close(self) -> None:
        for stream in (self._curve, self._evidence):
            if stream is not None:
                stream.close()


def refuse_files_of_others(folder: Path) -> None:
    """Refuse to write into a folder whose curve.csv, or else result.json, is not that of a run.

    Raises
    ------
    Refusal : naming the files.
    """
    there = [name for name in ("curve.csv", "result.json") if (folder / name).exists()]
    if there and not _is_of_a_run(folder / there[0]):
        names = ", ".join(there)
        raise Refusal(
            f"--out: must be a folder whose {names} a run has written, got those of others in {str(folder)!r}"
        )


def _is_of_a_run(file: Path) -> bool:
    """Whether a file is empty or begins as one of a run: curve.csv with its header, result.json with its keys."""
    begins = (",".join(CURVE_COLUMNS).encode(), b'{"scene"', b'{"method"')
    with file.open("rb") as stream:
        found = b"".join(stream.read(1000).split())
    return not found or found.startswith(begins)


def write_json(path: Path, content: Mapping[str, Any], compact: bool = False) -> None:
    """Write to a temporary file and rename it, so that the file is whole or absent. NaN and infinity become null.

    ``compact``: lists of numbers, and lists of these, are a line each.
    """
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    text = json.dumps(_finite(content), indent=2) + "\n"
    for inside in (r"[^][{}\"]", r"(?:\[[^][{}\n]*\]|[,\s])") if compact else ():
        text = re.sub(rf"\[\n({inside}+)\n\s*\]", lambda one: f"[{' '.join(one[1].split())}]", text)
    try:
        beside.write_text(text)
        beside.replace(path)
    except OSError as error:  # the error of a full disk has no file name
        beside.unlink(missing_ok=True)
        raise OSError(error.errno, error.strerror, str(path)) from None


def write_csv(path: Path, kind: type, rows: Iterable[Any]) -> None:
    """Write one line per row; the columns are the fields of ``kind``, the dataclass of the rows."""
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, [field.name for field in fields(kind)])
        writer.writeheader()
        writer.writerows(asdict(row) for row in rows)


def write_fields(path: Path, snapshots: tuple[Snapshot, ...]) -> None:
    """All snapshots in one compressed file, keys ``0.gap_q``, ``0.s_q``, ... ``1.gap_q``, ..."""
    arrays = {f"{i}.{key}": value for i, snapshot in enumerate(snapshots) for key, value in asdict(snapshot).items()}
    beside = path.with_name(f".{os.getpid()}.{path.name}")  # savez adds the suffix if it is missing
    np.savez_compressed(beside, **arrays)
    beside.replace(path)


def read_columns(path: Path) -> dict[str, np.ndarray]:
    """Columns of a CSV file with a header; an incomplete last row of a killed run is dropped."""
    with path.open(newline="") as stream:
        header, *rows = csv.reader(stream)
    rows = [row for row in rows if len(row) == len(header) and all(row)]
    return {name: np.array([float(row[i]) for row in rows]) for i, name in enumerate(header)}


#: Layout of the entries of result.json that are read; the others are for users and their scripts.
_RESULT = {
    "method": str,
    "status": str,
    "steps": int,
    "dofs": float,
    "elements": float,
    "rejected_steps": float,
    "peak_memory_mb": float,
    "seconds": {ANY: float},
    "ending?": str,
    "counted_steps?": str,
    "condition?": NUMBER,
    "nonzeros?": float,
    "jit_seconds?": float,
    "interpolated_rows?": int,
    "sha256?": {ANY: str},
}


#: Those that are fields of a `Result`.
_TOLD = {field.name for field in fields(Result)} & {key.removesuffix("?") for key in _RESULT} - {"steps"}


def read_result(folder: Path) -> Result:
    """The result in the folder of a run; without result.json the run counts as stopped.

    Raises
    ------
    Damaged : a file is not as a run wrote it.
    """
    evidence = folder / "evidence.csv"
    try:
        steps = read_columns(evidence) if evidence.exists() else {name: np.zeros(0) for name in CURVE_COLUMNS}
    except (OSError, ValueError, csv.Error) as error:
        raise Damaged(evidence, error) from None
    if not {"opening", "load"} <= steps.keys():
        raise Damaged(evidence, f"the columns {', '.join(steps)}"[:200])
    about = folder / "result.json"
    if not about.exists():
        return Result(method="", steps=steps, status="stopped: the run was killed")
    known = read_json(about, _RESULT)
    told = {key: value for key, value in known.items() if key in _TOLD}
    if "condition" in told:
        told["condition"] = number(told["condition"])
    return Result(steps=steps, snapshots=read_fields(folder / "fields.npz"), **told)


def hashes(folder: Path) -> dict[str, str]:
    """SHA-256 of the curve and of its evidence, those that are there, as hexadecimal digits."""
    files = [folder / name for name in TABLES if (folder / name).exists()]
    return {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in files}


def changed(folder: Path) -> str:
    """A sentence where a table in the folder of a run is not the one that the run wrote; empty where it is."""
    try:
        known = read_json(folder / "result.json", _RESULT).get("sha256", {})
        now = hashes(folder)
    except (OSError, Damaged):
        return ""
    for name, digest in known.items():
        if now.get(name, digest) != digest:
            found, written = now[name][:8], digest[:8]
            return f"{folder / name}: has been changed since the run wrote it: SHA-256 {found}..., then {written}..."
    return ""


def damage(folder: Path, proof: str) -> str:
    """Name of a file of a stored result that is not as it was written, or empty; ``proof`` is the one that was written
    last."""
    try:
        content = (folder / proof).read_bytes()
        about = json.loads(content) if proof.endswith(".json") else {}
        if proof != "result.json":
            return ""
        read_result(folder)
        now = hashes(folder)
        return next((name for name, digest in about.get("sha256", {}).items() if now.get(name) != digest), "")
    except Damaged as error:
        return error.path.name
    except (OSError, ValueError):
        return proof


def read_fields(path: Path) -> tuple[Snapshot, ...]:
    """The snapshots of ``write_fields``; empty without the file.

    Raises
    ------
    Damaged : the file has other content.
    """
    if not path.exists():
        return ()
    names = [field.name for field in fields(Snapshot)]
    try:
        with np.load(path, allow_pickle=False) as arrays:
            count = len({key.split(".")[0] for key in arrays})
            tables = [{name: arrays[key] for name in names if (key := f"{i}.{name}") in arrays} for i in range(count)]
        return tuple(_snapshot(table) for table in tables)
    except Exception as error:  # NumPy, zip and zlib raise various errors
        raise Damaged(path, error) from None


def _snapshot(table: Mapping[str, np.ndarray]) -> Snapshot:
    """A snapshot whose arrays have consistent shapes."""
    scalars = ("opening", "load")
    values: dict[str, Any] = {name: float(array) if name in scalars else array for name, array in table.items()}
    found = Snapshot(**values)
    sizes = {len(array) for array in (found.s_q, found.gap_q, found.traction_q, found.damage_q)}
    grids = found.X_euvi.shape == found.u_euvi.shape and found.stress_euv.shape in (found.X_euvi.shape[:-1], (0,))
    sliding = {len(found.slip_q), len(found.shear_q)} in ({0}, sizes)
    if not (grids and sliding and len(sizes) == 1 and all(array.dtype.kind in "fiu" for array in table.values())):
        raise ValueError("arrays that do not belong together")
    return found


def _opened(path: Path, columns: tuple[str, ...]) -> FileIO:
    stream = FileIO(path, "w")
    _write(stream, columns)
    return stream


def _append(stream: FileIO, columns: tuple[str, ...], row: Mapping[str, float]) -> None:
    _write(stream, [f"{float(row[name]):.17g}" for name in columns])


def _write(stream: FileIO, cells: Iterable[str]) -> None:
    """One write call per row, line end included: neither a reader nor a killed run nor a full disk leaves half a row,
    whose last number would be wrong.

    Raises
    ------
    OSError : with the name of the file.
    """
    start, rest = stream.tell(), (",".join(cells) + "\n").encode()
    try:
        while rest:
            rest = rest[stream.write(rest) :]
    except OSError as error:
        stream.truncate(start)
        raise OSError(error.errno, error.strerror, str(stream.name)) from None


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
