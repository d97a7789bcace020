"""Bad input, whoever finds it."""

from __future__ import annotations


class Refusal(ValueError):
    """What the user gave cannot be used; the message is for the user, with key, range and value."""
