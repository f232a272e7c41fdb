"""The whole report of a plan: every limit, proved at every instant where that can be done."""

from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.certificate import Certificate
from jaxsusp.verify.constraints import Check, sampled_report, with_proofs
from jaxsusp.verify.motionlimits import motion_limits


def constraint_report(rigging: Rigging, certificate: Certificate) -> tuple[Check, ...]:
    """All of Eq. 22, and the limits of motion that the scenario states.

    Args:
        rigging: the system along its path.
        certificate: distances.
    """
    sampled = (*sampled_report(rigging, certificate), *motion_limits(rigging))
    return with_proofs(rigging, sampled)
