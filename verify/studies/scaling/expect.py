"""What measured runs let expect of many ranks: ranges, and what each of their ends takes for granted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite, log2

from verify.studies.scaling.growth import Fit, amdahl, serial_part
from verify.studies.scaling.row import PARTS, Row

#: Ranks that are asked about.
MANY = (64, 1000)

#: Columns of cells that a piece of the strip, cut across at both ends, has from its neighbours.
GHOSTS = 2

#: A band that is dissected fills in at the cuts: about so many times the work of eliminating it from one end
#: (Arbenz, Cleary, Dongarra and Hegland 1999).
DISSECTED = 4.0

#: Unknowns a rank from which on PETSc's own advice has ranks worth their messages.
WORTH = 20_000

#: Phases of the direct solver; on one rank it is another one than on more.
DIRECT = ("factor", "solve")

Range = tuple[float, float]


@dataclass(frozen=True)
class Shared:
    """A size on some ranks against the same on one.

    speed_up, serial : of an iteration ("iteration") and of its parts, with the part of the time that is not shared
    """

    dofs: int
    ranks: int
    speed_up: Mapping[str, float]
    serial: Mapping[str, float]

    @property
    def efficiency(self) -> float:
        return self.speed_up["iteration"] / self.ranks


@dataclass(frozen=True)
class Expectation:
    """The largest size on many ranks.

    unknowns, columns, ghosts : of a rank; columns of cells, and those of its neighbours over its own
    speed_up : of an iteration and of its parts, lowest and highest
    seconds : of an iteration
    memory_mb : of all ranks together
    """

    ranks: int
    unknowns: float
    columns: float
    ghosts: float
    speed_up: Mapping[str, Range]
    seconds: Range
    memory_mb: float


@dataclass(frozen=True)
class Larger:
    """A size that gives each of many ranks enough to do; nothing of it was run.

    seconds, memory_mb : of an iteration on one rank, from as the fits go on to no better than in proportion to the
        largest size, for what grows more slowly than the unknowns is not done with its beginnings; ``shared`` as many
        times less as there are ranks
    elements : along the specimen
    """

    ranks: int
    dofs: int
    elements: int
    seconds: Range
    shared: Range
    memory_mb: Range


def shared(rows: Sequence[Row]) -> list[Shared]:
    """Every run on more ranks than one against its like on one."""
    alone = {one.elements: one for one in rows if one.measured and one.ranks == 1 and one.method == "dolfinx"}
    found = []
    for one in rows:
        if one.measured and one.ranks > 1 and one.elements in alone:
            base = alone[one.elements]
            faster = {name: _ratio(getattr(base, name), getattr(one, name)) for name in ("iteration", *PARTS)}
            serial = {name: serial_part(value, one.ranks) for name, value in faster.items()}
            found.append(Shared(one.dofs, one.ranks, faster, serial))
    return sorted(found, key=lambda one: (one.dofs, one.ranks))


def whatever_the_size(rows: Sequence[Row]) -> dict[int, float]:
    """Seconds of an iteration that do not grow with the unknowns, by ranks: of the straight line through two sizes."""
    found = {}
    for ranks in {one.ranks for one in rows if one.ranks > 1 and one.measured}:
        of_ranks = sorted((o for o in rows if o.ranks == ranks and o.measured), key=lambda o: o.dofs)
        sizes = {one.dofs for one in of_ranks}
        alone = sorted((o for o in rows if o.ranks == 1 and o.dofs in sizes and o.measured), key=lambda o: o.dofs)
        for n, pair in ((ranks, of_ranks), (1, [one for one in alone if one.method == "dolfinx"])):
            if len(pair) > 1:
                found[n] = _at_zero(pair[0], pair[-1])
    return found


def _at_zero(small: Row, large: Row) -> float:
    slope = (large.iteration - small.iteration) / (large.dofs - small.dofs)
    return small.iteration - slope * small.dofs


def expectation(
    ranks: int, base: Row, most: Shared, columns: int, waiting: float, memory: tuple[float, float]
) -> Expectation:
    """What one size on so many ranks may take.

    Parameters
    ----------
    base, most : that size on one rank, and on the most ranks that were tried
    columns : of cells along the specimen
    waiting : seconds of an iteration that ranks wait for one another, for one stage of messages (see `stages`)
    memory : megabytes of the program, and of the model
    """
    own = columns / ranks
    ghosts = GHOSTS / own
    best = {name: ranks / (1.0 + ghosts) for name in PARTS}
    best |= {name: max(ranks / DISSECTED, most.speed_up[name]) for name in DIRECT if isfinite(most.speed_up[name])}
    worst = {name: min(amdahl(max(most.serial[name], 0.0), ranks), best[name]) for name in PARTS}
    low = sum(getattr(base, name) / best[name] for name in PARTS)
    high = sum(getattr(base, name) / worst[name] for name in PARTS) + waiting * stages(ranks)
    faster = {name: (worst[name], best[name]) for name in PARTS}
    faster["iteration"] = (base.iteration / high, base.iteration / low)
    program, model = memory
    return Expectation(
        ranks,
        base.dofs / ranks,
        own,
        ghosts,
        faster,
        (low, high),
        ranks * program + model * (1.0 + ghosts),
    )


def stages(ranks: int) -> float:
    """Stages of messages of a sum over all ranks, by a tree."""
    return log2(ranks)


def larger(ranks: int, base: Row, columns: int, iteration: Fit, memory: Fit, model_mb: float) -> Larger:
    """A size with `WORTH` unknowns a rank; ``model_mb`` is what ``base`` adds to the memory of the program."""
    dofs = WORTH * ranks
    times = dofs / base.dofs
    seconds = _onwards(iteration.at(dofs), times * base.iteration)
    shared = seconds[0] / ranks, seconds[1] / ranks
    return Larger(ranks, dofs, round(columns * times), seconds, shared, _onwards(memory.at(dofs), times * model_mb))


def _onwards(fitted: Range, in_proportion: float) -> Range:
    return min(fitted[0], in_proportion), max(fitted[1], in_proportion)


def _ratio(before: float, after: float) -> float:
    return before / after if after > 0 else inf
