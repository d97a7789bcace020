"""Two packaged scenes written for other codes, and what any mesh of theirs has to be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.scene.load import load_scene

DCB, PEEL = "dcb-czm1-linear", "peel-60"


def exported(scene: str, kind: str, folder: Path, *words: str) -> Path:
    assert main(["export", scene, "--format", kind, "--elements", "24", "--out", str(folder), *words]) == 0
    return folder


def area(X_vI: np.ndarray) -> float:
    """Of a polygon, by Gauss; positive counter-clockwise."""
    (x, y), (x_next, y_next) = X_vI.T, np.roll(X_vI, -1, axis=0).T
    return 0.5 * float(np.sum(x * y_next - x_next * y))


def check_areas(scene: str, names: list[str], X_nI: np.ndarray, conn_ea: np.ndarray, body_e: list[str]) -> None:
    """Elements counter-clockwise, and as large together as the bodies."""
    s = load_scene(scene).specimen
    strips = ((s.strip_length, s.strip_thickness), (s.substrate_length, s.substrate_thickness)) if scene == PEEL else ()
    areas = np.array([area(X_nI[nodes[:4]]) for nodes in conn_ea])
    assert np.all(areas > 0)
    for name, (length, thickness) in zip(names, strips or ((s.length, s.arm_thickness),) * 2, strict=True):
        assert np.sum(areas[np.array(body_e) == name]) == pytest.approx(length * thickness, rel=1e-12)
