"""The paths of `debond law` as files, with input for codes that need more than a table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from verify.scene.schema import Scene
from verify.studies.law.legs import JumpPath
from verify.studies.law.read import lines
from verify.studies.law.record import PATHS_FILE
from verify.theory.mixed_law import MixedBond


def write_paths(bond: MixedBond, ways: Sequence[JumpPath], scene: Scene, folder: Path) -> list[Path]:
    """Write all files into a folder that is there."""
    table = folder / PATHS_FILE
    table.write_text("\n".join(lines(ways)) + "\n", encoding="utf-8")
    return [table]
