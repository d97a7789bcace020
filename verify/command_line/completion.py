"""Completion scripts for bash, zsh and fish, generated from the parser.

The scripts contain all words, so that completion does not start Python, as it would with argcomplete. shtab 1.13 was
not sufficient: in zsh it completes only the first scene of `debond verify A B` and needs `eval`; in bash it adds a
blank after `key=`.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from verify.command_line.arguments import place

#: Stands for files and folders, which every shell completes itself.
PATHS = ("FILES",)


@dataclass(frozen=True)
class Command:
    """A command with its options and their values.

    Parameters
    ----------
    options : spelling -> help
    values : spelling -> possible values, ``PATHS``, or empty where any value is possible
    places : possible values of the positional arguments
    """

    name: str
    text: str
    options: Mapping[str, str]
    values: Mapping[str, tuple[str, ...]]
    places: tuple[str, ...]


def commands(parser: argparse.ArgumentParser) -> tuple[Command, ...]:
    """The commands of a parser, in its order."""
    known = _known()
    (subs,) = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    texts = {choice.dest: choice.help or "" for choice in subs._choices_actions}
    return tuple(_command(name, texts.get(name, ""), sub, known) for name, sub in subs.choices.items())


def script(parser: argparse.ArgumentParser, shell: str) -> str:
    """The script for one of ``SHELLS``."""
    return "\n".join(SHELLS[shell](commands(parser))) + "\n"


def _known() -> Mapping[str, tuple[str, ...]]:
    """Destination of an argument -> its possible values."""
    from verify.export.command import FORMATS
    from verify.methods.plugins import known_methods
    from verify.scene.keys import SPECIMENS, dotted_keys
    from verify.scene.load import packaged_scenes
    from verify.studies.hard.cases import CASES

    return {
        "scene": (*packaged_scenes(), *PATHS),
        "scenes": (*packaged_scenes(), *PATHS),
        "ladder": (*packaged_scenes(), *PATHS),
        "method": tuple(known_methods()),
        "names": tuple(CASES),
        "overrides": tuple(f"{key}=" for key in dotted_keys()),
        "format": tuple(FORMATS),
        "kind": tuple(SPECIMENS),
        "shell": tuple(SHELLS),
        "given": PATHS,
    }


def _command(name: str, text: str, sub: argparse.ArgumentParser, known: Mapping[str, tuple[str, ...]]) -> Command:
    options, values, places = {}, {}, ()
    for action in sub._actions:
        words = tuple(action.choices or ()) or known.get(action.dest, PATHS if action.type in (Path, place) else ())
        for spelling in action.option_strings:
            options[spelling] = (action.help or "").replace("%%", "%")
            if action.nargs != 0:
                values[spelling] = words
        if not action.option_strings:
            places += words
    return Command(name, text, options, values, places)


def _bash(found: tuple[Command, ...]) -> Iterator[str]:
    yield from (
        "# debond for bash; in ~/.bashrc: source <(debond completion bash)",
        "_debond() {",
        "    local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}",
        '    [[ $previous == "=" ]] && return  # the value of a key; the shell splits there',
        "    if (( COMP_CWORD == 1 )); then",
        f'        COMPREPLY=($(compgen -W "{" ".join(["--help", *(one.name for one in found)])}" -- "$word"))',
        "        return",
        "    fi",
    )
    yield from _cases(found, "${COMP_WORDS[1]}", "", _bash_words, 'COMPREPLY=($(compgen -W "{}" -- "$word"))')
    yield from ("}", "complete -o filenames -F _debond debond ./debond")


def _cases(
    found: tuple[Command, ...], command: str, opening: str, answer: Callable[[tuple[str, ...]], str], options: str
) -> Iterator[str]:
    """The lines common to bash and zsh: values after an option, else options after a dash, else arguments.

    Parameters
    ----------
    command : the expression for the command on the line
    opening : first character of a pattern, if the shell needs one
    answer : returns the shell command that offers words
    options : the shell command that offers options, with ``{}`` in their place
    """
    yield f'    case "{command} $previous" in'
    for one in found:
        for words, spellings in _grouped(one.values).items():
            pattern = "|".join(f'"{one.name} {spelling}"' for spelling in spellings)
            yield f"        {opening}{pattern})"
            yield f"            {answer(words)}"
            yield "            return ;;"
    yield from ("    esac", f'    case "{command}" in')
    for one in found:
        yield f"        {opening}{one.name})"
        yield f"            if [[ $word == -* ]]; then {options.format(' '.join(one.options))}"
        yield f"            else {answer(one.places)}"
        yield "            fi ;;"
    yield "    esac"


def _bash_words(words: tuple[str, ...]) -> str:
    """The shell command that offers words."""
    plain = " ".join(word for word in words if word not in PATHS)
    files = " -f" if words[-1:] == PATHS else ""
    if not plain and not files:
        return "COMPREPLY=()"
    some = f' -W "{plain}"' if plain else ""
    space = "; compopt -o nospace +o filenames" if plain.endswith("=") else ""
    return f'COMPREPLY=($(compgen{files}{some} -- "$word")){space}'


def _zsh(found: tuple[Command, ...]) -> Iterator[str]:
    yield from (
        "#compdef debond",
        "# debond for zsh; in ~/.zshrc after compinit: source <(debond completion zsh)",
        "_debond() {",
        "    local word=$words[CURRENT] previous=$words[CURRENT-1]",
        "    if (( CURRENT == 2 )); then",
        f"        compadd -- --help {' '.join(one.name for one in found)}",
        "        return",
        "    fi",
    )
    yield from _cases(found, "$words[2]", "(", _zsh_words, "compadd -- {}")
    yield from ("}", "compdef _debond debond ./debond")


def _zsh_words(words: tuple[str, ...]) -> str:
    plain = [word for word in words if word not in PATHS]
    tight = "-S '' " if plain and plain[-1].endswith("=") else ""
    offers = [f"compadd {tight}-- {' '.join(plain)}"] * bool(plain) + ["_files"] * (words[-1:] == PATHS)
    return "; ".join(offers) or ":"


def _fish(found: tuple[Command, ...]) -> Iterator[str]:
    yield "# debond for fish; debond completion fish > ~/.config/fish/completions/debond.fish"
    yield "complete -c debond -f"
    for one in found:
        yield f"complete -c debond -n __fish_use_subcommand -a {one.name} -d {_quoted(one.text)}"
    for one in found:
        start = f"complete -c debond -n '__fish_seen_subcommand_from {one.name}'"
        if one.places:
            yield f"{start}{_fish_words(one.places)}"
        for spelling, text in one.options.items():
            flag = f"-l {spelling[2:]}" if spelling.startswith("--") else f"-s {spelling[1:]}"
            values = f" -r{_fish_words(one.values[spelling])}" if spelling in one.values else ""
            yield f"{start} {flag}{values} -d {_quoted(text)}"


def _fish_words(words: tuple[str, ...]) -> str:
    plain = [word for word in words if word not in PATHS]
    return (" -F" if len(plain) < len(words) else " -f") + f" -a {_quoted(' '.join(plain))}" * bool(plain)


def _quoted(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def _grouped(values: Mapping[str, tuple[str, ...]]) -> Mapping[tuple[str, ...], list[str]]:
    """Spellings grouped by their values."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for spelling, words in values.items():
        groups.setdefault(words, []).append(spelling)
    return groups


SHELLS: Mapping[str, Callable[[tuple[Command, ...]], Iterator[str]]] = {"bash": _bash, "zsh": _zsh, "fish": _fish}
