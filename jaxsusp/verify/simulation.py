"""A plan played in simulation: winches and arms move, the load swings, cables only pull."""

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from jaxsusp._files import write_text
from jaxsusp._types import Float
from jaxsusp.errors import InputError
from jaxsusp.scenario.models import Limits
from jaxsusp.scenario.ownunits import UNCHANGED, Frame
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify import armmodel
from jaxsusp.verify.armmodel import servo_positions
from jaxsusp.verify.constraints import INSTANTS
from jaxsusp.verify.engine import mujoco
from jaxsusp.verify.model import Cables, build_spec

SETTLING = 3.0
"""s for which the first lengths are held before the plan begins, so that the load hangs still."""

EDGE = 5.0
"""s after the start and before the end that are left out of the errors (an eighth of a short
plan)."""

TRACKING = 0.01
"""m by which a simulated load may be off the plan."""

TENSION = 0.02
"""Share of the planned tension by which a simulated one may be off."""

_EVERY = 10  # steps between records


@dataclass(frozen=True, eq=False)
class Simulation:
    """What was seen, at n instants; host arrays."""

    times: Float[np.ndarray, "times"]  # s
    position: Float[np.ndarray, "times xyz"]  # of the load's centre, m
    tilt: Float[np.ndarray, "times"]  # of the load's axis, degrees
    tensions: Float[np.ndarray, "times cables"]  # N
    planned_position: Float[np.ndarray, "times xyz"]
    planned_tensions: Float[np.ndarray, "times cables"]
    contacts: tuple[tuple[float, str], ...]  # first time (s) of every body the load touched
    units: Frame = UNCHANGED  # how numbers in the task's own units become these

    def stated(self, units: Frame) -> "Simulation":
        """The same, of a system in own units, with numbers as its units make them."""
        return replace(
            self,
            times=units.number(self.times, "s"),
            position=units.place(self.position),
            tensions=units.number(self.tensions, "N"),
            planned_position=units.place(self.planned_position),
            planned_tensions=units.number(self.planned_tensions, "N"),
            contacts=tuple((units.number(time, "s"), name) for time, name in self.contacts),
            units=units,
        )

    @property
    def _inner(self) -> np.ndarray:
        """Instants that count for the errors."""
        end = float(self.times[-1])
        edge = min(self.units.number(EDGE, "s"), end / 8)
        return (self.times >= edge) & (self.times <= end - edge)

    @property
    def tracking_error(self) -> float:
        """Greatest distance from the planned position (m)."""
        off = np.linalg.norm(self.position - self.planned_position, axis=1)
        return float(off[self._inner].max())

    @property
    def tension_error(self) -> float:
        """Greatest relative difference from the planned tensions."""
        off = np.abs(self.tensions / self.planned_tensions - 1)
        return float(off[self._inner].max())

    @property
    def swing(self) -> float:
        """Greatest tilt (degrees)."""
        return float(self.tilt.max())

    @property
    def peak_tension(self) -> float:
        """Greatest tension of any cable (N)."""
        return float(self.tensions.max())

    def problems(self, limits: Limits, say: Frame = UNCHANGED) -> list[str]:
        """What speaks against the plan, in sentences.

        Args:
            limits: those of the scenario.
            say: how its numbers become SI units, for the words.
        """
        tracking = self.units.number(TRACKING, "m")
        ultimate = limits.safety_factor * limits.tension[1]
        found = [
            f"simulated load touches {name} at {say.number(time, 's'):.2f} s"
            for time, name in self.contacts
        ]
        checks = (
            (self.tracking_error, tracking, "m", "simulated load is off the plan by"),
            (100 * self.tension_error, 100 * TENSION, "%", "simulated tensions differ by"),
            (self.swing, limits.posture_deg, "°", "simulated load tilts by"),
            (self.peak_tension, ultimate, "N", "simulated tension reaches"),
        )
        for value, most, unit, text in checks:
            if not value <= most:
                value, most = say.number(np.array([value, most]), unit)
                found.append(f"{text} {value:.4g} {unit}, allowed are {most:.4g} {unit}")
        return found


LONGEST = 10_000_000
"""Steps of a simulation: hours, and hundreds of megabytes."""


