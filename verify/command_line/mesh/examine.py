"""`debond mesh`: facts of a mesh file, whether a solver can use it, its picture, and conversion."""

from __future__ import annotations

import json
from pathlib import Path

from iga.files.iga_format import IgaFile, mesh, write_iga
from iga.files.iga_reader import read_iga
from iga.mesh.extraction import Mesh
from verify.command_line.mesh.facts import MeshFacts, surface_facts, surface_lines
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
    with telling(f"mesh {path.name}", _seconds(path)):
        file = _read(path)
        if file.kind != "plane":
            return _other(path, file, out, as_json)
        body = _body(path, file)
        known = MeshFacts(body)
        report = _report(path, file, known)
        written = _write(out, path, file, known, control)
    if as_json:
        print(json.dumps({**report, "written": written and str(written)}, indent=2))
    else:
        print("\n".join(_lines(report)))
        if written:
            print(f"written: {written}")
    for sentence in known.unsound:
        say(f"{path}: {sentence}")
    return not known.unsound


def _seconds(path: Path) -> float:
    """Expected seconds for a file; an unreadable file is refused later."""
    try:
        return 1.0 + path.stat().st_size / BYTES_A_SECOND
    except OSError:
        return 1.0


def _read(path: Path) -> IgaFile:
    try:
        return read_iga(path)
    except OSError as error:
        raise Refusal(f"FILE: must be a file that can be read, got {str(path)!r}: {error.strerror}") from None
    except ValueError as error:
        of = "" if path.suffix.lower() == ".iga" else "; this command reads .iga files of the Rhino T-spline plug-in"
        raise Refusal(f"{error}{of}") from None


def _body(path: Path, file: IgaFile) -> Mesh:
    try:
        return mesh(file)
    except ValueError as error:
        raise Refusal(f"{path}: {error}") from None


def _other(path: Path, file: IgaFile, out: Path | None, as_json: bool) -> bool:
    """The facts of a file that is no plane body, which no solver takes; it can be written as `.iga`."""
    if out is not None and out.suffix.lower() != ".iga":
        raise Refusal(f"--out: must end in .iga for a {file.kind}, got {str(out)!r}")
    found = surface_facts(str(path), file)
    if out is not None:
        _write_iga(file, out)
    print(json.dumps(found, indent=2) if as_json else "\n".join(surface_lines(found)))
    say(f"{path}: type: {file.kind}; the solvers take plane bodies alone")
    return True


def _write_iga(file: IgaFile, out: Path) -> None:
    try:
        write_iga(file, out)
    except OSError as error:
        raise Refusal(f"--out: must be a place that can be written to, got {str(out)!r}: {error.strerror}") from None


def _write(out: Path | None, path: Path, file: IgaFile, facts: MeshFacts, control: bool) -> Path | None:
    """Write the picture or the other format; its path, or None without matplotlib."""
    target = out or Path("debond-mesh") / f"{path.stem}.svg"
    try:
        if out is None:
            target.parent.mkdir(exist_ok=True)
        if target.suffix.lower() == ".iga":
            write_iga(file, target)
        elif target.suffix.lower() == ".vtu":
            from verify.fields.cells import write_vtu

            write_vtu(facts.mesh, target)
        else:
            from verify.command_line.mesh.drawing import save

            save(facts, target, _title(path, facts), control)
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


def _title(path: Path, facts: MeshFacts) -> str:
    return f"{path.name}: {len(facts.mesh.P_AI)} control points, {facts.mesh.elements} elements"


def _report(path: Path, file: IgaFile, facts: MeshFacts) -> dict[str, object]:
    """All facts as numbers, lists and words."""
    smallest, relative = facts.smallest_jacobian
    return {
        "file": str(path),
        "type": file.kind,
        "control_points": len(facts.mesh.P_AI),
        "elements": facts.mesh.elements,
        "kinds": [
            {"degrees": list(degrees), "functions": functions, "elements": count}
            for degrees, functions, count in facts.kinds
        ],
        "t_junctions": facts.junctions.tolist(),
        "extraordinary_points": [{"valence": valence, "at": x.tolist()} for valence, x in facts.extraordinary],
        "boundary_loops": facts.loops,
        "sets": [{"kind": s.kind, "name": s.name, "entries": len(s.ids)} for s in file.sets],
        "chains": {name: len(chain.element_c) for name, chain in facts.mesh.chains.items()},
        "sum_of_functions_misses_one_by": facts.unity,
        "weighted_sum_misses_one_by": facts.weighted_unity,
        "rank": facts.rank,
        "area": facts.area,
        "smallest_jacobian": smallest,
        "smallest_jacobian_relative": relative,
        "continuity": facts.continuity,
        "unsound": facts.unsound,
    }


def _lines(report: dict) -> list[str]:
    """The report as lines of text."""
    n_A, rank = report["control_points"], report["rank"]
    lines = [f"{report['file']}: {report['type']}, {n_A} control points, {report['elements']} elements"]
    for kind in report["kinds"]:
        p, q = kind["degrees"]
        lines.append(f"  {kind['elements']} of degrees {p} and {q} with {kind['functions']} functions each")
    count = len(report["t_junctions"])
    lines.append(f"T-junctions: {count or 'none'} (element corners inside a side of another Bezier element)")
    points = [f"valence {p['valence']} at ({p['at'][0]:.6g}, {p['at'][1]:.6g})" for p in report["extraordinary_points"]]
    lines.append(f"extraordinary points: {', '.join(points) or 'none'}")
    loops = report["boundary_loops"]
    lines.append(f"boundary: {loops or 'no'} closed chain{'s' * (loops != 1)}{_sets(report)}")
    lines.append(f"sum of functions: {_unity(report)}")
    lines.append(f"independent functions: {rank} of {n_A}{', all' if rank == n_A else ''}")
    lines.append(f"continuity: {_continuity(report['continuity'])}")
    smallest, relative = report["smallest_jacobian"], report["smallest_jacobian_relative"]
    lines.append(f"area: {report['area']:.12g}")
    lines.append(f"smallest Jacobian: {smallest:.4g}; of the mean of an element at least {relative:.3g}")
    return lines


def _sets(report: dict) -> str:
    sides = [part for part in report["sets"] if part["kind"] == "side"]
    whole = {name.removesuffix("-1") for name in report["chains"]} | set(report["chains"])
    words = [
        f"{part['name']} ({part['entries']} sides{'' if part['name'] in whole else ', no chain'})" for part in sides
    ]
    return f"; side sets {', '.join(words)}" if words else ""


def _unity(report: dict) -> str:
    unity, weighted = report["sum_of_functions_misses_one_by"], report["weighted_sum_misses_one_by"]
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
