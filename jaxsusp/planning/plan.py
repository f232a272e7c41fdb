"""A plan: everything it takes to carry out a task, with the checks it went through.

All of it follows from a scenario, the points of the path, the time law, the ends and the arms'
elbows, see `motion.along`. A plan holds the results as well, so that it can be used without this
package.
"""

import csv
import io
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from jaxsusp._files import write_text
from jaxsusp._showing import Shown
from jaxsusp._types import Array, Float
from jaxsusp.planning import document
from jaxsusp.planning.document import plain
from jaxsusp.scenario.ownunits import PLACE
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.suspension.cableloads import Loads
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.smoothpath import SmoothPath
from jaxsusp.trajectory.timelaw import Motion, TimeLaw
from jaxsusp.verify.certificate import Certificate
from jaxsusp.verify.constraints import Check

UNITS = {
    "waypoints": PLACE, "path": PLACE, "end_path": PLACE, "times": "s", "position": PLACE,
    "velocity": "m/s", "acceleration": "m/s²", "jerk": "m/s³", "lengths": "m", "tensions": "N",
    "angles": "rad", "ends": PLACE, "joints": "rad", "law_times": "s", "law_arc": "m",
    "law_speed": "m/s", "law_acceleration": "m/s²",
}  # fmt: skip
"""Units of the arrays of a plan."""

ARRAYS = {
    "waypoints": ("waypoints_m", ("waypoints", 3)),
    "path": ("path_m", ("points", 3)),
    "end_path": ("end_path_m", ("rows", "cables", 3)),
    "law_times": ("law_times_s", ("breaks",)),
    "law_arc": ("law_arc_m", ("breaks",)),
    "law_speed": ("law_speed_m_per_s", ("breaks",)),
    "law_acceleration": ("law_acceleration_m_per_s2", ("breaks",)),
    "times": ("times_s", ("samples",)),
    "position": ("position_m", ("samples", 3)),
    "velocity": ("velocity_m_per_s", ("samples", 3)),
    "acceleration": ("acceleration_m_per_s2", ("samples", 3)),
    "jerk": ("jerk_m_per_s3", ("samples", 3)),
    "lengths": ("lengths_m", ("samples", "cables")),
    "tensions": ("tensions_N", ("samples", "cables")),
    "angles": ("angles_rad", ("samples", 3)),
    "ends": ("ends_m", ("samples", "cables", 3)),  # without the samples where the ends stay
    "joints": ("joints_rad", ("samples", "cables", 3)),
}
"""Arrays of a plan: their names in the file and their shapes."""


