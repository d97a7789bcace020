"""Kratos on one folder: its elements, interface elements, law and Newton's method; needs nothing of debond."""

import json
import sys
from pathlib import Path

import KratosMultiphysics as kratos
import KratosMultiphysics.LinearSolversApplication
import KratosMultiphysics.PoromechanicsApplication as poro
import KratosMultiphysics.StructuralMechanicsApplication as structural
import numpy as np
from KratosMultiphysics import python_linear_solver_factory
from KratosMultiphysics.scipy_conversion_tools import to_csr
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import splu

#: Residual over the first one of a step, Newton iterations of a step at most, and halvings of a step at most.
TOLERANCE, ITERATIONS, HALVINGS = 1e-6, 20, 8
#: What the elements of a porous joint ask for beside the law, without effect where the pressure of the fluid is held.
FLUID = {
    "INITIAL_JOINT_WIDTH": 1e-3,
    "TRANSVERSAL_PERMEABILITY_COEFFICIENT": 1.0,
    "BULK_MODULUS_SOLID": 1e12,
    "BULK_MODULUS_LIQUID": 1e12,
    "POROSITY": 0.3,
    "DENSITY_SOLID": 0.0,
    "DENSITY_LIQUID": 0.0,
    "DYNAMIC_VISCOSITY_LIQUID": 1.0,
    "BIOT_COEFFICIENT": 1.0,
    "PERMEABILITY_XX": 1.0,
    "PERMEABILITY_YY": 1.0,
    "PERMEABILITY_XY": 0.0,
}
QUADRILATERAL = {4: "SmallDisplacementElement2D4N", 8: "SmallDisplacementElement2D8N"}


def properties(part, number, law, numbers):
    """Material ``number`` of a part."""
    made = part.CreateNewProperties(number)
    for name, value in numbers.items():
        made.SetValue(kratos.KratosGlobals.GetVariable(name), value)
    made.SetValue(kratos.CONSTITUTIVE_LAW, law)
    return made


def model_part(model, given, told):
    """Nodes, elements and materials."""
    part = model.CreateModelPart("scene", 2)
    pressure, reaction = poro.LIQUID_PRESSURE, poro.REACTION_LIQUID_PRESSURE
    variables = [kratos.DISPLACEMENT, kratos.REACTION, kratos.VELOCITY, kratos.ACCELERATION, kratos.VOLUME_ACCELERATION]
    for one in (*variables, pressure, reaction, poro.DT_LIQUID_PRESSURE, poro.INITIAL_STRESS_TENSOR):
        part.AddNodalSolutionStepVariable(one)
    part.ProcessInfo[kratos.DOMAIN_SIZE] = 2
    for coefficient in (poro.VELOCITY_COEFFICIENT, poro.DT_LIQUID_PRESSURE_COEFFICIENT):
        part.ProcessInfo[coefficient] = 1.0
    for number, (x, y) in enumerate(given["X_nI"].tolist(), 1):
        part.CreateNewNode(number, x, y, 0.0)
    plane, joint = structural.LinearElasticPlaneStress2DLaw(), poro.IsotropicDamageCohesive2DLaw()
    arms, bond = properties(part, 1, plane, told["arms"]), properties(part, 2, joint, {**FLUID, **told["bond"]})
    number = 0
    for name, elements, made in (
        (QUADRILATERAL[given["conn_ea"].shape[1]], given["conn_ea"], arms),
        ("UPlSmallStrainInterfaceElement2D4N", given["cohesive_ea"], bond),
    ):
        for nodes in (1 + elements).tolist():
            number += 1
            part.CreateNewElement(name, number, nodes, made)
    zero = kratos.Matrix(3, 3)
    for i in range(3):
        for j in range(3):
            zero[i, j] = 0.0
    for node in part.Nodes:
        node.AddDof(kratos.DISPLACEMENT_X, kratos.REACTION_X)
        node.AddDof(kratos.DISPLACEMENT_Y, kratos.REACTION_Y)
        node.AddDof(kratos.DISPLACEMENT_Z, kratos.REACTION_Z)
        node.AddDof(pressure, reaction)
        node.Fix(kratos.DISPLACEMENT_Z)
        node.Fix(pressure)
        node.SetSolutionStepValue(poro.INITIAL_STRESS_TENSOR, zero)
    return part


