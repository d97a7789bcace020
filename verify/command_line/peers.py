"""`debond peers`, and the codes that other commands are asked for."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from verify.command_line.answers import listed
from verify.command_line.options import command, value
from verify.support.refusal import Refusal


@command(
    "Codes of others that can take part: the list, or an environment of its own for each one named.",
    "peers install moose",
    "then: debond verify dcb-czm1-linear --peers moose",
    value("words", "install NAME", "install these codes; default: the list", nargs="*"),
)
def peers(options: argparse.Namespace) -> int:
    from verify.methods.peers import install, known, named

    verb, *names = options.words or [""]
    if verb not in ("", "install") or bool(verb) != bool(names):
        raise Refusal(f"peers: must be left alone or followed by install NAME, got {' '.join(options.words)!r}")
    for peer in [named(name) for name in names]:
        if not peer.installed:
            install(peer)
    state = {True: "installed", False: "not installed"}
    return listed(
        []
        if verb
        else [f"{one.name}: {one.version}, {state[one.installed]}\n    {one.can}" for one in known().values()]
    )


def peer_names(words: str) -> Sequence[str]:
    """The names in a list with commas. Raises Refusal for a code that is not known or not installed."""
    from verify.methods.peers import named

    chosen = [named(word.strip()) for word in words.split(",") if word.strip()]
    if lacking := [peer.missing() for peer in chosen if peer.missing()]:
        raise Refusal("\n".join(lacking))
    return [peer.name for peer in chosen]