def require_playable(scenario: Scenario, duration: float) -> None:
    """Refuse a motion that is too long to be played.

    Args:
        scenario: in own units.
        duration: in its unit of time.

    Raises:
        InputError: with what could be played.
    """
    longest = LONGEST * Cables.of(scenario).timestep
    if duration > longest:
        given, most = (scenario.frame.number(each, "s") for each in (duration, longest))
        raise InputError(
            f"duration = {given:g} s: takes too many steps to be played in simulation; give at "
            f"most {most:.0f} s, or simulate = False (--no-simulate)"
        )


def simulate(rigging: Rigging, seen: Callable[[Any, Any, float], None] | None = None) -> Simulation:
    """Play the cable lengths of a plan, and its arms and bases where they move.

    Args:
        rigging: the system along its path.
        seen: called with MuJoCo's model and data, in the task's own units, and the time (s) at
            every record.

    Returns:
        A `Simulation`. It runs in the task's own units, so that size and place do not matter.

    Raises:
        InputError: it would take more than `LONGEST` steps.
    """
    units, rigging = rigging.scenario.units, rigging.own
    require_playable(rigging.scenario, rigging.law.duration)
    model = build_spec(rigging).compile()
    data = mujoco.MjData(model)
    step, duration = model.opt.timestep, rigging.law.duration
    steps = round(duration / step)
    times = np.minimum(np.arange(steps + 1) * step, duration)
    times[-1] = duration
    controls = commands(rigging, times)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.ctrl[:] = controls[0]
    mujoco.mj_step(model, data, round(SETTLING / step))

    load = model.geom("load").id
    records, contacts = [], {}
    cables = rigging.cables
    centre, attitude, pull = data.body("load").xpos, data.body("load").xmat, data.actuator_force
    for i in range(steps + 1):
        data.ctrl[:] = controls[i]
        mujoco.mj_step(model, data)  # its results are those of the instant before the step
        if i % _EVERY == 0 or i == steps:
            records.append((i, *centre, attitude[8], *-pull[:cables]))
            if seen:
                seen(model, data, units.number(times[i], "s"))
        if data.ncon:
            _note_contacts(model, data, load, i * step, contacts)
    table = np.array(records)
    when = times[table[:, 0].astype(int)]
    return Simulation(
        when,
        table[:, 1:4],
        np.rad2deg(np.arccos(np.clip(table[:, 4], -1, 1))),
        table[:, 5 : 5 + cables],
        rigging.law.at(when).position,
        rigging.loads(when).tensions,
        tuple((time, name) for name, time in contacts.items()),
    ).stated(units)


def export_model(rigging: Rigging, path: str | os.PathLike[str]) -> None:
    """Write the MJCF of a plan, in SI units; the controls are those of `commands`."""
    spec = build_spec(rigging)
    spec.compile()
    write_text(path, spec.to_xml())


def commands(
    rigging: Rigging, times: Float[np.ndarray, "times"]
) -> Float[np.ndarray, "times controls"]:
    """Controls of the model: unstretched cable lengths (m), then servo positions (m, rad).

    A cable is commanded shorter than planned by what its tension stretches it, which is what
    decides the tensions where there are more cables than balance needs. Actuators damp the rate
    of what they drive; with a lead of damping/stiffness times the planned rate they damp the
    departure from the plan alone.
    """
    nodes, units = np.linspace(0, rigging.law.duration, INSTANTS), rigging.scenario.units
    loads, cables = rigging.loads(nodes), Cables.of(rigging.scenario)
    winches = CubicSpline(nodes, loads.lengths - loads.tensions / cables.stiffness)
    servos = CubicSpline(nodes, servo_positions(rigging, rigging.law.parameter(nodes)))
    found = [
        course(times) + lead * course(times, 1)
        for course, lead in (
            (winches, cables.damping / cables.stiffness),
            (servos, units.number(armmodel.DAMPING / armmodel.GAIN, "s")),
        )
        if course.c.size
    ]
    return np.concatenate(found, axis=1)


def _note_contacts(model, data, load: int, time: float, contacts: dict[str, float]) -> None:
    for pair in data.contact.geom:
        if load in pair:
            other = int(pair[0] if pair[1] == load else pair[1])
            contacts.setdefault(model.geom(other).name, time)
