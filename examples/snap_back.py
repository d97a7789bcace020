# %% [markdown]
# # Snap-back, and how to follow it
#
# A debonding specimen is pulled apart, and at some point the solver stops: no equilibrium found, however small the
# step. Often nothing is wrong with the solver. It was asked to go somewhere where there is no equilibrium nearby.

# %%
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from iga.path.control import Prescribed, dissipation_control, load_control, opening_control
from iga.path.newton import equilibrium
from iga.path.solver import Solver
from iga.system.system import energies, respond
from verify.curves.curve import envelope
from verify.methods.solve import prepare, solve
from verify.scene import load_scene

# %% [markdown]
# ## One spring and one bond
#
# A spring of compliance $c$ pulls on a single bond that softens linearly from the strength $P_1$ at the gap $g_1$ to
# nothing at $g_u$. The end of the spring is at $\delta = c P + g$, and on the way down
#
# $$ \frac{d\delta}{dP} = c - \frac{g_u - g_1}{P_1} . $$
#
# Where the spring is softer than the bond is brittle, $c > (g_u - g_1) / P_1$, the end must move *back* while the bond
# opens: the spring relaxes by more than the bond gives way. Pull on, and the bond fails at a bang instead.

# %%
P1, g1, g_u = 1.0, 0.1, 1.0
P = np.linspace(P1, 0.0, 11)
for c in (0.5, 2.0):
    opening = c * P + g_u - (g_u - g1) * P / P1
    print(f"c = {c}: delta from {opening[0]:.2f} to {opening[-1]:.2f}", "forth" if opening[-1] > opening[0] else "back")

# %% [markdown]
# ## A mesh is full of springs
#
# A true double cantilever beam does not snap back. On a coarse mesh each integration point is a bond and the element
# around it a spring, and that spring is the softer the longer the element is. Here is an interface stronger than
# 280 unknowns can resolve. The solver's own path goes back and forth:

# %%
scene = load_scene("dcb-czm2-linear", ["interface.strength=20", "discretization.dofs=280", "load.opening=1.2"])
run = solve(scene, "nurbs")
backs = int(np.sum(np.diff(run.opening) < 0.0))
turns = int(np.sum((np.diff(run.opening)[:-1] >= 0.0) & (np.diff(run.opening)[1:] < 0.0)))
print(f"{run.load.size - 1} steps, {backs} of them backwards, in {turns} snap-backs; {run.status}")

# %% [markdown]
# ## Three ways to ask for the next point
#
# Equilibrium is one equation short: displacements and load are both unknown, so something has to be prescribed. Take
# the state just before the first snap-back and ask for the next one by the load, by the opening, and by the energy
# that the bond dissipates.

# %%
solver, problem = prepare(scene, "nurbs").problem
system = solver.build(problem).system
controls = {
    "load": load_control(system),
    "opening": opening_control(system),
    "dissipation": dissipation_control(system),
}


def reached(state):
    return float(system.load_d @ state.u_d), state.load, energies(system, state, respond(system, state, decide=False))


def ask(state, name, change):
    """The state where a control has changed by so much, its history committed; None where Newton finds none."""
    control = controls[name]
    value = control(state, respond(system, state, decide=False))[0]
    found = equilibrium(Solver(system), state, Prescribed(control, value + change, change))
    if found is None:
        return None
    return replace(found.state, k_q=found.response.k_q, scale=max(state.scale, found.response.scale))


# %% [markdown]
# A path follower in ten lines: the opening leads until something breaks, then the dissipated energy does. It can only
# grow, so it cannot turn back: every state of the path has its own value of it. The control counts it in gaps: a bond
# of the bilinear law has dissipated all of its toughness on the way from the onset to failure.

# %%
lump = 0.02 * scene.interface.toughness * scene.specimen.width
onset, failure = system.interface.law.kinks
broken = lump / scene.interface.toughness * (failure - onset)
states = [system.start()]
while (at := reached(states[-1]))[0] < 1.0:
    damaged = at[2].dissipated > 0.0
    states.append(ask(states[-1], "dissipation", broken) if damaged else ask(states[-1], "opening", 0.02))
path = np.array([[d, load, e.stored, e.dissipated] for d, load, e in map(reached, states)])
d, load, stored, dissipated = path.T
first = int(np.argmax(np.diff(d) < 0.0))
print(f"{len(states) - 1} steps; first snap-back at opening {d[first]:.3f}")

for name, change in (("load", 0.01 * load[first]), ("opening", 0.01 * d[first]), ("dissipation", broken)):
    found = ask(states[first], name, change)
    if found is None:
        print(f"{name:12} no equilibrium found")
    else:
        there = reached(found)
        print(
            f"{name:12} opening {there[0] - d[first]:+.4f}, load {there[1] - load[first]:+.4f}, "
            f"dissipated {(there[2].dissipated - dissipated[first]) / lump:.1f} lumps"
        )

# %% [markdown]
# ## What a test would show
#
# A testing machine prescribes the opening. It cannot go back, and where the path does the load drops at once
# (`verify.curves.curve.envelope`). The area between the path and that drop is energy that neither the bond nor the
# specimen takes: in the machine it is a bang. In a table of energies it is missing, so a code that jumps across a
# snap-back cannot close its ledger, and one that follows can.

# %%
work = np.append(0.0, np.cumsum(np.diff(d) * (load[1:] + load[:-1]) / 2))
jumping = np.trapezoid(*envelope(d, load)[::-1])
print(f"work along the path {work[-1]:.5f}, under the envelope {jumping:.5f} N mm")

figure, axes = plt.subplots(figsize=(7, 3.8), constrained_layout=True)
axes.plot(run.opening, run.load, color="#0072b2", linewidth=4, alpha=0.3, label="the solver's path")
axes.plot(d, load, ".-", color="#1b2330", markersize=3, linewidth=0.6, label="ten lines")
axes.plot(*envelope(d, load), "--", color="#d55e00", linewidth=1, label="what a test would show")
axes.set(xlabel="opening (mm)", ylabel="load (N)", xlim=(0, 1), ylim=(0, None))
axes.legend(frameon=False)
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)

# %% [markdown]
# The ten lines close the ledger: work done is energy stored and dissipated, at every step and through every snap-back.
# The rest is the trapezoidal rule of the work.

# %%
ledger = np.abs(work - stored - dissipated).max() / work[-1]
print(f"ledger: {ledger:.2%} of the work; lost in jumps: {jumping / work[-1] - 1:.1%}")
assert backs > 0 and ledger < 0.002 < jumping / work[-1] - 1
