"""Plans that workers make: those of one by one, and what is finished stays."""

import numpy as np
import pytest
from distributed import Client

import jaxsusp as js
from jaxsusp.planning.plan import ARRAYS

TAUT = {"algorithm": "taut", "simulate": False}


def test_workers_plan_the_same_and_an_interrupt_cancels_the_rest(daemons, tmp_path):
    broken = tmp_path / "broken.toml"
    broken.write_text("[payload]\nmass = -3\n", encoding="utf-8")
    alone = js.plan("scenario-1", **TAUT)
    daemons.start_worker()
    steps = []

    def interrupt(step):
        steps.append(step)
        if step.phase == "finished" and step.planned.plan is not None:
            raise KeyboardInterrupt

    names = ["scenario-1", broken, "scenario-3"]
    with pytest.raises(KeyboardInterrupt):
        js.plan_many(names, output=tmp_path, workers=daemons.file, progress=interrupt, **TAUT)
    with Client(daemons.address, set_as_default=False) as connected:
        assert connected.run_on_scheduler(lambda dask_scheduler: [*dask_scheduler.tasks]) == []
    steps = [step for step in steps if step.phase != "note"]
    assert steps[0].planned.failure.startswith(f"{broken}: ")
    (file,) = tmp_path.glob("*.plan.json")
    kept = js.load_plan(file)
    assert kept.scenario.name == steps[-1].name
    found = js.plan_many(
        names, output=tmp_path, resume=True, workers=daemons.file, **TAUT
    )  # fmt: skip
    assert [each.feasible for each in found] == [True, False, True], [e.reason for e in found]
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(found[0].plan, name), getattr(alone, name))
    assert found[0].plan.report == alone.report
