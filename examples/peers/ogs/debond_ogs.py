"""A double cantilever beam by OpenGeoSys: writes mesh and project file, and reads the rows of `debond_ogs_run`."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from verify.export.mesh import scene_mesh
from verify.export.numbers import effects, law
from verify.methods import peers
from verify.result import Result, steps_from_rows
from verify.scene.schema import counted_steps

#: Numbers of OpenGeoSys: kinds of cells of VTK, material of the arms and of the bond.
LINES, QUADRILATERALS, ARMS, BOND = {1: 3, 2: 21}, {1: 9, 2: 23}, 0, 1
#: Opening at the beginning, which nothing closes: closing is linear far from it. Over that of failure.
APERTURE = 1e6
#: Change of the displacements in the last iteration, over the largest opening.
TOLERANCE = 1e-7
#: Iterations of a step at most: the tangent of the softening makes their changes a half to two thirds of those before.
ITERATIONS = 200


def unsuitable(scene):
    """Why the solver is not made for a scene, or nothing."""
    asked = effects(scene)
    if asked["kinematics"] != "linear" or not asked["irreversible"]:
        return 'effects: kinematics must be "linear", and irreversible true'
    if len(scene.load.opening) > 1:
        return "only for arms that are pulled apart once"
    return peers.unless_plain_dcb(scene)


def solve(scene, on_step):
    """Load over opening; ``[dolfinx]`` of the scene sets elements, layers and degree."""
    mesh, rows, why, started = scene_mesh(scene), [], "", 0.0

    def read(line):
        kind, _, text = line.partition(" ")
        if kind == "row":
            rows.append(json.loads(text))
            on_step(rows[-1])

    with TemporaryDirectory() as folder:
        write(scene, mesh, Path(folder))
        script = Path(__file__).with_name("debond_ogs_run.py")
        try:
            started = peers.run("ogs", [peers.known()["ogs"].interpreter, script], Path(folder), read)
        except RuntimeError as error:
            why = str(error)
    if not rows:
        raise RuntimeError(why or "ogs has ended without a row")
    size = {"dofs": mesh.X_nI.size, "elements": len(mesh.conn_ea), "jit_seconds": started}
    return Result("ogs", steps_from_rows(rows), f"stopped: {why}" if why else "complete", **size)


solve.unsuitable = unsuitable
#: Elements in the process zone on the coarsest mesh of `debond cost`, by the degree.
solve.degrees = {1: 4.0, 2: 1.0}


def write(scene, mesh, folder):
    """The mesh, a mesh of points for each condition, the project file, and what a row needs."""
    p, bond, material = mesh.degree, law(scene), scene.materials[0]
    lower, upper = mesh.pair_kb.T
    kept = np.setdiff1d(np.arange(len(mesh.X_nI)), upper)  # both sides of the bond share a node, whose jump is unknown
    number = np.empty(len(mesh.X_nI), dtype=int)
    number[kept] = np.arange(len(kept))
    number[upper] = number[lower]
    X_nI, sides = mesh.X_nI[kept], number[lower]
    line_ea = np.stack([sides[:-1:p], sides[p::p], *([sides[1::2]] if p == 2 else [])], axis=1)
    cells = [(QUADRILATERALS[p], ARMS, conn) for conn in number[mesh.conn_ea]]
    cells += [(LINES[p], BOND, conn) for conn in line_ea]
    vtu(folder / "scene.vtu", X_nI, cells)
    conditions = {"displacement": [], "displacement_jump1": []}
    held = [(part.name, part.node_n, part.components, "zero") for part in mesh.supports]
    held += [(face.name, face.node_n, (face.component,), face.name) for face in mesh.loaded]
    for name, node_n, components, value in held:
        points(folder / f"{name}.vtu", X_nI, number[node_n])
        conditions["displacement"] += [CONDITION.format(mesh=name, i=i, value=value) for i in components]
        if np.isin(node_n, upper).any():  # the upper side moves by the jump beyond the lower one
            conditions["displacement_jump1"] += [CONDITION.format(mesh=name, i=i, value="zero") for i in components]
    # plane stress: the constants of a plane strain that is the same
    nu = material.poisson
    young = material.young * (1.0 + 2.0 * nu) / (1.0 + nu) ** 2
    largest = scene.load.opening[0]
    constants = {
        "E": young, "nu": nu / (1.0 + nu), "K": bond.stiffness, "G": bond.toughness, "S": bond.strength,
        "aperture": APERTURE * bond.g_open, "zero": 0.0, "none": "0 0",
    }  # fmt: skip
    text = PROJECT.format(
        meshes="".join(f"<mesh>{name}.vtu</mesh>" for name, *_ in held),
        constants="".join(CONSTANT.format(name=name, value=value) for name, value in constants.items()),
        loads="".join(LOAD.format(name=face.name, part=face.factor * largest) for face in mesh.loaded),
        variables="".join(VARIABLE.format(name=k, order=p, conditions="".join(v)) for k, v in conditions.items()),
        steps=counted_steps(scene),
        tolerance=TOLERANCE * largest,
        iterations=ITERATIONS,
    )
    (folder / "scene.prj").write_text(text)
    length_e = np.diff(mesh.X_nI[lower[::p], 0]).tolist()
    known = {"bond": len(mesh.conn_ea), "length": length_e, "width": scene.specimen.width, "opening": largest}
    (folder / "known.json").write_text(json.dumps(known))


def vtu(path, X_nI, cells, of_points=""):
    """A mesh as ParaView has it; cells as their kind, material and nodes."""
    kinds, materials, conn = zip(*cells, strict=True)
    places = "\n".join(f"{x!r} {y!r} 0" for x, y in X_nI.tolist())
    given = {
        "points": len(X_nI), "cells": len(cells), "of_points": of_points, "places": places,
        "materials": words(materials), "nodes": "\n".join(map(words, conn)),
        "ends": words(np.cumsum([len(one) for one in conn])), "kinds": words(kinds),
    }  # fmt: skip
    path.write_text(VTU.format(**given))


def points(path, X_nI, node_n):
    """The mesh of some nodes, with their numbers in the whole."""
    cells = [(1, ARMS, [k]) for k in range(len(node_n))]
    vtu(path, X_nI[node_n], cells, NUMBERS.format(numbers=words(node_n)))


def words(numbers):
    return " ".join(map(str, numbers))


VTU = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="{points}" NumberOfCells="{cells}">
<PointData>{of_points}</PointData>
<CellData><DataArray type="Int32" Name="MaterialIDs" format="ascii">{materials}</DataArray></CellData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{places}</DataArray></Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">{nodes}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{ends}</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">{kinds}</DataArray>
</Cells>
</Piece></UnstructuredGrid></VTKFile>
"""
NUMBERS = '<DataArray type="UInt64" Name="bulk_node_ids" format="ascii">{numbers}</DataArray>'
CONSTANT = "<parameter><name>{name}</name><type>Constant</type><values>{value}</values></parameter>\n"
LOAD = """<parameter><name>{name}_end</name><type>Constant</type><value>{part!r}</value></parameter>
<parameter><name>{name}</name><type>CurveScaled</type><curve>ramp</curve><parameter>{name}_end</parameter></parameter>
"""
CONDITION = """<boundary_condition><mesh>{mesh}</mesh><type>Dirichlet</type><component>{i}</component>
<parameter>{value}</parameter></boundary_condition>
"""
VARIABLE = """<process_variable><name>{name}</name><components>2</components><order>{order}</order>
<initial_condition>none</initial_condition><boundary_conditions>{conditions}</boundary_conditions></process_variable>
"""
PROJECT = """<?xml version="1.0" encoding="ISO-8859-1"?>
<OpenGeoSysProject>
<meshes><mesh>scene.vtu</mesh>{meshes}</meshes>
<processes><process>
<name>M</name><type>SMALL_DEFORMATION_WITH_LIE</type><integration_order>2</integration_order>
<process_variables><process_variable>displacement</process_variable>
<process_variable>displacement_jump1</process_variable></process_variables>
<constitutive_relation><type>LinearElasticIsotropic</type>
<youngs_modulus>E</youngs_modulus><poissons_ratio>nu</poissons_ratio></constitutive_relation>
<fracture_model><type>CohesiveZoneModeI</type>
<normal_stiffness>K</normal_stiffness><shear_stiffness>K</shear_stiffness>
<fracture_toughness>G</fracture_toughness><peak_normal_traction>S</peak_normal_traction>
<penalty_aperture_cutoff>1e-12</penalty_aperture_cutoff><tension_cutoff>1</tension_cutoff></fracture_model>
<fracture_properties><material_id>1</material_id><initial_aperture>aperture</initial_aperture></fracture_properties>
<secondary_variables/>
</process></processes>
<time_loop><processes><process ref="M">
<nonlinear_solver>newton</nonlinear_solver>
<convergence_criterion><type>DeltaX</type><norm_type>NORM2</norm_type><abstol>{tolerance!r}</abstol>
</convergence_criterion>
<time_discretization><type>BackwardEuler</type></time_discretization>
<time_stepping><type>FixedTimeStepping</type><t_initial>0</t_initial><t_end>{steps}</t_end>
<timesteps><pair><repeat>{steps}</repeat><delta_t>1</delta_t></pair></timesteps></time_stepping>
</process></processes>
<output><type>VTK</type><prefix>out</prefix>
<timesteps><pair><repeat>1</repeat><each_steps>{steps}</each_steps></pair></timesteps>
<variables><variable>displacement</variable></variables></output></time_loop>
<parameters>{constants}{loads}</parameters>
<curves><curve><name>ramp</name><coords>0 {steps}</coords><values>0 1</values></curve></curves>
<process_variables>{variables}</process_variables>
<nonlinear_solvers><nonlinear_solver><name>newton</name><type>Newton</type><max_iter>{iterations}</max_iter>
<linear_solver>linear</linear_solver></nonlinear_solver></nonlinear_solvers>
<linear_solvers><linear_solver><name>linear</name><eigen><solver_type>SparseLU</solver_type></eigen></linear_solver>
</linear_solvers>
</OpenGeoSysProject>
"""
