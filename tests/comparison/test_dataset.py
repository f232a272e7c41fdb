"""The dataset of a comparison: put together, saved, loaded, appended."""

import json
import warnings

import h5py
import numpy as np
import pytest
import xarray as xr

import jaxsusp as js
from jaxsusp.comparison import dataset as results
from jaxsusp.comparison.dataset import (
    OF_THE_BEST_RUN,
    SUMMED,
    VARIABLES,
    append_results,
    assemble,
    merge,
)
from jaxsusp.comparison.kept.files import load_results, save_results

SETTINGS = {"seed": 0, "iterations": 3, "polish": False, "scenarios": {"s": "digest"}}


def made(algorithm="pso", runs=(0, 1), iterations=3, scenario="s", fitness=None, **settings):
    """A dataset of one algorithm on one scenario; every number depends on its labels."""
    coords = {
        "scenario": [scenario],
        "algorithm": [algorithm],
        "run": list(runs),
        "iteration": range(1, iterations + 1),
        "step": range(1, iterations + 1),
        "variable": range(2),
        "sample": range(4),
    }
    sizes = {**{dim: len(labels) for dim, labels in coords.items()}, "term": 6, "axis": 3}
    numbers = 10.0 * len(algorithm) + np.asarray(runs)  # 30, 31, … for pso
    found = numbers if fitness is None else np.asarray(fitness)
    values = {}
    for name, variable in VARIABLES.items():
        shape = [sizes[dim] for dim in variable.dims]
        if "run" in variable.dims:
            label = numbers.reshape(-1, *[1] * (len(shape) - 3))
        elif name in OF_THE_BEST_RUN:
            label = numbers[np.nanargmin(found)]
        elif name in SUMMED:
            label = numbers[0]
        else:
            label = 10 * len(algorithm) if "algorithm" in variable.dims else 7
        values[name] = np.broadcast_to(label, shape)
    if fitness is not None:
        values["fitness"] = np.reshape(np.asarray(fitness, float), (1, 1, -1))
    attributes = {
        "settings": json.dumps({**SETTINGS, **settings}),
        "coefficients": json.dumps({algorithm: [0.5]}),
        "seed": 0,
        "scenario_files": "{}",
        **results.provenance(),
    }
    return assemble(coords, values).assign_attrs(attributes)


def test_a_saved_dataset_comes_back_exactly(tmp_path):
    ds = made()
    save_results(ds, tmp_path / "new folder" / "compare.nc")
    back = load_results(tmp_path / "new folder" / "compare.nc")
    xr.testing.assert_identical(back, ds)
    for name in ds.variables:
        assert back[name].dtype == ds[name].dtype
    assert back.attrs == ds.attrs
    assert [path.name for path in (tmp_path / "new folder").iterdir()] == ["compare.nc"]


def test_nan_and_infinity_survive(tmp_path):
    ds = made(fitness=[np.inf, np.nan])
    save_results(ds, tmp_path / "odd.nc")
    xr.testing.assert_identical(load_results(tmp_path / "odd.nc"), ds)


@pytest.mark.fast
def test_units_come_together_with_gaps_where_nothing_ran():
    short, long = made("pso", (0, 1), iterations=2), made("sdbo", (2,), iterations=4)
    ds = merge([short, long])
    assert ds["run"].values.tolist() == [0, 1, 2]
    assert ds["iteration"].values.tolist() == [1, 2, 3, 4]
    assert ds["fitness"].notnull().values.tolist() == [[[True, True, False], [False, False, True]]]
    assert ds["history"].sel(algorithm="pso", run=0).notnull().values.tolist() == [[1, 1, 0, 0]]
    assert (ds["collisions"].sel(algorithm="pso", run=2) == 0).all()
    for unit in (short, long):
        labels = {dim: unit[dim] for dim in ("scenario", "algorithm", "run", "iteration", "step")}
        xr.testing.assert_equal(ds.sel(labels), unit)
    for name, variable in VARIABLES.items():
        assert ds[name].dtype == variable.dtype


def test_gaps_are_filled_by_a_later_dataset():
    whole = [made("pso", (0,)), made("pso", (1,)), made("ga", (0,)), made("ga", (1,))]
    ragged, rest = merge([whole[0], whole[3]]), merge([whole[2], whole[1]])
    expected = merge(whole)
    for one, two in ((ragged, rest), (rest, ragged)):
        xr.testing.assert_equal(merge([one, two]).sel(algorithm=["pso", "ga"]), expected)


@pytest.mark.fast
@pytest.mark.parametrize("order", [1, -1])
def test_the_trajectory_is_the_best_runs(order):
    better, worse = made(runs=(5,), fitness=[1.0]), made(runs=(3, 4), fitness=[np.inf, 2.0])
    ds = merge([better, worse][::order])
    assert (ds["position"] == 35.0).all()
    assert (ds["curvature_radius"] == 35.0).all()


@pytest.mark.fast
def test_runs_that_found_nothing_still_have_a_trajectory():
    ds = merge([made(runs=(0,), fitness=[np.inf]), made(runs=(1,), fitness=[np.inf])])
    assert (ds["position"] == 30.0).all()


