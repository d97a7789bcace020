"""Completion scripts for bash, zsh and fish, generated from the commands and their options.

The scripts contain all words, so that completion does not start Python, as it would with argcomplete. shtab 1.13 was
not sufficient: in zsh it completes only the first scene of `debond verify A B` and needs `eval`; in bash it adds a
blank after `key=`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from verify.command_line.arguments import place
from verify.command_line.options import Command, Option

#: Stands for files and folders, which every shell completes itself.
PATHS = ("FILES",)


@dataclass(frozen=True)
class Completed:
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


def completed(commands: Sequence[Command]) -> tuple[Completed, ...]:
    """What completes each command, in the order of the help."""
    from verify.export.command import FORMATS
    from verify.methods.plugins import known_methods
    from verify.scene.keys import SPECIMENS, dotted_keys
    from verify.scene.load import packaged_scenes
    from verify.studies.hard.cases import CASES

    scenes = (*packaged_scenes(), *PATHS)
    known: Mapping[str, tuple[str, ...]] = {
        **dict.fromkeys(("SCENE",), scenes),
        **dict.fromkeys(("M", "METHOD"), tuple(known_methods())),
        **dict.fromkeys(("KEY=VALUE", "KEY=A,B,C"), tuple(f"{key}=" for key in dotted_keys())),
        **dict.fromkeys(("LAW", "DIR", "FILE"), PATHS),
        "NAME": tuple(CASES),
        "F": tuple(FORMATS),
        "KIND": tuple(SPECIMENS),
        "SHELL": tuple(SHELLS),
    }

    def words(option: Option) -> tuple[str, ...]:
        paths = PATHS if option.more.get("type") in (Path, place) else ()
        return option.more.get("choices") or known.get(option.more["metavar"], paths)

    found = []
    for one in commands:
        named = {name: row for row in one.options for name in row.spellings if name.startswith("-")}
        options = {"-h": _HELP, "--help": _HELP, **{name: row.more["help"] for name, row in named.items()}}
        values = {name: words(row) for name, row in named.items() if "metavar" in row.more}
        places = (words(row) for row in one.options if not row.spellings[0].startswith("-"))
        found.append(Completed(one.name, one.text, options, values, sum(places, ())))
    return tuple(found)


_HELP = "show this help message and exit"

#: The beginning of the scripts of bash and zsh: `_debond_words WORDS FILES` offers words, and files where FILES is any.
_BASH = """\
# debond for bash; in ~/.bashrc: source <(debond completion bash)
_debond_words() {
    COMPREPLY=($(compgen ${2:+-f} -W "$1" -- "$word"))
    [[ $1 == *= ]] && compopt -o nospace +o filenames
}
_debond() {
    local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]}
    local -i place=COMP_CWORD
    [[ $previous == "=" ]] && return  # the value of a key; the shell splits there
"""
_ZSH = """\
#compdef debond
# debond for zsh; in ~/.zshrc after compinit: source <(debond completion zsh)
_debond_words() {
    local -a tight; [[ $1 == *= ]] && tight=(-S '')
    [[ -n $1 ]] && compadd "${tight[@]}" -- ${=1}
    [[ -n $2 ]] && _files
}
_debond() {
    local word=$words[CURRENT] previous=$words[CURRENT-1] command=$words[2]
    local -i place=CURRENT-1
"""


def script(shell: str, commands: Sequence[Command]) -> str:
    """The script for one of ``SHELLS``."""
    return "\n".join(SHELLS[shell](completed(commands))) + "\n"


def _bash(found: tuple[Completed, ...]) -> Iterator[str]:
    yield from (_BASH, *_cases(found), "}", "complete -o filenames -F _debond debond ./debond")


def _zsh(found: tuple[Completed, ...]) -> Iterator[str]:
    yield from (_ZSH, *_cases(found), "}", "compdef _debond debond ./debond")


def _cases(found: tuple[Completed, ...]) -> Iterator[str]:
    """The lines common to bash and zsh: commands, else values after an option, options after a dash, or arguments."""
    yield f"    if (( place == 1 )); then {_offered(('--help', *(one.name for one in found)))}; return; fi"
    yield '    case "$command $previous" in'
    for one in found:
        for words in dict.fromkeys(one.values.values()):
            spellings = (f'"{one.name} {spelling}"' for spelling in one.values if one.values[spelling] == words)
            yield f"        ({'|'.join(spellings)}) {_offered(words)}; return ;;"
    yield from ("    esac", '    case "$command" in')
    for one in found:
        yield f"        ({one.name}) if [[ $word == -* ]]; then {_offered(tuple(one.options))}"
        yield f"            else {_offered(one.places)}; fi ;;"
    yield "    esac"


def _offered(words: tuple[str, ...]) -> str:
    """The call of the shell that offers words."""
    plain, files = _split(words)
    return f'_debond_words "{plain}"' + " files" * files


def _fish(found: tuple[Completed, ...]) -> Iterator[str]:
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
            yield f"{start} {flag}{values} -d {_quoted(text.replace('%%', '%'))}"


def _fish_words(words: tuple[str, ...]) -> str:
    plain, files = _split(words)
    return (" -F" if files else " -f") + f" -a {_quoted(plain)}" * bool(plain)


def _split(words: tuple[str, ...]) -> tuple[str, bool]:
    """The words in one text, and whether files are possible as well."""
    return " ".join(word for word in words if word not in PATHS), words[-1:] == PATHS


def _quoted(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


SHELLS: Mapping[str, Callable[[tuple[Completed, ...]], Iterator[str]]] = {"bash": _bash, "zsh": _zsh, "fish": _fish}
