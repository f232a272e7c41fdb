"""Studies that are bigger than memory: a file for every chunk, read when it is asked for."""

import hashlib
import json
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import dask.array as da
import numpy as np
import pytest
import xarray as xr
from small import SCENARIOS, SMALL, again, assert_same_numbers, contents, thrifty

import jaxsusp as js
from jaxsusp.comparison import chunks
from jaxsusp.comparison.choices import FILE, MANIFEST, PARTS
from jaxsusp.comparison.chunks import Estimate, cut, usual_size
from jaxsusp.comparison.dataset import VARIABLES, thinned
from jaxsusp.comparison.kept.study import Part, part_of
from jaxsusp.comparison.workunit import Unit

LONG = {**SMALL, "runs": 7, "chunk": 3}


@pytest.fixture
def short_is_long(monkeypatch):
    """More than five runs make a long study, which keeps four iterations of a history."""
    monkeypatch.setattr(chunks, "LONG", 5)
    monkeypatch.setattr(chunks, "CURVE", 4)
    monkeypatch.setattr("jaxsusp.comparison.kept.store.CURVE", 4)


@pytest.fixture
def measured(monkeypatch):
    """No time is measured, which would compile."""
    monkeypatch.setattr(chunks, "pace", lambda *_: 1e-3)


@pytest.fixture
def study(tmp_path, fake, short_is_long, measured):
    """A long study of two algorithms on two scenarios, in a folder."""
    js.compare(SCENARIOS, ("pso", "ga"), **LONG, output=tmp_path)
    fake.clear()
    return tmp_path


def loaded(ds):
    return ds.load().drop_attrs()


def test_it_has_the_numbers_of_one_file(study, fake):
    """But for iterations of histories that are not kept."""
    ds = js.load_results(study / MANIFEST)
    whole = js.compare(SCENARIOS, ("pso", "ga"), **{**LONG, "runs": 5, "chunk": 5})
    assert ds["iteration"].values.tolist() == thinned(6, 4) == [1, 3, 4, 6]
    expected = whole.sel(iteration=ds["iteration"])
    for name, variable in VARIABLES.items():
        if "run" in variable.dims:
            found = ds[name].isel(run=slice(5)).compute()
            np.testing.assert_array_equal(found.values, expected[name].values, err_msg=name)
    assert ds["history_best"].sizes["step"] == 6


def test_what_is_large_is_read_when_it_is_asked_for(study):
    ds = js.load_results(study / MANIFEST)
    lazy = {name for name in ds.data_vars if isinstance(ds[name].data, da.Array)}
    assert lazy == {"history", "x"}
    assert list(ds.data_vars) == list(VARIABLES)
    for name, variable in VARIABLES.items():
        assert ds[name].dims == variable.dims
        assert ds[name].dtype == variable.dtype
        assert ds[name].attrs["units"] == variable.units


def test_the_folder_holds_chunks_and_a_list_of_them(study):
    assert {path.name for path in study.iterdir()} == {MANIFEST, PARTS}
    manifest = json.loads((study / MANIFEST).read_text())
    assert manifest["complete"]
    runs = sorted(stretch for part in manifest["parts"] for stretch in part["runs"])
    assert runs == sorted([[0, 2], [3, 4], [5, 6]] * 2)
    assert {part["file"] for part in manifest["parts"]} == {
        p.name for p in (study / PARTS).iterdir()
    }


def test_further_runs_and_algorithms_join_it(study, fake):
    ds = js.compare(
        SCENARIOS, ("pso", "dbo"), **{**LONG, "runs": 9}, output=study, resume=True
    )  # fmt: skip
    assert fake == [("pso", [7, 8]), ("dbo", [0, 1, 2]), ("dbo", [3, 4, 5]), ("dbo", [6, 7, 8])]
    assert ds["algorithm"].values.tolist() == ["pso", "dbo", "ga"]
    counts = ds["fitness"].notnull().sum(("scenario", "run"))
    assert counts.values.tolist() == [18, 18, 14]
    assert ds["collisions"].sel(algorithm="ga", run=8).values.tolist() == [0, 0]
    assert np.isnan(ds["x"].sel(algorithm="ga", run=8)).all()


def test_a_shorter_comparison_becomes_part_of_it(tmp_path, fake, short_is_long, measured):
    few = {**SMALL, "runs": 4, "output": tmp_path}
    js.compare(SCENARIOS, ("pso",), **few)
    fake.clear()
    ds = js.compare(SCENARIOS, ("pso",), **{**LONG, "output": tmp_path}, resume=True)
    assert fake == [("pso", [4, 5, 6])]
    assert not (tmp_path / FILE).exists()
    assert ds["fitness"].notnull().all()
    fresh = js.compare(SCENARIOS, ("pso",), **LONG, output=tmp_path / "fresh")
    assert_same_numbers(loaded(ds), loaded(fresh))


