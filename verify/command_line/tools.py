"""Commands around the studies: other formats, meshes, scenes, the shell, the installation."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from verify.command_line.answers import FAILED, listed, output_folder
from verify.command_line.arguments import place, positive
from verify.command_line.options import SCENE, SET, command, flag, value
from verify.support.refusal import Refusal, one_of


@command(
    "One scene for another code: mesh, sets, interface pairs, material, law and steps.",
    "export dcb-czm1 --format abaqus",
    "input files in debond-export/dcb-czm1-abaqus",
    SCENE,
    value("--format", "F", "abaqus, moose, gmsh, med, exodus, vtu or csv", required=True),
    flag(
        "--merged",
        "gmsh, med, exodus: one conforming mesh with a group `bond`, for codes that insert interface elements there",
    ),
    value("--elements", "N", "elements along the specimen, as dolfinx.elements", positive),
    value("--layers", "N", "elements through each arm or the strip, as dolfinx.layers", positive),
    SET,
    value("--out", "DIR", "default: debond-export/SCENE-F", place),
)
def export(options: argparse.Namespace) -> int:
    from verify.export.command import FORMATS, export
    from verify.methods.given_meshes import refuse_files
    from verify.scene.load import load_scene

    if options.format not in FORMATS:
        raise Refusal(f"--format: must be {one_of(FORMATS)}, got {options.format!r}")
    given = {"elements": options.elements, "layers": options.layers}
    along = [f"dolfinx.{key}={number}" for key, number in given.items() if number]
    asked = load_scene(options.scene, [*along, *options.overrides]).dolfinx
    scene = load_scene(options.scene, [one for one in options.overrides if not one.lstrip().startswith("dolfinx")])
    if scene.specimen.nodal:
        if along:
            raise Refusal(f"--elements, --layers: must be left out with the mesh of a file, {scene.specimen.mesh[0]}")
    else:
        refuse_files(scene, "debond export")
    folder = options.out or Path("debond-export") / f"{scene.name}-{options.format}"
    if (
        (kept := folder / f"{scene.name}.toml").exists()
        and Path(options.scene).exists()
        and kept.samefile(options.scene)
    ):
        raise Refusal(f"--out: must be another folder than that of {options.scene}, where the exported scene is kept")
    return listed(export(scene, options.format, folder, asked, options.merged))


@command(
    "Codes of others that can take part: the list, or an environment of its own for each one named.",
    "peers install moose",
    "then: debond verify dcb-czm1-linear --peers moose",
    value("words", "install NAME", "install these codes; report: run those installed; default: the list", nargs="*"),
    value("--out", "DIR", "folder of report; default: debond-peers", place, Path("debond-peers")),
)
def peers(options: argparse.Namespace) -> int:
    from verify.methods.peers import install, known, named

    verb, *names = options.words or [""]
    if verb == "report":
        from verify.report.who_agrees import who_agrees

        wanted = [named(name) for name in names] or [one for one in known().values() if one.installed]
        missing = [one.missing() for one in wanted if not one.installed] or (
            [] if wanted else ["peers: none is installed"]
        )
        if missing:
            raise Refusal("; ".join(missing))
        output_folder(options.out)
        return listed([f"written: {who_agrees([one.name for one in wanted], options.out)}"])
    if verb not in ("", "install") or bool(verb) != bool(names):
        text = "must be left alone or followed by install NAME or report"
        raise Refusal(f"peers: {text}, got {' '.join(options.words)!r}")
    for peer in [named(name) for name in names]:
        if not peer.installed:
            install(peer)
    state = {True: "installed", False: "not installed"}
    return listed(
        []
        if verb
        else [f"{one.name}: {one.version}, {state[one.installed]}\n    {one.can}" for one in known().values()]
    )


@command(
    "What a mesh file holds, and its picture.",
    "mesh arch.iga --out arch.vtu",
    "facts here, cells for ParaView there",
    value("file", "FILE", ".iga file of the Rhino T-spline plug-in", place),
    value(
        "--out",
        "FILE",
        ".svg, .png, .pdf: picture; .vtu: Bezier cells; .iga; default: debond-mesh/FILE.svg",
        place,
    ),
    flag("--json", "print the facts as JSON"),
    flag("--control", "draw the control points too"),
)
def mesh(options: argparse.Namespace) -> int:
    from verify.command_line.mesh.examine import examine

    return 0 if examine(options.file, options.out, options.json, options.control) else FAILED


@command(
    "The packaged scenes, a line each; those that are named with a drawing and their numbers.",
    "scenes dcb-czm1",
    "the specimen, drawn",
    value("scenes", "SCENE", "a packaged name or a file; default: the list", nargs="*"),
)
def scenes(options: argparse.Namespace) -> int:
    from shutil import get_terminal_size

    from verify.command_line.scenes import listing
    from verify.methods.plugins import plugins
    from verify.scene.load import load_scene, packaged_scenes

    width = get_terminal_size((200, 24)).columns  # one line a scene for programs
    if options.scenes:
        return listed(["\n\n".join([listing.page(load_scene(name), width) for name in options.scenes])])
    for name in packaged_scenes():
        print(listing.line(name, load_scene(name), width))
    for one in plugins().values():
        print(f"method of another package: {one.name} ({one.package})")
    return 0


@command(
    "A scene file to start from: every key with what it is, its unit, its range and its default.",
    "new dcb > my.toml",
    "change it, then: debond solve my.toml",
    value("kind", "KIND", "of the specimen, like dcb or peel", nargs="?"),
    value("--from", "SCENE", "start from this scene: a packaged name or a file", dest="scene"),
    SET,
)
def new(options: argparse.Namespace) -> int:
    from verify.command_line.scenes.new import from_scene, new_scene
    from verify.scene.load import load_scene

    if (options.kind is None) == (options.scene is None):
        raise Refusal("new: must be given either a KIND of specimen or --from SCENE")
    if options.scene is not None:
        text = from_scene(load_scene(options.scene, options.overrides))
    elif options.overrides:
        raise Refusal("--set: is for a scene that is there; debond new --from SCENE --set KEY=VALUE")
    else:
        text = new_scene(options.kind)
    print(text, end="")
    return 0


@command(
    "What completes commands, options, scenes, methods and keys at the tab key of a shell.",
    "completion bash > ~/.debond-completion",
    "source it in ~/.bashrc",
    value("shell", "SHELL", "bash, zsh or fish"),
)
def completion(options: argparse.Namespace) -> int:
    from verify.command_line.completion import SHELLS, script

    if options.shell not in SHELLS:
        raise Refusal(f"SHELL: must be {one_of(SHELLS)}, got {options.shell!r}")
    print(script(options.shell, options.commands), end="")
    return 0


@command("What is installed, what works, how to get the rest.", "doctor", "one line a package, then what works")
def doctor(options: argparse.Namespace) -> int:
    from verify.command_line.doctor import examine

    lines, works = examine()
    print("\n".join(lines))
    return 0 if works else FAILED


@command(
    "Run the tests; arguments go to pytest.",
    "test -k curve",
    "the tests of curves",
    value("rest", "ARG", None, nargs=argparse.REMAINDER),
)
def test(options: argparse.Namespace) -> int:
    tests = Path(__file__).resolve().parents[2] / "tests"
    if not tests.is_dir():
        raise Refusal("test: the tests are not installed; run it in a copy of the repository")
    return subprocess.call([sys.executable, "-m", "pytest", *options.rest], cwd=tests.parent)
