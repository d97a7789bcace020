"""Parsing of the command line; unknown words are refused with the most similar known word."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from verify.support.refusal import Refusal, suggestion


class Help(argparse.HelpFormatter):
    """Wraps all texts except examples, which users copy from the screen."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return text if text.startswith("example: ") else super()._fill_text(text, width, indent)


def parsed(parser: argparse.ArgumentParser, words: Sequence[str]) -> argparse.Namespace:
    """Parse the words of the command line.

    Raises
    ------
    Refusal : an unknown command or option
    SystemExit : help, or an error that argparse reports itself
    """
    (subs,) = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    if words and not words[0].startswith("-") and words[0] not in subs.choices:
        hint = suggestion(words[0], subs.choices) or f"the commands are {', '.join(subs.choices)}"
        raise Refusal(f"{words[0]}: is no command; {hint}")
    options, extra = parser.parse_known_args(words)
    if extra:
        name = next(word for word in words if word in subs.choices)  # may follow unknown options
        raise Refusal(_too_much(extra, name, subs.choices[name]))
    return options


def _too_much(extra: Sequence[str], name: str, sub: argparse.ArgumentParser) -> str:
    options = [spelling for action in sub._actions for spelling in action.option_strings]
    word = next((word for word in extra if word.startswith("-")), None)
    if word is None:
        return f"{extra[0]}: is more than {name} takes; see debond {name} --help"
    flag = word.partition("=")[0]
    return f"{flag}: is no option of {name}; {suggestion(flag, options) or f'see debond {name} --help'}"
