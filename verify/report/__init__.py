"""The report: one self-contained HTML file about all scenes of a verification; other pages share its parts."""

from __future__ import annotations

__all__ = ["write"]


def write(*what: object, **more: object) -> None:
    """``verify.report.page.write``; imported here alone, as it takes from other pages what these take from here."""
    from verify.report import page

    page.write(*what, **more)
