"""The program `debond`, also `python -m verify`: what an interrupt does is settled before anything else is imported."""

from typing import NoReturn

from verify.support import interrupts


def program() -> NoReturn:
    """Run one command and end with its exit code."""
    interrupts.end_at_once()
    from verify.cli import main

    interrupts.running(main)


if __name__ == "__main__":
    program()
