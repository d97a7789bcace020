"""`debond export`."""

from __future__ import annotations

import argparse
from pathlib import Path

from verify.command_line.answers import listed
from verify.command_line.arguments import place, positive
from verify.command_line.options import NewCommand, scene_argument, set_option
from verify.support.refusal import Refusal


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "One scene for another code: mesh, sets, interface pairs, material, law and steps.",
        "export dcb-czm1 --format abaqus",
        "input files in debond-export/dcb-czm1-abaqus",
    )
    scene_argument(sub)
    sub.add_argument("--format", required=True, metavar="F", help="abaqus, gmsh, med, exodus, vtu or csv")
    what = "gmsh, med, exodus: one conforming mesh with a group `bond`, for codes that insert interface elements there"
    sub.add_argument("--merged", action="store_true", help=what)
    sub.add_argument("--elements", type=positive, metavar="N", help="elements along the specimen, as dolfinx.elements")
    layers = "elements through each arm or the strip, as dolfinx.layers"
    sub.add_argument("--layers", type=positive, metavar="N", help=layers)
    set_option(sub)
    sub.add_argument("--out", type=place, metavar="DIR", help="default: debond-export/SCENE-F")


def run(options: argparse.Namespace) -> int:
    from verify.export.command import FORMATS, export
    from verify.methods.given_meshes import refuse_files
    from verify.scene.load import load_scene
    from verify.support.refusal import one_of

    if options.format not in FORMATS:
        raise Refusal(f"--format: must be {one_of(FORMATS)}, got {options.format!r}")
    given = {"elements": options.elements, "layers": options.layers}
    along = [f"dolfinx.{key}={number}" for key, number in given.items() if number]
    asked = load_scene(options.scene, [*along, *options.overrides]).dolfinx
    scene = load_scene(options.scene, [one for one in options.overrides if not one.lstrip().startswith("dolfinx")])
    refuse_files(scene, "debond export")
    folder = options.out or Path("debond-export") / f"{scene.name}-{options.format}"
    return listed(export(scene, options.format, folder, asked, options.merged))
