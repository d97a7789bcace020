"""Certified values that are kept in a checkout: the file of the package, and the table of the guide."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from itertools import groupby
from pathlib import Path
from typing import Any

from verify.scene.load import packaged_scenes
from verify.scene.stated.certified import CERTIFIED_FILE, entries, problem_key
from verify.studies.certified.study import Study
from verify.support.refusal import Refusal

#: The table of the guide stands between these lines of its page.
GUIDE_PAGE = Path(__file__).resolve().parents[3] / "docs" / "pages" / "guide" / "certified.md"
BEGIN, END = "<!-- written by debond certify -->", "<!-- to here -->"


def require_checkout() -> None:
    """Raises `Refusal` where there is no page of the guide beside the package, or it cannot be written."""
    if not GUIDE_PAGE.exists():
        raise Refusal(f"--keep: is for a checkout of the project, and there is none at {GUIDE_PAGE.parents[3]}")


def keep(study: Study, file: Path = CERTIFIED_FILE, page: Path = GUIDE_PAGE) -> None:
    """Replace the entry of the problem by its values and the sentences for those it lacks; write the table anew."""
    entries.cache_clear()  # another study may have written since this one began
    known: dict[str, Any] = {key: one for key, one in entries(file).items() if key != problem_key(study.scene)}
    known[problem_key(study.scene)] = {
        "scene": study.scene.name,
        "units": study.scene.units,
        "values": [asdict(one) for one in study.kept],
        "remarks": study.remarks,
    }
    ordered = dict(sorted(known.items(), key=lambda item: (item[1]["scene"], item[0])))
    file.write_text(json.dumps(ordered, indent=1) + "\n")
    entries.cache_clear()
    page.write_text(with_table(page.read_text(encoding="utf-8"), ordered), encoding="utf-8")


def with_table(text: str, known: Mapping[str, Mapping[str, Any]]) -> str:
    """The page with the table of all entries."""
    before, _, rest = text.partition(BEGIN)
    after = rest.partition(END)[2]
    return "\n".join([before + BEGIN, "", *table(known.values()), "", END + after])


def table(known: Iterable[Mapping[str, Any]]) -> list[str]:
    """Lines of Markdown: each value with its uncertainty and what keeping the pairs of points changes, the remarks of
    its scene, and every packaged scene that was not tried."""
    lines = ["| scene | quantity | value | U, 95 % | of the value | pairs kept |", "|---|---|---|---|---|---|"]
    rows = {scene: list(group) for scene, group in groupby(known, key=lambda one: str(one["scene"]))}
    for scene in sorted({*rows, *packaged_scenes()}):
        shown = [row for one in rows.get(scene, ()) for row in _rows(one)] or ["none: not tried | | | |"]
        units = f" ({rows[scene][0]['units']})" if scene in rows else ""
        names = [f"`{scene}`{units}", *[""] * (len(shown) - 1)]
        lines += [f"| {name} | {row} |" for name, row in zip(names, shown, strict=True)]
    return lines


def _rows(entry: Mapping[str, Any]) -> list[str]:
    """Rows of one problem, without the column of its scene."""
    values = [
        f"{one['quantity']} | {one['value']:.6g} | {one['uncertainty']:.2g} | "
        f"{one['uncertainty'] / abs(one['value']):.3%} | {_change(one['matched'])}"
        for one in entry["values"]
    ]
    return [*values, *(f"{remark} | | | |" for remark in entry.get("remarks", ()))]


def _change(matched: float | None) -> str:
    return "not known" if matched is None else f"{matched:+.2g}"
