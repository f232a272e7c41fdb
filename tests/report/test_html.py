"""What objects show of themselves in a notebook: a small table and one picture, escaped."""

import base64
import re

import pytest

import jaxsusp as js
from jaxsusp.scenario.starter import starter
from jaxsusp.suspension.workspace import workspace


@pytest.fixture(scope="module")
def plan():
    return js.load_plan("tests/files/scenario-1-0.1.0.plan.json")


@pytest.fixture(scope="module")
def comparison():
    return js.load_results("tests/files/compare-0.1.0.nc")


def picture(html: str) -> bytes:
    """The one PNG inside of a page."""
    (data,) = re.findall(r'src="data:image/png;base64,([^"]+)"', html)
    png = base64.b64decode(data, validate=True)
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    return png


def test_a_scenario(scenarios):
    html = scenarios[2]._repr_html_()
    assert "<b>scenario-3</b>" in html
    assert '<td style="text-align:left">8</td>' in html
    assert len(picture(html)) < 150_000


def test_names_are_escaped():
    html = starter("<script>alert(1)</script> & co")._repr_html_()
    assert "<script>" not in html
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; co" in html


def test_a_free_space():
    space = js.load_free_space("tests/files/scenario-1-0.1.0.free-space.nc")
    html = space._repr_html_()
    assert f"{len(space.d)}, among" in html
    assert len(picture(html)) < 150_000


def test_a_free_space_without_a_way_says_why():
    """Also one without any region."""
    walled = starter("walled").model_dump(exclude_none=True)
    walled["workspace"]["upper"] = (3.5, 3.5, 3.3)
    walled["obstacles"] = [{"kind": "box", "center": (0, 0, 1.6), "size": (8, 0.2, 3.2)}]
    space = js.free_space(js.Scenario.model_validate(walled), limit=4, cache=False)
    assert not space.connected
    html = space._repr_html_()
    assert "no collision-free route found" in html
    picture(html)


def test_a_plan(plan):
    html = plan._repr_html_()
    assert "<b>plan of scenario-1</b>" in html
    assert f"{plan.law.path.length:.4g} m in 40 s" in html
    assert len(picture(html)) < 200_000


def test_a_comparison_shows_itself_beside_what_xarray_shows(comparison):
    overview = comparison.jaxsusp
    assert repr(overview).startswith("<Comparison: 2 scenarios, 2 algorithms, 2 runs")
    html = overview._repr_html_()
    assert "clear runs" in html
    picture(html)
    assert "xr-wrap" in comparison._repr_html_()


def test_what_is_no_comparison_is_told_so(comparison):
    with pytest.raises(js.InputError, match="is no comparison"):
        repr(comparison[["terms"]].jaxsusp)
    with pytest.raises(js.InputError, match="its dimensions kept"):
        repr(comparison.isel(run=0).jaxsusp)


def test_an_examination_tells_what_the_command_tells(scenarios, monkeypatch):
    from jaxsusp.planning.prospects import examination

    monkeypatch.setattr(examination, "workspace", lambda task: workspace(task, 0.5))
    monkeypatch.setattr(examination, "free_space", lambda task: js.free_space(task, 0.4))
    html = js.examine(scenarios[0])._repr_html_()
    assert "Own units: 1 m" in html
    assert "Robots and their cables" in html
    picture(html)
