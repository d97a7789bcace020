"""`debond new`."""

from __future__ import annotations

import argparse

from verify.command_line.options import NewCommand, set_option
from verify.support.refusal import Refusal


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "A scene file to start from: every key with what it is, its unit, its range and its default.",
        "new dcb > my.toml",
        "change it, then: debond solve my.toml",
    )
    sub.add_argument("kind", nargs="?", metavar="KIND", help="of the specimen, like dcb or peel")
    sub.add_argument("--from", dest="scene", metavar="SCENE", help="start from this scene: a packaged name or a file")
    set_option(sub)


def run(options: argparse.Namespace) -> int:
    from verify.command_line.scenes.new import from_scene, new_scene
    from verify.scene.load import load_scene

    if (options.kind is None) == (options.scene is None):
        raise Refusal("new: must be given either a KIND of specimen or --from SCENE")
    if options.scene is None and options.overrides:
        raise Refusal("--set: is for a scene that is there; debond new --from SCENE --set KEY=VALUE")
    text = (
        new_scene(options.kind) if options.scene is None else from_scene(load_scene(options.scene, options.overrides))
    )
    print(text, end="")
    return 0
