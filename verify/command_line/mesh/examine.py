"""`debond mesh`: facts of a mesh file, whether a solver can use it, its picture, and conversion."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from iga.files.iga_format import IgaFile, mesh, write_iga
from iga.files.iga_reader import read_iga
from verify.command_line.mesh.facts import MeshFacts, facts_of_file, facts_of_mesh
from verify.support.progress import telling
from verify.support.refusal import Refusal
from verify.support.say import say

#: Speed of reading, examining and drawing a file: 12 MB with 5,000 cubic elements took 3.4 s.
BYTES_A_SECOND = 4e6

#: Formats of pictures.
PICTURES = (".svg", ".png", ".pdf")


def examine(path: Path, out: Path | None, as_json: bool, control: bool) -> bool:
    """Report on a mesh file, and write ``out``: a picture, a `.vtu` or an `.iga` file.

    Without ``out`` the picture goes to `debond-mesh/STEM.svg` in the working directory.

    Returns
    -------
    Whether a solver can use the mesh; of a surface or a volume, whose facts are stated, True.

    Raises
    ------
    Refusal : the file is malformed or no mesh, or ``out`` cannot be written.
    """
    if out is not None and out.suffix.lower() not in (".vtu", ".iga", *PICTURES):
        raise Refusal(f"--out: must end in .vtu, .iga, {', '.join(PICTURES[:-1])} or {PICTURES[-1]}, got {str(out)!r}")
    size = path.stat().st_size if path.is_file() else 0
    with telling(f"mesh {path.name}", 1.0 + size / BYTES_A_SECOND):
        try:
            file = read_iga(path)
        except OSError as error:
            raise Refusal(f"FILE: must be a file that can be read, got {str(path)!r}: {error.strerror}") from None
        except ValueError as error:
            of = (
                "" if path.suffix.lower() == ".iga" else "; this command reads .iga files of the Rhino T-spline plug-in"
            )
            raise Refusal(f"{error}{of}") from None
        found, known = facts_of_file(str(path), file), None
        if file.kind == "plane":
            try:
                known = MeshFacts(mesh(file))
            except ValueError as error:
                raise Refusal(f"{path}: {error}") from None
            found |= facts_of_mesh(known)
        elif out is not None and out.suffix.lower() != ".iga":
            raise Refusal(f"--out: must end in .iga for a {file.kind}, got {str(out)!r}")
        written = _write(out, path, file, known, control)
    if as_json:
        print(json.dumps({**found, "written": written and str(written)}, indent=2))
    else:
        print("\n".join([*lines(found), *([f"written: {written}"] if written else [])]))
    if known is None:
        say(f"{path}: type: {file.kind}; the solvers take plane bodies alone")
        return True
    for sentence in known.unsound:
        say(f"{path}: {sentence}")
    return not known.unsound


def _write(out: Path | None, path: Path, file: IgaFile, facts: MeshFacts | None, control: bool) -> Path | None:
    """Write the picture or the other format; its path, or None without matplotlib, or where there is no plane body to
    draw."""
    if out is None and facts is None:
        return None
    target = out or Path("debond-mesh") / f"{path.stem}.svg"
    try:
        if out is None:
            target.parent.mkdir(exist_ok=True)
        if target.suffix.lower() == ".iga" or facts is None:
            write_iga(file, target)
        elif target.suffix.lower() == ".vtu":
            from verify.fields.cells import write_vtu

            write_vtu(facts.mesh, target)
        else:
            from verify.command_line.mesh.drawing import save

            title = f"{path.name}: {len(facts.mesh.P_AI)} control points, {facts.mesh.elements} elements"
            save(facts, target, title, control)
    except OSError as error:
        raise Refusal(f"--out: must be a place that can be written to, got {str(target)!r}: {error.strerror}") from None
    except ModuleNotFoundError as error:
        if error.name != "matplotlib":
            raise
        if out is not None:
            raise Refusal(f"--out: a picture needs {error.name}: pip install 'debond[report]'") from None
        say(f"no picture without {error.name}: pip install 'debond[report]'")
        return None
    return target


def lines(found: dict[str, Any]) -> list[str]:
    """The facts as lines of text."""
    n_A, rank, loops = found["control_points"], found.get("rank"), found.get("boundary_loops")
    text = [f"{found['file']}: {found['type']}, {n_A} control points, {found['elements']} elements"]
    for kind in found["kinds"]:
        degrees = " and ".join(map(str, kind["degrees"]))
        text.append(f"  {kind['elements']} of degrees {degrees} with {kind['functions']} functions each")
    unity = found["sum_of_functions_misses_one_by"]
    if rank is None:
        ranges = ", ".join(f"{x} {a:.6g} to {b:.6g}" for x, a, b in zip("xyz", *found["box"], strict=True))
        sets = ", ".join(f"{one['name']} ({one['entries']} of {one['kind']})" for one in found["sets"])
        text += [f"control points: {ranges}", f"sets: {sets or 'none'}"]
        text.append(f"sum of functions: misses 1 by up to {unity:.1e}")
        return text + ([f"area: {found['area']:.12g}"] if "area" in found else [])
    points = [
        f"valence {one['valence']} at ({one['at'][0]:.6g}, {one['at'][1]:.6g})" for one in found["extraordinary_points"]
    ]
    return [
        *text,
        f"T-junctions: {len(found['t_junctions']) or 'none'} (element corners inside a side of another Bezier element)",
        f"extraordinary points: {', '.join(points) or 'none'}",
        f"boundary: {loops or 'no'} closed chain{'s' * (loops != 1)}{_sets(found)}",
        f"sum of functions: {_unity(unity, found['weighted_sum_misses_one_by'])}",
        f"independent functions: {rank} of {n_A}{', all' * (rank == n_A)}",
        f"continuity: {_continuity(found['continuity'])}",
        f"area: {found['area']:.12g}",
        f"smallest Jacobian: {found['smallest_jacobian']:.4g}; of the mean of an element at least "
        f"{found['smallest_jacobian_relative']:.3g}",
    ]


def _sets(found: dict[str, Any]) -> str:
    whole = {name.removesuffix("-1") for name in found["chains"]} | set(found["chains"])
    words = [
        f"{one['name']} ({one['entries']} sides{', no chain' * (one['name'] not in whole)})"
        for one in found["sets"]
        if one["kind"] == "side"
    ]
    return f"; side sets {', '.join(words)}" if words else ""


def _unity(unity: float, weighted: float) -> str:
    if unity < 1e-10:
        return f"1 to {unity:.1e}"
    if weighted < 1e-10:
        return f"1 to {weighted:.1e} with the weights (semi-standard), {unity:.1e} without"
    return f"misses 1 by up to {unity:.2e} (the rational functions, divided by it, add up to 1)"


def _continuity(edges: dict[str, int] | None) -> str:
    if edges is None:
        return "not computed, as Jacobians vanish or are negative"
    words = [f"{name} across {count}" for name, count in edges.items() if count]
    return f"{', '.join(reversed(words))} inner edges" if words else "one element"
