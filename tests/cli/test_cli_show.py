"""`jaxsusp show` as a person or a script meets it; what it writes is opened in report/browser."""

import json

import pytest
from plans import LOW

import jaxsusp as js


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    """A plan's file."""
    path = tmp_path_factory.mktemp("plan") / "one.plan.json"
    js.plan_through("scenario-1", LOW).save(path)
    return path


def content(path) -> dict:
    """What a page holds."""
    text = path.read_text().partition('<script type="application/json" id="data">')[2]
    return json.loads(text.partition("</script>")[0])


def test_a_page_with_plans_side_by_side(run, plan, tmp_path):
    page = tmp_path / "page.html"
    status, out, err = run("show", plan, plan, "--output", page)
    assert (status, out) == (0, "")
    assert f"wrote {page}" in err
    assert page.stat().st_size < 6e6
    held = content(page)
    assert [scene["name"] for scene in held["scenes"]] == ["scenario-1"]
    assert [track["name"] for track in held["tracks"]] == ["one", "one (2)"]
    assert held["tracks"][0]["limits"][0]["ok"]


def test_open_opens_it(run, plan, tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    page = tmp_path / "page.html"
    assert run("show", plan, "--open", "--output", page)[0] == 0
    assert opened == [page.as_uri()]


@pytest.mark.parametrize(
    ("harm", "message"),
    [
        (lambda text: text[: len(text) // 2], "it was cut short or damaged"),
        (lambda text: text.replace('"feasible": true', '"feasible": false'), "edited by hand"),
        (lambda text: text.replace('"schema": 3', '"schema": 9'), "a newer version of jaxsusp"),
        (lambda text: "{}", "is not a plan"),
    ],
)
def test_a_plan_that_is_not_as_it_was_written(run, plan, tmp_path, harm, message):
    path = tmp_path / "harmed.plan.json"
    path.write_text(harm(plan.read_text()))
    status, out, err = run("show", path, "--output", tmp_path / "page.html")
    assert (status, out) == (2, "")
    assert message in err
    assert err.count(str(path)) == 1
    assert not (tmp_path / "page.html").exists()


@pytest.mark.parametrize("content", [b"", b"\x89HDF\r\n\x1a\n" + bytes(200)])
def test_a_dataset_that_is_damaged(run, tmp_path, content):
    path = tmp_path / "harmed.nc"
    path.write_bytes(content)
    status, _, err = run("show", path, "--output", tmp_path / "page.html")
    assert status == 2
    assert err.startswith(f"{path}: cannot be read as NetCDF-4")
    assert "Traceback" not in err


def test_the_folder_of_a_page_is_made(run, plan, tmp_path):
    page = tmp_path / "there" / "is" / "none.html"
    assert run("show", plan, "--output", page)[0] == 0
    assert page.exists()
