"""Which suspensions the package knows how to move: checks that need no search."""

import numpy as np

from jaxsusp.errors import InputError
from jaxsusp.mechanics.drives import moving
from jaxsusp.mechanics.posture.rolling import upward_shares
from jaxsusp.scenario.models import Statement

ONE_HEIGHT = 1e-6
"""Heights of attachments, as a share of what separates them, that count as one."""


def require_rule(scenario: Statement) -> None:
    """Refuse separate attachments where no rule says how moving ends hold the load level.

    Three ends that arms move can always (`mechanics.posture.levelling`), three bases that roll
    where the load hangs below one height and inside its attachments (`mechanics.posture.rolling`).
    Of more cables nothing here says how the load is shared.
    """
    if scenario.payload.attachments == "hook" or not moving(scenario.drive):
        return
    if len(scenario.robots) > 3:
        raise InputError(
            f'{scenario.name}: drive = "{scenario.drive}" with {len(scenario.robots)} separate '
            "payload.attachments leaves open how tensions are shared: forces balance in "
            f"{3 * len(scenario.robots) - 6} independent ways, and ends that move may be anywhere "
            'in them; give three robots, drive = "cable", or attachments = "hook"'
        )
    if scenario.drive == "base":
        _require_rolling(scenario)


def _require_rolling(scenario: Statement) -> None:
    """Refuse what rolling bases cannot hold level, whatever they do."""
    rows = np.array(scenario.payload.attachments, np.float64)
    begun = f'{scenario.name}: drive = "base" with separate payload.attachments'
    remedy = 'or give drive = "end" or "hybrid", or attachments = "hook"'
    if np.ptp(rows[:, 2]) > ONE_HEIGHT * np.ptp(rows[:, :2]):
        heights = [round(float(z), 6) for z in rows[:, 2]]
        raise InputError(
            f"{begun} of heights {heights} m: pulls sideways at different heights tilt the load as "
            f"it rises and sinks; give all of them one height, {remedy}"
        )
    shares = np.asarray(upward_shares(rows, np.array(scenario.payload.center_of_mass)))
    if not shares.min() > 0:
        k = int(np.argmin(np.nan_to_num(shares, nan=-np.inf)))
        raise InputError(
            f"{begun}: the centre of mass is not inside the triangle of the attachments, so that "
            f"the cable of robots[{k}] would have to push; move payload.attachments[{k}], {remedy}"
        )