def test_times_add_up_and_counts_do_not():
    ds = append_results(made(runs=(0, 1)), made(runs=(2, 3)))
    assert ds["seconds_run"].values.tolist() == [30.0 + 32.0]
    assert ds["evaluations"].values.tolist() == [[30]]
    assert ds["fitness"].values.tolist() == [[[30.0, 31.0, 32.0, 33.0]]]


@pytest.mark.fast
def test_appending_another_algorithm_keeps_the_coefficients_of_both():
    ds = append_results(made("pso"), made("ga"))
    assert json.loads(ds.attrs["coefficients"]) == {"pso": [0.5], "ga": [0.5]}


@pytest.mark.fast
def test_appending_a_run_twice_is_refused():
    with pytest.raises(js.InputError, match=r"run = \[1\] of pso is there twice"):
        append_results(made(runs=(0, 1)), made(runs=(1, 2)))


@pytest.mark.fast
def test_appending_other_settings_is_refused():
    with pytest.raises(js.InputError, match=r"differ in seed \(0 and 1\); append only equal"):
        append_results(made(), made(runs=(2,), seed=1))


@pytest.mark.fast
@pytest.mark.parametrize("order", [1, -1])
def test_the_lowest_value_known_holds(order):
    def knowing(value, *runs):
        return made(runs=runs).assign(best_known=("scenario", [value]))

    assert merge([knowing(7.0, 0), knowing(6.0, 1)][::order])["best_known"] == 6.0
    assert merge([knowing(7.0, 0), knowing(np.nan, 1)][::order])["best_known"] == 7.0
    assert merge([knowing(np.nan, 0), knowing(np.nan, 1)][::order])["best_known"].isnull().all()


def test_what_came_later_is_added_to_a_file_without_it(tmp_path):
    one = made(runs=(0,), iterations=6, waypoints=5, samples=40)
    settings = json.loads(one.attrs["settings"])
    settings["scenarios"]["s"] = js.load_scenario("scenario-1").digest
    one = one.assign_attrs(settings=json.dumps(settings))
    one = one.assign(evaluations=0 * one["evaluations"] + 4 + 6 * 20)
    one.drop_vars(["best_known", "evaluations_initial"]).to_netcdf(
        tmp_path / "old.nc", engine="h5netcdf"
    )
    ds = load_results(tmp_path / "old.nc")
    assert ds["best_known"] == js.best_known("scenario-1")
    assert ds["evaluations_initial"] == 4
    more = made(runs=(1,), iterations=6).assign_attrs(ds.attrs)
    assert append_results(ds, more).sizes["run"] == 2


# Files that are no comparison


def write_text(path):
    path.write_text("scenario,fitness\n")


def write_nothing(path):
    path.touch()


def write_part(path):
    save_results(made(), path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def write_damaged(path):
    save_results(made(), path)
    data = bytearray(path.read_bytes())
    data[500:9000] = bytes(8500)
    path.write_bytes(data)


def write_other_hdf5(path):
    with h5py.File(path, "w") as file:
        file["numbers"] = np.zeros((2, 3))


def write_other_netcdf(path):
    xr.Dataset({"fitness": ("time", [1.0])}).to_netcdf(path, engine="h5netcdf")


def write_one_scenario_cut_out(path):
    made().isel(scenario=0).to_netcdf(path, engine="h5netcdf")


def write_without_labels(path):
    made().drop_vars("algorithm").to_netcdf(path, engine="h5netcdf")


def write_broken_attribute(path):
    made().assign_attrs(settings="{").to_netcdf(path, engine="h5netcdf")


def write_folder(path):
    path.mkdir()


@pytest.mark.parametrize(
    ("write", "message"),
    [
        (lambda path: None, "no such file"),
        (write_folder, "no such file"),
        (write_nothing, "cannot be read as NetCDF-4"),
        (write_text, "cannot be read as NetCDF-4"),
        (write_part, "truncated file"),
        (write_damaged, "cannot be read as NetCDF-4"),
        (write_other_hdf5, "it has no fitness with dimensions scenario, algorithm, run"),
        (write_other_netcdf, "it has no fitness"),
        (write_one_scenario_cut_out, "it has no fitness"),
        (write_without_labels, "algorithm has no labels"),
        (write_broken_attribute, "attribute settings is missing or broken"),
    ],
)
def test_loading_anything_else_is_one_message(tmp_path, write, message):
    path = tmp_path / "compare.nc"
    write(path)
    with pytest.raises(js.InputError) as caught:
        load_results(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "give a file that `jaxsusp compare` wrote" in str(caught.value)


def test_a_full_disk_is_one_message_and_keeps_the_old_file(tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    path = tmp_path / "compare.nc"
    save_results(made(), path)
    before = path.read_bytes()
    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    with pytest.raises(js.InputError, match=r"compare.nc: cannot be written \(No space left"):
        save_results(made(runs=(7,)), path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_loading_warns_of_nothing(tmp_path):
    save_results(made(), tmp_path / "compare.nc")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load_results(tmp_path / "compare.nc")
