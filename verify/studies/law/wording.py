"""Defects in words."""

from __future__ import annotations

from collections.abc import Iterable

from verify.studies.law.defects import UNKNOWN, Defect


def sentences(defects: Iterable[Defect]) -> list[str]:
    """A sentence for every defect, best first."""
    said = []
    for one in defects:
        off = f"the law is off by {one.error_without:.2g} of the strengths"
        left = "" if one.name == UNKNOWN else f", with the defect by {one.error_with:.2g}"
        said.append(f"{one.name}: {one.what}; {off}{left}, most on path {one.path}")
    return said
