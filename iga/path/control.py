"""Controls: the one scalar equation in displacements and load that a step prescribes.

Each control is a function of a state and its response that gives its value and its gradient. Newton borders the
equations of equilibrium by any one of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from iga.interface.response import holding
from iga.system.state import Response, State
from iga.system.system import System

#: Value at a state with its response, gradient by the displacements (n_dof,), derivative by the load.
Control = Callable[[State, Response], tuple[float, np.ndarray, float]]


@dataclass(frozen=True)
class Prescribed:
    """A control, its prescribed value, and its change in this step, to which its tolerance is relative."""

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
    """The quantity that drives the damage at one point of the interface (`Response.x_q`): where the bond only opens,
    the gap."""

    def control(state: State, response: Response) -> tuple[float, np.ndarray, float]:
        return float(response.x_q[point]), response.x_rows.gradients(np.array([point]), system.n_dof)[:, 0], 0.0

    return control


def dissipation_control(system: System) -> Control:
    """Integral of the largest scaled jumps of the bond, from onset to failure, with the history that the state would
    leave. The dissipation of the bilinear law is proportional to it.

    Path following by dissipation after Gutierrez (2004) and Verhoosel, Remmers and Gutierrez (2009), but by the law
    itself instead of ``(P0 dDelta - dP Delta0) / 2``, which holds for secant unloading and linear kinematics alone.
    """
    interface, law = system.interface, system.interface.law

    def control(state: State, response: Response) -> tuple[float, np.ndarray, float]:
        x_q, (first, last) = response.x_q, (law.kinks[0], law.kinks[-1])
        way_q = np.clip(np.maximum(x_q, response.back_q), first, last)
        growing_q = (x_q >= (1.0 - 1e-9) * way_q) & (x_q < last)  # 1e-9: rounding on return to the envelope
        held_q = holding(interface, response.contact) & growing_q
        return float(interface.dA_q @ way_q), response.x_rows.forces(interface.dA_q * held_q, system.n_dof), 0.0

    return control


def arc_length_control(system: System, start: Response, du_d: np.ndarray) -> Control:
    """Distance from a state along a direction ``du_d``, measured in the gaps of the points that are not broken yet.

    A local arc length (May and Duan 1997): only the process zone counts, and not the load, which has another unit.
    """
    interface = system.interface
    whole_q = (start.k_q < interface.law.failed) & holding(interface, start.contact)
    rate_q = np.where(whole_q, start.x_rates(du_d), 0.0)
    rate_q = rate_q / (np.sqrt(interface.dA_q @ rate_q**2 * interface.dA_q.sum()) or 1.0)
    x0_q = start.x_q

    def control(state: State, response: Response) -> tuple[float, np.ndarray, float]:
        value = float(interface.dA_q @ (rate_q * (response.x_q - x0_q)))
        return value, response.x_rows.forces(rate_q * interface.dA_q, system.n_dof), 0.0

    return control
