"""A comparison that workers compute: the same numbers, whoever is lost on the way."""

import os
import signal
from pathlib import Path

import numpy as np
import pytest
from distributed import Client
from small import SMALL, assert_same_numbers, thrifty

import jaxsusp as js
from jaxsusp.cluster import client
from jaxsusp.cluster.choices import ClusterError, Place
from jaxsusp.comparison.choices import PARTS

STUDY = {**SMALL, "runs": 6, "chunk": 1}


@pytest.fixture(scope="module")
def undisturbed():
    """The study in this process, all runs at once."""
    return js.compare("scenario-1", [thrifty()], **{**STUDY, "chunk": None})


def at_the_first_chunk(act):
    """A progress callback that does something once, in mid-study."""
    told = []

    def progress(event):
        if event.phase == "kept" and not told:
            told.append(event)
            act()

    return progress


def test_a_worker_that_is_killed_changes_nothing(daemons, undisturbed, tmp_path):
    first, _ = daemons.start_worker(), daemons.start_worker()
    events = []

    def kill():
        os.kill(first.pid, signal.SIGKILL)
        first.wait()

    disturb = at_the_first_chunk(kill)
    with Client(daemons.address, set_as_default=False) as connected:
        connected.wait_for_workers(2)
        ds = js.compare(
            "scenario-1", [thrifty()], **STUDY, workers=connected, output=tmp_path,
            progress=lambda event: (events.append(event), disturb(event)),
        )  # fmt: skip
    assert first.returncode == -signal.SIGKILL
    assert_same_numbers(ds, undisturbed)
    phases = [event.phase for event in events if event.phase != "note"]
    assert phases == ["kept"] * 5 + ["finished"]
    assert events[-1].done == events[-1].total


def test_an_interrupt_keeps_what_is_finished_and_cancels_the_rest(daemons, undisturbed, tmp_path):
    def interrupt():
        raise KeyboardInterrupt

    daemons.start_worker()
    with pytest.raises(KeyboardInterrupt):
        js.compare(
            "scenario-1", [thrifty()], **STUDY, workers=daemons.file, output=tmp_path,
            progress=at_the_first_chunk(interrupt),
        )  # fmt: skip
    assert len([*(tmp_path / PARTS).iterdir()]) == 1
    with Client(daemons.address, set_as_default=False) as connected:
        assert connected.run_on_scheduler(lambda dask_scheduler: [*dask_scheduler.tasks]) == []
    again = js.compare("scenario-1", [thrifty()], **STUDY, output=tmp_path, resume=True)
    assert_same_numbers(again, undisturbed)


def test_a_scheduler_that_is_gone_is_one_message_and_loses_nothing(daemons, undisturbed, tmp_path):
    def kill():
        os.kill(daemons.processes[0].pid, signal.SIGKILL)

    daemons.start_worker()
    with pytest.raises(ClusterError, match="the scheduler is gone; what was finished is kept"):
        js.compare(
            "scenario-1", [thrifty()], **STUDY, workers=daemons.address, output=tmp_path,
            progress=at_the_first_chunk(kill),
        )  # fmt: skip
    assert [*(tmp_path / PARTS).iterdir()]
    again = js.compare("scenario-1", [thrifty()], **STUDY, output=tmp_path, resume=True)
    assert_same_numbers(again, undisturbed)


def test_workers_that_are_lost_for_good_are_waited_for_and_then_told(
    daemons, tmp_path, monkeypatch
):
    monkeypatch.setattr(client, "PATIENCE", 0.5)
    worker = daemons.start_worker()
    with pytest.raises(ClusterError, match="no worker has been there for 0 s; what was finished"):
        js.compare(
            "scenario-1", [thrifty()], **STUDY, workers=daemons.file, output=tmp_path,
            progress=at_the_first_chunk(worker.kill),
        )  # fmt: skip
    assert [*(tmp_path / PARTS).iterdir()]


OLD = """
import importlib.metadata as metadata
really = metadata.version
metadata.version = lambda name: "0.0.1" if name == "jaxsusp" else really(name)
"""


def test_a_worker_of_another_version_is_refused_by_name(daemons, undisturbed, tmp_path):
    (tmp_path / "sitecustomize.py").write_text(OLD)
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    notes = []

    def note(event):
        if event.phase == "note":
            notes.append(event.note)

    old = daemons.start_worker(PYTHONPATH=path)
    with Client(daemons.address, set_as_default=False) as connected:
        connected.wait_for_workers(1)
        (address,) = connected.scheduler_info()["workers"]
        with pytest.raises(
            ClusterError, match=r"none of them can be used.*jaxsusp 0\.0\.1 instead"
        ):
            js.compare("scenario-1", [thrifty()], **STUDY, workers=connected)
        daemons.start_worker()
        connected.wait_for_workers(2)
        ds = js.compare("scenario-1", [thrifty()], **STUDY, workers=connected, progress=note)
    assert_same_numbers(ds, undisturbed)
    told, at_work = notes
    assert at_work.startswith("1 worker does the work")
    assert address in told
    assert "jaxsusp 0.0.1 instead of" in told
    assert old.poll() is None, "it was not ours to end"


def test_an_algorithm_of_ones_own_module_is_told(daemons):
    daemons.start_worker(PYTHONPATH=os.getcwd())
    with pytest.raises(ClusterError, match=r"cannot be loaded there: No module named 'small'"):
        js.compare("scenario-1", [thrifty()], **STUDY, workers=daemons.file)


def test_processes_of_this_machine_find_the_same(undisturbed, monkeypatch):
    here = str(Path(__file__).parents[1] / "comparison")  # of `thrifty`, which workers must have
    path = os.pathsep.join([here, os.environ.get("PYTHONPATH", "")])
    monkeypatch.setenv("PYTHONPATH", path)
    ds = js.compare("scenario-1", [thrifty()], **STUDY, workers=1)
    assert_same_numbers(ds, undisturbed)
    assert np.isfinite(ds["fitness"]).all()


def test_a_connection_with_certificates_finds_the_same_and_another_one_none(
    guarded, certify, undisturbed, monkeypatch
):
    daemons, ours = guarded
    assert daemons.address.startswith("tls://")
    daemons.start_worker()
    place = Place(daemons.address, None, ours.cert, ours.cert, ours.key)
    ds = js.compare("scenario-1", [thrifty()], **STUDY, workers=place)
    assert_same_numbers(ds, undisturbed)
    stranger = certify("stranger")
    monkeypatch.setattr(client, "ANSWER", 3.0)
    for wrong in (
        Place(daemons.address),
        Place(daemons.address, None, stranger.cert, stranger.cert, stranger.key),
        Place(daemons.address, None, ours.cert, stranger.cert, stranger.key),
    ):
        with pytest.raises(ClusterError, match="no Dask scheduler answers there") as refused:
            js.compare("scenario-1", [thrifty()], **STUDY, workers=wrong)
        assert "\n" not in str(refused.value)


def test_time_is_measured_by_who_computes(daemons):
    daemons.start_worker()
    settings = {**STUDY, "runs": 2, "budget": "time"}
    ds = js.compare("scenario-1", [thrifty()], **settings, workers=daemons.file)
    assert ds["iterations"].values.tolist() == [6]