def test_a_part_that_is_damaged_is_computed_again(study, fake):
    file = next((study / PARTS).glob("pso*"))
    before = js.load_results(study / MANIFEST).load()
    file.write_bytes(file.read_bytes()[:-100])
    with pytest.raises(js.InputError, match=r"bytes instead of.*computed again"):
        js.load_results(study / MANIFEST)
    ds = js.compare(SCENARIOS, ("pso", "ga"), **LONG, output=study, resume=True)
    assert [name for name, _ in fake] == ["pso"]
    assert_same_numbers(loaded(ds), loaded(before))


def zeros(content: bytes) -> bytes:
    return bytes(len(content))


def spoilt(content: bytes) -> bytes:
    """A few bytes in the middle are others: HDF5 reads it without a word."""
    middle = len(content) // 2
    return content[:middle] + b"\xff" * 40 + content[middle + 40 :]


@pytest.mark.parametrize("damage", [zeros, spoilt])
def test_a_part_of_the_right_length_but_with_other_content_is_computed_again(study, fake, damage):
    file = next((study / PARTS).glob("pso*"))
    before = js.load_results(study / MANIFEST).load()
    file.write_bytes(damage(file.read_bytes()))
    with pytest.raises(js.InputError, match=r"pso.*holds something else.*computed again"):
        js.load_results(study / MANIFEST)
    ds = js.compare(SCENARIOS, ("pso", "ga"), **LONG, output=study, resume=True)
    assert [name for name, _ in fake] == ["pso"]
    assert_same_numbers(loaded(ds), loaded(before))


def test_parts_of_earlier_studies_have_no_digest(study):
    before = loaded(js.load_results(study / MANIFEST))
    altered(study, lambda content: [part.pop("digest") for part in content["parts"]])
    assert_same_numbers(loaded(js.load_results(study / MANIFEST)), before)
    file = next((study / PARTS).glob("pso*"))
    file.write_bytes(zeros(file.read_bytes()))
    with pytest.raises(js.InputError, match=r"pso.*cannot be read"):
        js.load_results(study / MANIFEST)


def altered(study, change):
    content = json.loads((study / MANIFEST).read_text())
    change(content)
    (study / MANIFEST).write_text(json.dumps(content))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda content: content.update(attributes=[]), "attributes: Input should be"),
        (lambda content: content["attributes"].pop("settings"), "'settings'"),
        (lambda content: content["attributes"].update(scenario_files='"xx"'), "scenario_files"),
        (lambda content: content["parts"][0].update(runs=[[0, 5]]), r"holds 3 runs from 0 to 2"),
        (lambda content: content["parts"][0].update(runs=[[5000, 5002]]), "5000 to 5002 are list"),
        (lambda content: content["parts"][0].pop("runs"), r"parts\.0\.runs"),
    ],
)
def test_a_list_that_says_what_is_not_so_is_one_message(study, change, told):
    altered(study, change)
    with pytest.raises(js.InputError, match=told):
        js.load_results(study / MANIFEST)


def test_it_is_not_destroyed_by_a_command_that_forgot_to_resume(study, fake):
    before = contents(study)
    with pytest.raises(js.InputError, match=r"holds a long study \(compare.json\); give resume"):
        js.compare(SCENARIOS, ("pso",), **LONG, output=study)
    assert contents(study) == before
    assert not fake


def test_other_settings_are_not_resumed(study):
    with pytest.raises(js.InputError, match=r"compare.json: cannot be resumed.*seed \(0 and 1\)"):
        js.compare(SCENARIOS, ("pso",), **LONG, seed=1, output=study, resume=True)


@pytest.mark.parametrize("text", ["", "{", '{"layout": 2}', '{"layout": 1, "parts": 3}'])
def test_a_damaged_list_is_one_message(tmp_path, text):
    (tmp_path / MANIFEST).write_text(text)
    with pytest.raises(js.InputError, match=r"compare\.json: (cannot be read|is of layout 2)"):
        js.load_results(tmp_path / MANIFEST)


def test_what_it_takes_is_told_before(tmp_path, fake, short_is_long, measured):
    events = []
    js.compare(SCENARIOS, ("pso",), **LONG, output=tmp_path, progress=events.append)
    assert "7 runs in 3 chunks: about " in events[0].note
    assert "of memory and" in events[0].note


