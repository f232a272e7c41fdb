"""What a page holds of what it is given, and what it says of the rest."""

import json

import numpy as np
import pytest
import xarray as xr

import jaxsusp as js
from jaxsusp.report.browser import page
from jaxsusp.report.browser.gather import gathered
from jaxsusp.report.browser.scenes import same_task


def content(path) -> dict:
    """What a page holds."""
    text = path.read_text().partition('<script type="application/json" id="data">')[2]
    return json.loads(text.partition("</script>")[0])


def test_runs_of_a_comparison(comparison, scenarios, tmp_path):
    """What a dataset does not hold is left out, and told."""
    ds = comparison.assign_attrs(scenario_files=json.dumps({"scenario-1": scenarios[0].to_toml()}))
    ds["position"].loc[{"algorithm": "ga"}] = np.nan
    file = tmp_path / "page.html"
    js.show(ds, path=file)
    held = content(file)
    names = [track["name"] for track in held["tracks"]]
    assert names == ["PSO, fitness 400.0", "DBO, fitness 200.0", "SDBO, fitness 100.0"]
    assert [track["verdict"] for track in held["tracks"]] == ["clear", "violates limits", "clear"]
    told = " ".join(held["notes"])
    assert "no run of GA is there" in told
    assert "scenario-5 is not shown: the dataset does not hold this scenario" in told
    js.show(ds.drop_vars("position"), path=file)
    held = content(file)
    assert "the dataset has no position" in " ".join(held["notes"])
    assert [track["name"] for track in held["tracks"]] == ["at the start", "at the goal"]
    with pytest.raises(js.InputError, match="does not hold this scenario"):
        js.show(comparison)


def test_nothing_at_all():
    with pytest.raises(js.InputError, match="nothing to show"):
        js.show()


def test_regions_are_shown_when_they_are_known(scenarios, tmp_path, monkeypatch):
    """They are looked up, and computed only where that is asked for."""
    monkeypatch.setenv("JAXSUSP_CACHE", str(tmp_path))
    bare = scenarios[0].model_copy(update={"obstacles": ()})
    file = tmp_path / "page.html"
    js.show(bare, path=file)
    assert content(file)["scenes"][0]["regions"] is None
    assert "`--regions` does" in content(file)["notes"][0]
    js.show(bare, path=file, regions=True)
    js.show(bare, path=file)
    held = content(file)
    assert held["scenes"][0]["regions"]["count"] >= 1
    assert held["notes"] == []


def test_a_free_space_of_another_task_stands_alone(scenarios):
    """The names of what it avoids are the same; where that is, is not."""
    scenario = scenarios[0]
    space = js.free_space(scenario)
    *kept, last = scenario.obstacles
    x, y, z = last.center
    moved = last.model_copy(update={"center": (x + 0.1, y, z)})
    other = scenario.model_copy(update={"obstacles": (*kept, moved)})
    assert same_task(space, scenario)
    assert not same_task(space, other)
    assert len(gathered([scenario, space])["scenes"]) == 1
    assert len(gathered([other, space])["scenes"]) == 2


def test_a_page_that_would_be_too_large_leaves_shadows_out(scenarios, monkeypatch):
    whole = len(js.show(scenarios[0]).text)
    monkeypatch.setattr(page, "LARGEST", (whole - 1000) / 1e6)
    less = js.show(scenarios[0]).text
    assert len(less) < whole - 1000
    assert "No shadows of cables: the page would have" in less


def test_a_free_space_without_numbers_is_refused_by_its_name(scenarios, tmp_path):
    path = tmp_path / "space.nc"
    js.free_space(scenarios[0]).save(path)
    ds = xr.load_dataset(path)
    ds["d"][:] = np.nan
    ds.to_netcdf(path)
    with pytest.raises(js.InputError, match=r"space\.nc.*d has numbers that are not finite"):
        js.show(path)
