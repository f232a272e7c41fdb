"""What a page holds of what it is given, and what it says of the rest."""

import json

import numpy as np
import pytest

import jaxsusp as js


def content(path) -> dict:
    """What a page holds."""
    text = path.read_text().partition('<script type="application/json" id="data">')[2]
    return json.loads(text.partition("</script>")[0])


def test_runs_of_a_comparison(comparison, scenarios, tmp_path):
    """What a dataset does not hold is left out, and told."""
    ds = comparison.assign_attrs(scenario_files=json.dumps({"scenario-1": scenarios[0].to_toml()}))
    ds["position"].loc[{"algorithm": "ga"}] = np.nan
    page = tmp_path / "page.html"
    js.show(ds, path=page)
    held = content(page)
    names = [track["name"] for track in held["tracks"]]
    assert names == ["PSO, fitness 400.0", "DBO, fitness 200.0", "SDBO, fitness 100.0"]
    assert [track["verdict"] for track in held["tracks"]] == ["clear", "violates limits", "clear"]
    told = " ".join(held["notes"])
    assert "no run of GA is there" in told
    assert "scenario-5 is not shown: the dataset does not hold this scenario" in told
    js.show(ds.drop_vars("position"), path=page)
    held = content(page)
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
    page = tmp_path / "page.html"
    js.show(bare, path=page)
    assert content(page)["scenes"][0]["regions"] is None
    assert "`--regions` does" in content(page)["notes"][0]
    js.show(bare, path=page, regions=True)
    js.show(bare, path=page)
    held = content(page)
    assert held["scenes"][0]["regions"]["count"] >= 1
    assert held["notes"] == []