def test_what_the_disk_cannot_hold_is_not_begun(
    tmp_path, fake, short_is_long, measured, monkeypatch
):
    room = shutil._ntuple_diskusage(2**30, 2**30 - 1024, 1024)
    monkeypatch.setattr(shutil, "disk_usage", lambda place: room)
    with pytest.raises(js.InputError, match=r"needs \d+ KiB on disk and 1 KiB are free"):
        js.compare(SCENARIOS, ("pso",), **LONG, output=tmp_path / "new")
    assert not fake
    assert [*tmp_path.iterdir()] == []


def test_an_estimate_is_told_in_round_numbers():
    assert "7 seconds once compiled, 150 MiB of memory" in str(Estimate(7.0, 150 * 2**20, 1))
    assert str(Estimate(7200.0, 2**30, 3 * 2**20)) == (
        "about 2 hours once compiled, 1 GiB of memory and 3 MiB on disk"
    )


def test_chunks_are_equal_and_none_is_too_large():
    unit = Unit(None, None, 1, 1, None)
    pieces = cut(unit, [*range(5, 1006)], 250, is_long=True)
    assert [len(piece.runs) for piece in pieces] == [201, 200, 200, 200, 200]
    assert {piece.lanes for piece in pieces} == {201}
    assert sorted(run for piece in pieces for run in piece.runs) == [*range(5, 1006)]
    assert cut(unit, [], 250, is_long=False) == []
    assert [usual_size(runs) for runs in (1, 50_000, 100_000)] == [250, 250, 500]


def test_chunks_change_no_number(tmp_path):
    """Of a search that is really run: chunks of two, three and all runs."""
    settings = {**SMALL, "runs": 5, "search": "box"}
    whole = js.compare("scenario-1", ("pso",), **settings)
    for size in (2, 3):
        assert_same_numbers(js.compare("scenario-1", ("pso",), **settings, chunk=size), whole)


def test_nobody_else_writes_to_the_folder_meanwhile(tmp_path, fake):
    seen = []

    def second(event):
        if event.phase == "compiling":
            with pytest.raises(js.InputError, match=r"process \d+ on .* writes there; wait"):
                again(tmp_path)
            seen.append({path.name for path in tmp_path.iterdir()})

    js.compare("scenario-1", ("pso",), **SMALL, output=tmp_path, progress=second)
    assert seen == [{".lock"}]
    assert {path.name for path in tmp_path.iterdir()} == {FILE}


def test_a_full_disk_in_mid_study_loses_nothing(study, fake, monkeypatch):
    def full(path):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("jaxsusp._files.atomic_path", full)
    with pytest.raises(js.InputError, match=r"cannot be written .*No space left.*free space"):
        js.compare(SCENARIOS, ("dbo",), **LONG, output=study, resume=True)
    monkeypatch.undo()
    assert js.load_results(study / MANIFEST).sizes["algorithm"] == 2


KILLED = """
import sys
sys.path.append(sys.argv[2])
import jaxsusp as js
from jaxsusp.comparison import chunks
from small import SMALL, thrifty
import os, signal

chunks.LONG = 3
done = []

def told(event):
    if event.phase == "kept":
        done.append(event)
        if len(done) == 2:
            os.kill(os.getpid(), signal.SIGKILL)

js.compare("scenario-1", [thrifty()], **{**SMALL, "runs": 8}, chunk=2, output=sys.argv[1],
           progress=told)
"""


def test_what_is_killed_loses_the_chunk_in_progress_at_most(tmp_path, monkeypatch):
    here = str(Path(__file__).parent)
    killed = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path), here], check=False)
    assert killed.returncode == -signal.SIGKILL
    assert js.load_results(tmp_path / MANIFEST).sizes["run"] == 4
    monkeypatch.setattr(chunks, "LONG", 3)
    events = []
    settings = {**SMALL, "runs": 8, "chunk": 2, "output": tmp_path, "resume": True}
    ds = js.compare("scenario-1", [thrifty()], **settings, progress=events.append)
    assert [event.phase for event in events if event.phase in ("kept", "finished")] == [
        "kept", "finished",
    ]  # fmt: skip
    monkeypatch.undo()
    whole = js.compare("scenario-1", [thrifty()], **{**SMALL, "runs": 8})
    assert_same_numbers(loaded(ds), loaded(whole.sel(iteration=ds["iteration"])))


def test_stretches_of_runs_are_told_shortly(tmp_path):
    (tmp_path / "x.nc").write_text("abc")
    ds = xr.Dataset(coords={"scenario": ["s"], "algorithm": ["a"], "run": [0, 1, 2, 7, 9, 10]})
    part = part_of(ds, tmp_path / "x.nc")
    digest = hashlib.blake2b(b"abc").hexdigest()[:32]
    assert part == Part("x.nc", "a", ["s"], [(0, 2), (7, 7), (9, 10)], 3, digest)
