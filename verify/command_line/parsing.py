"""The parser of all commands; unknown words are refused with the most similar known word."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from typing import Any

from verify.command_line.commands import COMMANDS, HELP_GROUPS
from verify.support.refusal import Refusal, suggestion
from verify.version import __version__

#: The beginning of a negative number: argparse takes -1 and -0.5 for numbers, but -1e-3 for an option.
NEGATIVE = re.compile(r"-\.?\d")


class Help(argparse.HelpFormatter):
    """Wraps all texts except examples, which users copy from the screen."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return text if text.startswith("example: ") else super()._fill_text(text, width, indent)


def parser() -> argparse.ArgumentParser:
    """Every command with its options and one example."""
    plain: dict[str, Any] = {"formatter_class": Help, "allow_abbrev": False}
    example = "example: debond {}\n         # {}"
    top = argparse.ArgumentParser(
        prog="debond",
        usage="debond [-h] [--version] COMMAND ...",
        description="Verify codes for interface debonding.",
        epilog=example.format("verify", "every method, scenes of the paper; read debond-report/report.html"),
        **plain,
    )
    top.add_argument("--version", action="version", version=f"debond {__version__}")
    subs = top.add_subparsers(required=True, metavar="COMMAND", help=argparse.SUPPRESS)
    for one in COMMANDS:
        end = example.format(one.example, one.leaves)
        sub = subs.add_parser(one.name, help=one.text, description=one.text, epilog=end, **plain)
        sub._negative_number_matcher = NEGATIVE
        headed = {name: sub.add_argument_group(name) for name in dict.fromkeys(o.group for o in one.options) if name}
        for option in one.options:
            headed.get(option.group, sub).add_argument(*option.spellings, **option.more)
        sub.set_defaults(command=one, commands=COMMANDS)
    for title, group in HELP_GROUPS.items():
        names = [one.name for one in group]
        lines = [action for action in subs._choices_actions if action.dest in names]
        top.add_argument_group(title)._group_actions += lines
    return top


def parsed(words: Sequence[str]) -> argparse.Namespace:
    """Parse the words of the command line; ``command`` of the result is the `Command`.

    Raises
    ------
    Refusal : an unknown command or option
    SystemExit : help, or an error that argparse reports itself
    """
    known = {one.name: one for one in COMMANDS}
    if words and not words[0].startswith("-") and words[0] not in known:
        raise Refusal(f"{words[0]}: is no command; {suggestion(words[0], known, 'the commands')}")
    options, extra = parser().parse_known_args(words)
    if not extra:
        return options
    name = options.command.name
    flag = next((word.partition("=")[0] for word in extra if word.startswith("-")), None)
    if flag is None:
        raise Refusal(f"{extra[0]}: is more than {name} takes; see debond {name} --help")
    spellings = [spelling for option in options.command.options for spelling in option.spellings]
    raise Refusal(f"{flag}: is no option of {name}; {suggestion(flag, spellings) or f'see debond {name} --help'}")