class Newton:
    """Newton's method with the forces and the tangent of Kratos.

    Its law caps the damage of a broken point, and yet takes the slope of the softening there: as long as a point opens
    its stiffness is negative, and no iteration converges once the first one is broken. So it is taken out again here.
    """

    def __init__(self, part, given, numbers):
        linear = python_linear_solver_factory.ConstructSolver(
            kratos.Parameters('{"solver_type": "skyline_lu_factorization"}')
        )
        self.part, self.builder = part, kratos.ResidualBasedEliminationBuilderAndSolver(linear)
        self.scheme = kratos.ResidualBasedIncrementalUpdateStaticScheme()
        criterion = kratos.ResidualCriteria(1e-9, 1e-9)  # not used: the iterations are made here
        self.strategy = kratos.ResidualBasedNewtonRaphsonStrategy(
            part, self.scheme, criterion, self.builder, 1, True, False, False
        )
        self.strategy.SetEchoLevel(0)
        self.strategy.Initialize()
        self.nodes = [(node, kratos.DISPLACEMENT_X, kratos.DISPLACEMENT_Y) for node in part.Nodes]
        self.pairs = [tuple(part.GetNode(n + 1) for n in pair) for pair in given["pair_kb"].tolist()]
        self.length_k = np.zeros(len(self.pairs))
        sides = 0.5 * np.diff(given["X_nI"][given["pair_kb"][:, 0], 0])
        self.length_k[:-1] += sides
        self.length_k[1:] += sides
        K, S = numbers["NORMAL_STIFFNESS"], numbers["TENSILE_STRENGTH"]
        self.onset, self.broken = S / K, S / K + 2.0 * numbers["FRACTURE_ENERGY"] / S
        self.slope = K * self.onset * self.broken / (self.broken - self.onset)
        self.largest = np.zeros(len(self.pairs))

    def gaps(self):
        along = kratos.DISPLACEMENT_Y
        heights = [[node.GetSolutionStepValue(along) for node in pair] for pair in self.pairs]
        return np.diff(heights, axis=1)[:, 0]

    def too_soft(self, size):
        """What the tangent lacks at broken points that open."""
        gap = self.gaps()
        (opens,) = np.nonzero((gap > self.broken) & (gap > self.largest))
        rows = [[node.GetDof(kratos.DISPLACEMENT_Y).EquationId for node in self.pairs[k]] for k in opens]
        if not rows:
            return csr_matrix((size, size))
        lower, upper = np.transpose(rows)
        stiff = self.length_k[opens] * self.slope / gap[opens]
        at = np.ravel([lower, lower, upper, upper]), np.ravel([lower, upper, lower, upper])
        return csr_matrix((np.ravel([stiff, -stiff, -stiff, stiff]), at), shape=(size, size))

    def converges(self):
        """Whether the displacements come to rest under what is prescribed."""
        self.strategy.InitializeSolutionStep()
        self.strategy.Predict()
        A, b = self.strategy.GetSystemMatrix(), self.strategy.GetSystemVector()
        space = kratos.UblasSparseSpace()
        for self.iterations in range(ITERATIONS + 1):
            space.SetToZeroMatrix(A)
            space.SetToZeroVector(b)
            self.builder.Build(self.scheme, self.part, A, b)
            residual = np.array(b)
            if not self.iterations:
                enough = TOLERANCE * np.abs(residual).max()
            elif np.abs(residual).max() < enough:
                return True
            change = splu((to_csr(A) + self.too_soft(residual.size)).tocsc()).solve(residual)
            if not np.isfinite(change).all():
                return False
            for node, *components in self.nodes:
                for one in components:
                    equation = node.GetDof(one).EquationId
                    if equation < change.size:
                        node.SetSolutionStepValue(one, node.GetSolutionStepValue(one) + change[equation])
        return False

    def react(self):
        """Compute the reactions."""
        system = (self.strategy.GetSystemMatrix(), self.strategy.GetSolutionVector(), self.strategy.GetSystemVector())
        self.builder.CalculateReactions(self.scheme, self.part, *system)


def solve(folder):
    """Print a line for every step, and one at the end."""
    print("ready", flush=True)
    kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)
    given, told = np.load(folder / "mesh.npz"), json.loads((folder / "problem.json").read_text())
    model = kratos.Model()
    part = model_part(model, given, told)
    along = (kratos.DISPLACEMENT_X, kratos.DISPLACEMENT_Y)
    for nodes, component in told["held"]:
        for node in nodes:
            part.GetNode(node + 1).Fix(along[component])
    moved = [(part.GetNode(n + 1), share) for nodes, share in told["loaded"] for n in nodes]
    for node, _ in moved:
        node.Fix(kratos.DISPLACEMENT_Y)
    pulled = [part.GetNode(n + 1) for n in told["loaded"][0][0]]
    newton, opening, end, step = (
        Newton(part, given, told["bond"]),
        0.0,
        told["opening"],
        told["opening"] / told["steps"],
    )
    length, time = step, 0.0
    while opening < end * (1.0 - 1e-9):
        goal, time = min(opening + length, end), time + 1.0
        part.CloneTimeStep(time)
        before = [(node, node.GetSolutionStepValue(kratos.DISPLACEMENT)) for node in part.Nodes]
        for node, share in moved:
            node.SetSolutionStepValue(kratos.DISPLACEMENT_Y, share * goal)
        converged = newton.converges()
        part.ProcessInfo[poro.IS_CONVERGED] = converged  # without which the law keeps no history
        if converged:
            newton.react()
            load = sum(node.GetSolutionStepValue(kratos.REACTION_Y) for node in pulled)
            newton.largest = np.maximum(newton.largest, newton.gaps())
            opening, length = goal, min(2.0 * length, step)
            row = {"opening": opening, "load": told["width"] * load, "newton_iterations": newton.iterations}
            print("row", json.dumps(row), flush=True)
        newton.strategy.FinalizeSolutionStep()
        if not converged:
            length /= 2.0
            for node, u in before:
                node.SetSolutionStepValue(kratos.DISPLACEMENT, u)
        if length < step / 2**HALVINGS:
            print("end", json.dumps(f"no convergence on the way to {goal:g}"), flush=True)
            return
    print("end", json.dumps(""), flush=True)


if __name__ == "__main__":
    solve(Path(sys.argv[1]))
