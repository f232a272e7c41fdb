"""The paper's figures and tables from a miniature of every run."""

import numpy as np
import pytest
from matplotlib.text import Text

from experiments import contents, pages
from experiments.artefacts import Artefacts
from experiments.contents import Work, module
from experiments.published import comparison, ends, motion, schemes, space, towing
from jaxsusp.errors import InputError
from jaxsusp.planning import steps
from jaxsusp.report.comparison import paper

pytestmark = pytest.mark.pages

PUBLISHED = [name for name in contents.NAMES if name.startswith("published.")]
PAGE = 7.1  # inches


@pytest.fixture(scope="module")
def artefacts(tmp_path_factory):
    """Of every page that needs runs: three algorithms, two runs, twenty iterations."""
    folder = tmp_path_factory.mktemp("artefacts")
    kept = Artefacts(folder / "data")
    for page in (comparison, ends):
        page.make(page.MINIATURE, Work(kept, folder / page.__name__, lambda line: None))
    return kept


@pytest.mark.parametrize("name", PUBLISHED)
def test_every_page_is_drawn_for_print(name, artefacts, tmp_path):
    found = module(name)
    assert found.PRINTED
    page = found.draw(artefacts)
    assert page.figures or page.tables
    for figure in page.figures.values():
        assert figure.get_label(), "a figure without a caption"
        assert figure.get_figwidth() <= PAGE
        shown = [text for text in figure.findobj(Text) if text.get_text().strip()]
        assert min(text.get_fontsize() for text in shown) >= 7
    files = pages.write(name, artefacts, tmp_path / "site", tmp_path / "more")
    assert all(file.stat().st_size > 0 for file in files)
    text = files[0].read_text(encoding="utf-8")
    assert found.PRINTED in text
    assert "nan" not in page.findings


def test_what_a_comparison_lacks_is_left_out_and_told(artefacts):
    page = comparison.draw(artefacts)
    assert "no run of ga, scenario-2" in page.findings
    assert "table-1-sdbo-dbo" in page.tables
    assert "table-1-sdbo-ga" not in page.tables
    ratios = page.tables["table-1-sdbo-dbo"]
    ds = artefacts.comparison("comparison")
    dbo, sdbo = (ds["fitness"].sel(algorithm=name).values[0] for name in ("dbo", "sdbo"))
    ours = ratios[ratios["source"] == "ours"].iloc[0]
    assert ours["average"] == pytest.approx(sdbo.mean() / dbo.mean())
    assert ours["a12"] == np.mean(sdbo[:, None] < dbo)
    printed = page.tables["table-1-printed"]
    assert printed["average"].tolist() == paper.table1()["average"].values[0].tolist()


def test_without_the_paper_s_own_there_is_no_system_to_show(artefacts, tmp_path):
    ds = artefacts.comparison("comparison").sel(algorithm=["pso", "dbo"])
    other = Artefacts(tmp_path)
    other.keep("comparison", ds)
    with pytest.raises(InputError, match="holds no algorithm sdbo, of which this page tells"):
        towing.draw(other)
    page = comparison.draw(other)
    assert not any("sdbo" in name for name in page.tables)
    assert "no run of ga, sdbo" in page.findings


def test_the_motion_of_a_plan_is_that_of_its_law(artefacts):
    page = motion.draw(artefacts)
    table = page.tables["motion"].set_index("algorithm")
    assert list(table.index) == ["pso", "dbo", "sdbo"]
    figure = page.figures["motion"]
    assert len(figure.axes) == 12
    accelerations = figure.axes[6:9]
    for place, name in enumerate(table.index):
        for axes, axis in zip(accelerations, "xyz", strict=True):
            drawn = np.abs(axes.get_lines()[place].get_ydata()).max()
            assert drawn == pytest.approx(table.loc[name, f"a{axis}"], rel=0.05)


def test_the_scheme_follows_the_steps(monkeypatch):
    text = [text.get_text() for text in schemes.draw(None).figures["scheme"].axes[0].texts]
    assert [line for line in text if line[:1].isdigit()] == [
        "1  map_space", "2  plan_load", "3  coordinate", "4  plan_ends", "5  verify",
    ]  # fmt: skip
    named = steps.__doc__.replace("`plan_load`", "`plan_weight`")
    monkeypatch.setattr(steps, "__doc__", named)
    with pytest.raises(InputError, match="step 2, plan_weight: planning does not come to it"):
        schemes.scheme()
    monkeypatch.setattr(steps, "plan_weight", steps.__dict__["taut_ways"], raising=False)
    assert "2  taut_ways" in [step.name for step in schemes.scheme()[0].body[:-1]]


def test_a_trajectory_in_the_plane_stays_in_its_polygons():
    scenario = space.flat()
    found = space.free_space(scenario)
    assert found.connected
    way = next(iter(space.rounded_ways(found, 40)))
    assert found.contains(way).all()
    assert np.ptp(way[:, 2]) < space.THICK


def test_printed_ends_are_out_of_reach_and_ours_within(artefacts):
    printed = paper.tables_2_3()
    assert ends.out_of_reach(printed).all()
    frame = artefacts.frame("ends")
    assert not ends.out_of_reach(frame).any()
    tables = ends.draw(artefacts).tables
    lengths = tables["table-3"]
    first = lengths.iloc[0]  # the paper: 19.5424 m
    assert (first["algorithm"], first["sum"]) == ("pso", pytest.approx(19.5424, abs=1e-4))
    ours = lengths[lengths["scenario"] == "scenario-1"]
    cable = frame.groupby("algorithm", sort=False)["f3"].first()
    assert ours["sum"].tolist() == pytest.approx(cable.tolist())
