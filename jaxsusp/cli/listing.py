"""`jaxsusp scenarios` and `jaxsusp algorithms`."""

from jaxsusp.cli.application import Json, app, print_rows
from jaxsusp.optim.registry import ALGORITHMS, describe
from jaxsusp.scenario import load_scenario
from jaxsusp.scenario import scenarios as built_in


@app.command(epilog="Example: jaxsusp scenarios --json")
def scenarios(as_json: Json = False) -> None:
    """List the built-in scenarios."""
    found = [load_scenario(name) for name in built_in()]
    rows = [
        {
            "scenario": each.name,
            "robots": len(each.robots),
            "obstacles": len(each.obstacles),
            "start": list(each.task.start),
            "goal": list(each.task.goal),
        }
        for each in found
    ]
    print_rows(rows, as_json)


@app.command(epilog="Example: jaxsusp algorithms")
def algorithms(as_json: Json = False) -> None:
    """List the algorithms that --algorithms takes."""
    print_rows([{"algorithm": name, "what": describe(name)} for name in ALGORITHMS], as_json)
