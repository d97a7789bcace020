"""The error for invalid input."""

from __future__ import annotations


class Refusal(ValueError):
    """Invalid input; the message is for the user, with key, allowed range and value."""
