"""Which suspensions the package knows how to move: checks that need no search."""

from jaxsusp.errors import InputError
from jaxsusp.mechanics.drives import moving
from jaxsusp.scenario.models import Statement


def require_rule(scenario: Statement) -> None:
    """Refuse separate attachments where no rule says how moving ends hold the load level.

    Three ends that arms move can always (`mechanics.posture.levelling`). Bases that roll keep
    heights and lengths, which leaves too little; of more cables the lengths do not tell the
    tensions.
    """
    if scenario.payload.attachments == "hook" or not moving(scenario.drive):
        return
    if scenario.drive == "base":
        raise InputError(
            f'{scenario.name}: drive = "base" with separate payload.attachments: bases that roll '
            'cannot keep the load level; give drive = "end" or "hybrid", or attachments = "hook"'
        )
    if len(scenario.robots) > 3:
        raise InputError(
            f'{scenario.name}: drive = "{scenario.drive}" with {len(scenario.robots)} separate '
            "payload.attachments leaves open how tensions are shared; give three robots, "
            'drive = "cable", or attachments = "hook"'
        )