@dataclass(frozen=True, eq=False)
class Plan(Shown):
    """A trajectory with all that belongs to it; host arrays, SI units, n samples, K cables.

    `feasible` means: the constraint report and the certificate found nothing wrong. Otherwise
    `reasons` says what.
    """

    scenario: Scenario
    feasible: bool
    reasons: tuple[str, ...]
    waypoints: Float[np.ndarray, "waypoints xyz"]
    path: Float[np.ndarray, "points xyz"]  # beside Makima's; the smooth path goes through them
    end_path: Float[np.ndarray, "rows cables xyz"]  # ends beside `path`; one row if they stay
    law_times: Float[np.ndarray, "breaks"]  # when the load is how far along the path, how fast, and
    law_arc: Float[np.ndarray, "breaks"]  # with which s̈, see `TimeLaw.passing`
    law_speed: Float[np.ndarray, "breaks"]
    law_acceleration: Float[np.ndarray, "breaks"]
    times: Float[np.ndarray, "samples"]
    position: Float[np.ndarray, "samples xyz"]
    velocity: Float[np.ndarray, "samples xyz"]
    acceleration: Float[np.ndarray, "samples xyz"]
    jerk: Float[np.ndarray, "samples xyz"]
    lengths: Float[np.ndarray, "samples cables"]
    tensions: Float[np.ndarray, "samples cables"]  # with inertia
    angles: Float[np.ndarray, "samples 3"]  # α1, α2, α3 of the load, rad: R = Rz(α3) Ry(α2) Rx(α1)
    ends: Float[np.ndarray, "*samples cables xyz"]  # (K, 3) where they stay, else (n, K, 3)
    joints: Float[np.ndarray, "samples cables joints"]
    report: tuple[Check, ...]
    certificate: Certificate
    settings: Mapping[str, Any] = field(default_factory=dict)  # how it was found; plain values

    def stated(self, scenario: Scenario) -> "Plan":
        """The plan of a task in own units as one of the scenario that states it."""
        if self.scenario is scenario:
            return self
        units = scenario.units
        arrays = {
            name: units.place(values) if unit == PLACE else units.number(values, unit)
            for name, unit in UNITS.items()
            for values in [getattr(self, name)]
        }
        return replace(
            self,
            scenario=scenario,
            report=tuple(each.stated(units) for each in self.report),
            certificate=self.certificate.stated(units),
            **arrays,
        )

    @cached_property
    def law(self) -> TimeLaw:
        """The motion at any time."""
        states = self.law_times, self.law_arc, self.law_speed, self.law_acceleration
        return TimeLaw.passing(SmoothPath(self.path), *states)

    @cached_property
    def rigging(self) -> Rigging:
        """Ends, arms and loads anywhere along the path."""
        return Rigging(self.scenario, self.law, self.end_path, self.joints[0, :, 2] >= 0)

    def at(self, times: Float[Array, "times"]) -> Motion:
        """Position, velocity, acceleration and jerk at any times (s)."""
        return self.law.at(np.asarray(times, np.float64))

    def ends_at(self, times: Float[Array, "times"]) -> Float[np.ndarray, "times cables xyz"]:
        """Upper cable ends at any times (s), m."""
        return self.rigging.ends_at(self.law.parameter(np.asarray(times, np.float64)))

    def loads_at(self, times: Float[Array, "times"]) -> Loads:
        """Lengths, tensions with inertia, and the load's posture at any times (s)."""
        return self.rigging.loads(np.asarray(times, np.float64))

    @property
    def clearance(self) -> float:
        """Least exact distance of load, cables and arms to obstacles (m)."""
        kinds = ("load to obstacles", "cables to obstacles", "arms to obstacles")
        return min(each.value for each in self.certificate.clearances if each.kind in kinds)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the plan as JSON, atomically; `jaxsusp.load_plan` reads it back exactly."""
        found = self.certificate
        content = {
            "feasible": self.feasible,
            "reasons": list(self.reasons),
            **{name: plain(getattr(self, field)) for field, (name, _) in ARRAYS.items()},
            "report": [plain(each._asdict()) for each in self.report],
            "certificate": {
                "proved": found.proved,
                "distances": found.distances,
                "clearances": [plain(each._asdict()) for each in found.clearances],
                "contacts": [plain(each._asdict()) for each in found.contacts],
            },
            "settings": plain(dict(self.settings)),
            "scenario_digest": self.scenario.digest,
            "scenario": self.scenario.to_toml(),
        }
        document.write(content, path)

    def save_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the samples as CSV, one row each, with the units in the column names."""
        buffer = io.StringIO()
        writer = csv.writer(buffer, lineterminator="\n")
        columns = self._columns()
        writer.writerow(columns)
        writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
        write_text(path, buffer.getvalue())

    def _columns(self) -> dict[str, np.ndarray]:
        """The samples by names that carry the units."""
        cables = range(1, self.lengths.shape[1] + 1)
        columns = {"time_s": self.times}
        kinematics = (("position", "m"), ("velocity", "m_per_s"), ("acceleration", "m_per_s2"),
                      ("jerk", "m_per_s3"))  # fmt: skip
        for quantity, unit in kinematics:
            values = getattr(self, quantity)
            columns |= {f"{axis}_{quantity}_{unit}": values[:, i] for i, axis in enumerate("xyz")}
        columns |= {f"alpha_{i + 1}_rad": self.angles[:, i] + 0.0 for i in range(3)}
        columns |= {f"length_{k}_m": self.lengths[:, k - 1] for k in cables}
        columns |= {f"tension_{k}_N": self.tensions[:, k - 1] for k in cables}
        ends = np.broadcast_to(self.ends, self.joints.shape)
        for k in cables:
            end = ends[:, k - 1]
            columns |= {f"end_{k}_{axis}_m": end[:, i] for i, axis in enumerate("xyz")}
            columns |= {f"joint_{k}_{i + 1}_rad": self.joints[:, k - 1, i] for i in range(3)}
        return columns
