"""Every checkable claim of the paper: what its own tables say, what our runs show, what follows."""

from collections import Counter
from collections.abc import Sequence

import pandas as pd

from experiments.artefacts import Artefacts
from experiments.claims import convergence, ends, motion, superiority, tables
from experiments.claims.claim import VERDICTS, Claim, Evidence
from experiments.contents import Page

TITLE = "The paper's claims"
PRINTED = ""
DIFFERS = (
    "Which of the paper's statements do its own tables bear out, and which do our runs? Checked "
    "are those of abstract, tables, captions, conclusions and the text of Sect. 4."
)
MADE = ()
READ = ("comparison", "cable-check", "ablation_random")
MINUTES = 0.0


def claims(artefacts: Artefacts) -> list[Claim]:
    """All of them, in the paper's order."""
    evidence = Evidence.of(artefacts)
    parts = (
        tables.claims, motion.claims, convergence.claims, superiority.effect, ends.claims,
        motion.discussion, superiority.conclusions,
    )  # fmt: skip
    return [claim for part in parts for claim in part(evidence)]


def draw(artefacts: Artefacts) -> Page:
    """The ledger, and how many claims there are of each verdict."""
    found = claims(artefacts)
    return Page({}, {"claims": ledger(found)}, findings(found), body(found))


def ledger(found: Sequence[Claim]) -> pd.DataFrame:
    """One row per claim."""
    frame = pd.DataFrame(
        {
            "claim": [f"{claim.claimed} ({claim.where})" for claim in found],
            "verdict": [claim.verdict for claim in found],
            "the printed tables": [claim.printed_says for claim in found],
            "our runs": [claim.ours_say for claim in found],
            "command": [f"`{claim.command}`" for claim in found],
        }
    )
    frame.attrs["title"] = "Claims and verdicts"
    frame.attrs["caption"] = (
        "Our runs: 20 of every algorithm on six scenarios of our own, since the paper prints no "
        "obstacles. Numbers differ for that reason alone, so claims about ranks and directions are "
        "held against them, and a saving holds where ours is half as large. What is said of the "
        "best holds where it does in more than half of the scenarios."
    )
    return frame


def body(found: Sequence[Claim]) -> str:
    """The ledger as people read it: a short table, then the evidence for every claim."""
    rows = [
        f"| [{number}](#claim-{number}) | {claim.claimed} | {claim.verdict} |"
        for number, claim in enumerate(found, 1)
    ]
    parts = [
        "\n".join(["| | claim | verdict |", "| ---: | :--- | :--- |", *rows]),
        ledger(found).attrs["caption"],
    ]
    parts += [
        f"(claim-{number})=\n## {number}. {claim.claimed}\n\n*{claim.where}.* "
        f"**Verdict: {claim.verdict}.**\n\nThe print: {claim.printed_says}\n\n"
        f"Our runs: {claim.ours_say}\n\n`{claim.command}`"
        for number, claim in enumerate(found, 1)
    ]
    return "\n\n".join(parts)


def findings(found: Sequence[Claim]) -> str:
    """How the claims fare, in a paragraph."""
    count = Counter(claim.verdict for claim in found)
    told = "; ".join(f"{verdict}: {count[verdict]}" for verdict in VERDICTS if count[verdict])
    refuted = sum(claim.printed is False for claim in found)
    ours = [claim.ours for claim in found if claim.ours is not None]
    return (
        f"{len(found)} claims. The paper's own text and tables contradict {refuted} of them; our "
        f"runs bear out {sum(ours)} of the {len(ours)} that they can say something about. By "
        f"verdict: {told}."
    )
