"""`debond scenes`."""

from __future__ import annotations

import argparse
from shutil import get_terminal_size

from verify.command_line.answers import listed
from verify.command_line.options import NewCommand


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "The packaged scenes, a line each; those that are named with a drawing and their numbers.",
        "scenes dcb-czm1",
        "the specimen, drawn",
    )
    sub.add_argument("scenes", nargs="*", metavar="SCENE", help="a packaged name or a file; default: the list")


def run(options: argparse.Namespace) -> int:
    from verify.command_line.scenes import listing
    from verify.methods.plugins import plugins
    from verify.scene.load import load_scene, packaged_scenes

    width = get_terminal_size((200, 24)).columns  # one line a scene for programs
    if options.scenes:
        return listed(["\n\n".join([listing.page(load_scene(name), width) for name in options.scenes])])
    for name in packaged_scenes():
        print(listing.line(name, load_scene(name), width))
    for plugin in plugins().values():
        print(f"method of another package: {plugin.name} ({plugin.package})")
    return 0
