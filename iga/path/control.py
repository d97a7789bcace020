"""What is prescribed of a step: one scalar equation in displacements and load, exchangeable.

Each control is a function of a state and its response that gives its value and its gradient. Equilibrium is bordered
by any one of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from iga.interface.interface import forces, holding
from iga.system.state import Response, State
from iga.system.system import System

#: Value at a state with its response, gradient by the displacements (n_dof,), derivative by the load.
Control = Callable[[State, Response], tuple[float, np.ndarray, float]]


@dataclass(frozen=True)
class Prescribed:
    """A control, the value that it is to have, and by how much it changes in this step, for the tolerance on it."""

    control: Control
    value: float
    change: float

    def met(self, state: State, response: Response) -> bool:
        """Whether the control is within a millionth of its change, or within rounding of its value."""
        off = abs(self.control(state, response)[0] - self.value)
        return off <= max(1e-6 * abs(self.change), 1e-12 * abs(self.value))


def opening_control(system: System) -> Control:
    """Mean opening of the loaded faces."""

    def control(state: State, response: Response) -> tuple[float, np.ndarray, float]:
        return float(system.load_d @ state.u_d), system.load_d, 0.0

    return control


def load_control(system: System) -> Control:
    """The load itself."""

    def control(state: State, response: Response) -> tuple[float, np.ndarray, float]:
        return state.load, np.zeros(system.n_dof), 1.0

    return control


def gap_control(system: System, point: int) -> Control:
    """Gap at one quadrature point of the interface; at the front of a crack, the opening of the cohesive front."""

    def control(state: State, response: Response) -> tuple[float, np.ndarray, float]:
        return float(response.contact.g_q[point]), response.contact.row(point, system.n_dof), 0.0

    return control


def dissipation_control(system: System) -> Control:
    """Dissipated energy, with the history that the state would leave.

    Path following by dissipation after Gutierrez (2004) and Verhoosel, Remmers and Gutierrez (2009), but with the
    dissipation of the law itself instead of ``(P0 dDelta - dP Delta0) / 2``, which holds for secant unloading and
    linear kinematics alone.
    """
    interface = system.interface

    def control(state: State, response: Response) -> tuple[float, np.ndarray, float]:
        g_q, law = response.contact.g_q, interface.law
        dissipated = float(interface.dA_q @ law.energies(g_q, response.k_q)[2])
        growing_q = (g_q >= response.k_q) & (g_q > law.g_max) & (g_q < law.g_u) & holding(interface, response.contact)
        rate_q = np.where(growing_q, law.dissipation_rate(g_q), 0.0)
        return dissipated, forces(interface, response.contact, rate_q, system.n_dof), 0.0

    return control


def arc_length_control(system: System, start: Response, du_d: np.ndarray) -> Control:
    """Distance from a state along a direction ``du_d``, measured in the gaps of the points that are not broken yet.

    A local arc length (May and Duan 1997): the zone alone counts, and whatever its unit, the load does not.
    """
    interface = system.interface
    whole_q = (start.k_q < interface.law.g_u) & holding(interface, start.contact)
    rate_q = np.where(whole_q, start.contact.rates(du_d), 0.0)
    rate_q = rate_q / (np.sqrt(interface.dA_q @ rate_q**2 * interface.dA_q.sum()) or 1.0)
    g0_q = start.contact.g_q

    def control(state: State, response: Response) -> tuple[float, np.ndarray, float]:
        value = float(interface.dA_q @ (rate_q * (response.contact.g_q - g0_q)))
        return value, forces(interface, response.contact, rate_q, system.n_dof), 0.0

    return control
