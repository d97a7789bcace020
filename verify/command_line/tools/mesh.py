"""`debond mesh`."""

from __future__ import annotations

import argparse

from verify.command_line.answers import FAILED
from verify.command_line.arguments import place
from verify.command_line.options import NewCommand


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "What a mesh file holds, and its picture.",
        "mesh arch.iga --out arch.vtu",
        "facts here, cells for ParaView there",
    )
    sub.add_argument("file", metavar="FILE", type=place, help=".iga file of the Rhino T-spline plug-in")
    formats = ".svg, .png, .pdf: picture; .vtu: Bezier cells; .iga; default: debond-mesh/FILE.svg"
    sub.add_argument("--out", type=place, metavar="FILE", help=formats)
    sub.add_argument("--json", action="store_true", help="print the facts as JSON")
    sub.add_argument("--control", action="store_true", help="draw the control points too")


def run(options: argparse.Namespace) -> int:
    from verify.command_line.mesh.examine import examine

    return 0 if examine(options.file, options.out, options.json, options.control) else FAILED
