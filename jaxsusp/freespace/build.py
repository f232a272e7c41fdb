"""Scenario → FreeSpace: seeds, regions, coverage, route."""

import hashlib
import inspect
import json
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from jaxsusp._cache import cache_folder, code_digest, keeping, used
from jaxsusp.errors import InputError, require, require_count, require_seed
from jaxsusp.freespace.bodies import bodies_of, domain_of
from jaxsusp.freespace.cells.doorstep import opened
from jaxsusp.freespace.ellipsoid import SOLVER, require_solver
from jaxsusp.freespace.graph import RegionGraph, worth_keeping
from jaxsusp.freespace.iris import Bodies, Region, iris, proved_apart
from jaxsusp.freespace.orientation import (
    turn_of,
    turned_body,
    turned_ellipsoid,
    turned_halves,
    turned_points,
    undone,
)
from jaxsusp.freespace.polyhedra import Point, Points, irredundant
from jaxsusp.freespace.routes import WaySearch
from jaxsusp.freespace.space import FreeSpace, assemble, load_free_space
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.scenario.world import lowest

SAMPLES = 20_000
"""Positions drawn in the workspace at a time, to estimate coverage and to find seeds."""

TARGETS = 5
"""Intermediate target points on the start–goal line that regions are seeded at (the paper's)."""

CANDIDATES = 4
"""Seeds that are tried per further region; the one that adds most coverage is kept."""

WORTH = 0.5
"""Share of the best one's gain for which others of these seeds are kept too, of many bodies."""

FINER = {"coverage": 0.99, "limit": 400}
"""Settings of `free_space` for regions that look into smaller corners."""

WAYS = 8
"""Distinct ways from start to goal that are kept, taut ones and level ones."""

_CODE = ("freespace", "geometry", "mechanics", "scenario")
"""Rooms whose code decides what a free space comes to."""


class Growth(NamedTuple):
    """What a progress callback is told."""

    regions: int
    coverage: float  # of the samples at hand
    connected: bool  # start and goal


def free_space(
    scenario: Scenario | Named,
    coverage: float = 0.95,
    limit: int = 200,
    seed: int = 0,
    solver: str = SOLVER,
    routes: bool = True,
    cache: bool = True,
    progress: Callable[[Growth], None] | None = None,
) -> FreeSpace:
    """Convex regions of load positions in which the load and all cables are clear (Eq. 23).

    Where the ends of the cables move, a position of the load does not say where the cables are:
    regions are then clear for the load alone.

    Regions are grown until start and goal are connected and the share of sampled free positions
    that lie in a region is reached. The answer is kept in a cache by the content of the scenario
    and the settings, see `jaxsusp._cache`.

    Args:
        scenario: the task; any number of robots. Its start and goal may be inadmissible: the space
            is covered all the same, and there is no route.
        coverage: share of the free space to cover, in (0, 1).
        limit: greatest number of regions.
        seed: of the samples.
        solver: of the cone programs, by the name cvxpy knows it by.
        routes: whether distinct ways from start to goal are looked for (a second or two).
        cache: whether to look it up, and to keep it.
        progress: called after every region.

    Returns:
        The free space. Where start and goal could not be connected, its `reason` says what was
        tried.

    Raises:
        InputError: bad settings, or an end of a cable inside a warning area.
    """
    asked = load_scenario(scenario, task_checked=False)
    scenario = asked.own
    require(0 < coverage < 1, f"coverage = {coverage!r}: give a share between 0 and 1")
    require_count("limit", limit, least=2)
    require_seed(seed)
    settings = {
        "coverage": coverage,
        "limit": limit,
        "seed": seed,
        "solver": solver,
        "routes": routes,
    }
    file = _cache_file(scenario, settings) if cache else None
    if file and (known := _kept(file)):
        return known.stated(asked.units)
    require_solver(solver)
    space = _Builder(scenario, settings, progress).build()
    if file:
        with keeping(file):
            space.save(file)
    return space.stated(asked.units)


def known_free_space(scenario: Scenario | Named) -> FreeSpace | None:
    """What `free_space` with its defaults has in the cache; None where it would have to build."""
    asked = load_scenario(scenario, task_checked=False)
    given = inspect.signature(free_space).parameters
    names = ("coverage", "limit", "seed", "solver", "routes")
    file = _cache_file(asked.own, {name: given[name].default for name in names})
    known = _kept(file) if file else None
    return known and known.stated(asked.units)


