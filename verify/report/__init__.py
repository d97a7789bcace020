"""The report of a verification: one self-contained HTML file about all scenes."""

from __future__ import annotations

from pathlib import Path

from verify.report.findings import Findings

__all__ = ["Findings", "write"]


def write(findings: Findings, path: Path, text: bool = False) -> None:
    """``verify.report.page.write``, imported on the first call, as it needs matplotlib and Jinja."""
    from verify.report import page

    page.write(findings, path, text)
