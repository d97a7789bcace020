"""Certified values that are kept in a checkout: the file of the package, and the table of the guide."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from verify.scene.load import packaged_scenes
from verify.scene.stated.certified import CERTIFIED_FILE, Certified, entries, problem_key
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
    known = dict(entries(file)) | {
        problem_key(study.scene): {
            "scene": study.scene.name,
            "units": study.scene.units,
            "values": [asdict(one) for one in certified(study)],
            "remarks": [*study.left_out, *(one.sentence for one in study.found if one.doubt)],
        }
    }
    ordered = dict(sorted(known.items(), key=lambda item: (item[1]["scene"], item[0])))
    file.write_text(json.dumps(ordered, indent=1) + "\n")
    entries.cache_clear()
    page.write_text(with_table(page.read_text(encoding="utf-8"), ordered), encoding="utf-8")


def certified(study: Study) -> list[Certified]:
    """The content for the file of the package."""
    held = [one for one in study.found if not one.doubt]
    return [Certified(one.quantity, one.kind, one.opening, one.value, one.uncertainty, one.matched) for one in held]


def with_table(text: str, known: Mapping[str, Mapping[str, Any]]) -> str:
    """The page with the table of all entries: each value with its uncertainty and what keeping the pairs of points
    changes, the remarks of its scene, and every packaged scene that was not tried."""
    lines = ["| scene | quantity | value | U, 95 % | of the value | pairs kept |", "|---|---|---|---|---|---|"]
    for scene in sorted({*packaged_scenes(), *(one["scene"] for one in known.values())}):
        name, rows = f"`{scene}`", list[str]()
        for entry in (one for one in known.values() if one["scene"] == scene):
            name = f"`{scene}` ({entry['units']})"
            rows += [_row(Certified(**one)) for one in entry["values"]]
            rows += [f"{remark} | | | |" for remark in entry.get("remarks", ())]
        for row in rows or ["none: not tried | | | |"]:
            lines.append(f"| {name} | {row} |")
            name = ""
    before, _, rest = text.partition(BEGIN)
    return "\n".join([before + BEGIN, "", *lines, "", END + rest.partition(END)[2]])


def _row(one: Certified) -> str:
    change = "not known" if one.matched is None else f"{one.matched:+.2g}"
    relative = one.uncertainty / abs(one.value)
    return f"{one.quantity} | {one.value:.6g} | {one.uncertainty:.2g} | {relative:.3%} | {change}"