def _kept(file: Path) -> FreeSpace | None:
    """What a file of the cache holds; None where it is missing or damaged."""
    with suppress(InputError, OSError):
        known = load_free_space(file)
        used(file)
        return known
    return None


def _cache_file(scenario: Scenario, settings: dict) -> Path | None:
    folder = cache_folder("free-space")
    if folder is None:
        return None
    task = scenario.digest, scenario.frame, scenario.troubles
    content = [code_digest(*_CODE), *task, settings]
    digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
    return folder / f"{digest[:32]}.nc"


class _Builder:
    """Grows the regions of one scenario."""

    def __init__(
        self, scenario: Scenario, settings: dict, progress: Callable[[Growth], None] | None
    ):
        clock = time.perf_counter()
        self.settings, self.progress, self.frame = settings, progress, scenario.frame
        self.troubles = scenario.troubles
        self.turn = turn = turn_of(scenario)  # all that follows is turned
        task = scenario.task
        self.start, self.goal = turned_points(np.array([task.start, task.goal]), turn)
        corners = np.array([lowest(scenario), scenario.workspace.upper])
        self.corners = np.sort(turned_points(corners, turn), axis=0)
        self.domain = turned_halves(domain_of(scenario), turn)
        everything = [turned_body(b, turn) for b in opened(scenario, bodies_of(scenario, turn))]
        self.bodies = Bodies([b for b in everything if not proved_apart(self.domain, b)])
        self.random = np.random.default_rng(settings["seed"])
        self.graph = RegionGraph()
        self.reason = ""  # why no route is looked for
        self.seconds = {"bodies": time.perf_counter() - clock}

    def build(self) -> FreeSpace:
        """Regions, coverage, route."""
        clock = time.perf_counter()
        self.reason = self._seed_task()
        covered = self._cover()
        if not (self.reason or self._connected):
            self.reason = self._disconnected(covered)
        return self._describe(covered, clock)

    def _describe(self, coverage: float, clock: float) -> FreeSpace:
        self.seconds["regions"] = time.perf_counter() - clock
        clock = time.perf_counter()
        route, polyline, bound, ways, level = [], np.empty((0, 3)), np.inf, (), ()
        faces = tuple(body.faces for body in self.bodies.bodies)
        names = tuple(body.name for body in self.bodies.bodies)
        if not self.reason:
            route = self.graph.route(self.start, self.goal)
            if self.settings["routes"]:
                search = WaySearch(self.graph, faces, names, self.start, self.goal, self.turn)
                ways = tuple(islice(search.routes(), WAYS))
                level = tuple(islice(search.level(), WAYS))
                route = search.joined(ways[0]) or route
            polyline, bound = self.graph.shortest_polyline(
                route, self.start, self.goal, self.settings["solver"]
            )
        self.seconds["route"] = time.perf_counter() - clock
        back = undone(self.turn)
        return assemble(
            [
                Region(
                    turned_halves(region.polytope, back), turned_ellipsoid(region.ellipsoid, back)
                )
                for region in self.graph.regions
            ],
            adjacency=self.graph.adjacency,
            route=np.array(route, int),
            polyline=turned_points(polyline, back),
            bound=bound,
            coverage=coverage,
            reason=self.reason,
            bodies=tuple(turned_halves(each, back) for each in faces),
            body_names=names,
            routes=tuple(
                each._replace(polyline=turned_points(each.polyline, back)) for each in ways
            ),
            level=tuple(turned_points(each, back) for each in level),
            details={**self.settings, "bodies": len(self.bodies), "seconds": self.seconds},
        )

    def _seed_task(self) -> str:
        """Regions at start and goal; what stands in the way, if anything does."""
        places = (("task.start", self.start), ("task.goal", self.goal))
        reasons = [self._seed(name, place) for name, place in places]
        return "; ".join(filter(None, reasons))

    def _seed(self, name: str, place: Point) -> str:
        """A region at a place of the task; why it is no place for the load, if it is none."""
        trouble = next((line for line in self.troubles if line.startswith(name)), "")
        if self.graph.holding(place):
            return trouble
        where = self._in_world(place)
        try:
            region = self._grow(place)
        except InputError as error:
            blocked = str(error).partition(" is ")[2].rpartition("; choose")[0]
            why = f"{blocked}, round obstacles taken up to 2 % larger"
            if self.domain.excess(place) > 0:
                why = "outside the workspace, or where not all cables pull"
            return f"{name} = {where} has no free space around it: it is {why}"
        if region is None:
            return f"{name} = {where} has too little free space around it"
        self._add(region, 0.0)
        return trouble

    @property
    def _connected(self) -> bool:
        return not self.reason and self.graph.connect(self.start, self.goal)

    def _in_world(self, place: Point) -> list[float]:
        own = turned_points(place, undone(self.turn))
        return self.frame.place(own).round(9).tolist()

    def _cover(self) -> float:
        """Grow regions until the task is connected and enough is covered; the share covered.

        Where start or goal is no place for the load, nothing can connect them: the space is
        covered for who looks at it.
        """
        share = 0.0
        for round_ in range(_ROUNDS):
            samples = self._free_samples()
            if len(samples) == 0:
                break
            covered = self._covered(samples)
            share = covered.mean().item()
            done = bool(self.reason) or self._connected
            enough = share >= self.settings["coverage"] and done
            if enough or self._full or round_ == _ROUNDS - 1:
                return share  # of samples that no region was seeded at
            if round_ == 0:
                for target in self._targets(samples):
                    self._try_at(target, samples, covered)
            # While the task is not connected, every round looks into smaller corners.
            wanted = self.settings["coverage"]
            wanted = wanted if done else 1 - (1 - wanted) / 2**round_
            self._fill(samples, covered, wanted)
        return share

    def _fill(self, samples: Points, covered: np.ndarray, wanted: float) -> None:
        """Add regions until a share of the samples is covered; updates `covered`."""
        hopeless = np.zeros(len(samples), bool)
        while covered.mean() < wanted and not self._full:
            missing = np.flatnonzero(~covered & ~hopeless)
            if len(missing) == 0:
                return
            tried = self.random.choice(missing, min(CANDIDATES, len(missing)), replace=False)
            grown = [(self._grow(samples[i]), i) for i in tried]
            hopeless[[i for region, i in grown if region is None]] = True
            found = [region for region, _ in grown if region is not None]
            share = WORTH if self.bodies.many else np.inf
            for region in worth_keeping(found, samples, covered, share):
                self._add(region, covered.mean().item())
                if self._full:
                    return

    def _targets(self, samples: Points) -> Iterator[Point]:
        """Intermediate targets on the start–goal line, moved to the nearest free sample."""
        for share in np.linspace(0, 1, TARGETS + 2)[1:-1]:
            target = self.start + share * (self.goal - self.start)
            yield samples[((samples - target) ** 2).sum(axis=1).argmin()]

    def _try_at(self, seed: Point, samples: Points, covered: np.ndarray) -> None:
        if not self._full and not self.graph.holding(seed):
            region = self._grow(seed)
            if region is not None:
                covered |= region.polytope.excess(samples) <= 0
                self._add(region, covered.mean().item())

    def _grow(self, seed: Point) -> Region | None:
        return iris(self.bodies, self.domain, seed, solver=self.settings["solver"])

    def _add(self, region: Region, coverage: float) -> None:
        polytope = irredundant(region.polytope, region.ellipsoid.d)
        self.graph.add(Region(polytope, region.ellipsoid))
        if self.progress is not None:
            self.progress(Growth(len(self.graph.regions), coverage, self._connected))

    @property
    def _full(self) -> bool:
        return len(self.graph.regions) >= self.settings["limit"]

    def _free_samples(self) -> Points:
        drawn = self.random.uniform(self.corners[0], self.corners[1], (SAMPLES, 3))
        drawn = drawn[self.domain.excess(drawn) < 0]
        return drawn[~self.bodies.holding(drawn)]

    def _covered(self, samples: Points) -> np.ndarray:
        inside = np.zeros(len(samples), bool)
        for region in self.graph.regions:
            inside |= region.polytope.excess(samples) <= 0
        return inside

    def _disconnected(self, covered: float) -> str:
        parts = self.graph.parts
        return (
            f"no collision-free route found: start and goal stay in separate parts of the free "
            f"space ({len(parts)} regions in {len(set(parts.tolist()))} parts cover "
            f"{covered:.1%} of it, at most {self.settings['limit']} regions allowed)"
        )


_ROUNDS = 8
"""Draws of samples; each but the last is followed by further regions."""
