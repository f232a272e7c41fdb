"""The studies of algorithms, as small as can be: made, drawn, and true in what can be checked."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import jaxsusp as js
from experiments import pages
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work, module
from experiments.studies import ablation_effects, origin_bias
from jaxsusp.optim.batch import run_batch
from jaxsusp.problem.problem import stack_problems
from jaxsusp.studies.ablation import VARIANTS

pytestmark = pytest.mark.pages

STUDIES = ("budgets", "origin", "spaces", "ablation")


@pytest.fixture(scope="module")
def artefacts(tmp_path_factory) -> Artefacts:
    """All of them made: one reads what another one keeps."""
    folder = tmp_path_factory.mktemp("studies")
    kept = Artefacts(folder / "data")
    for name in STUDIES:
        found = module(f"studies.{name}")
        found.make(found.MINIATURE, Work(kept, folder / name, lambda _: None))
        assert kept.missing(found.MADE) == []
    return kept


def page(name: str, artefacts: Artefacts) -> Page:
    return module(f"studies.{name}").draw(artefacts)


@pytest.mark.parametrize("name", STUDIES)
def test_a_page_is_written_with_pictures_tables_and_words(name, artefacts, tmp_path):
    files = pages.write(f"studies.{name}", artefacts, tmp_path / "site", tmp_path / "more")
    assert {file.suffix for file in files} == {".md", ".png", ".pdf", ".csv", ".tex"}
    text = Path(files[0]).read_text(encoding="utf-8")
    assert "nan" not in text
    assert text.count("##") >= 1
    assert len(page(name, artefacts).findings) > 200


def test_without_improvements_it_is_dbo_and_with_all_sdbo(artefacts):
    ds = artefacts.dataset("ablation_six").sel(budget="iterations").isel(scenario=0)
    problem = stack_problems([js.Problem.from_scenario("scenario-1", dtype=np.float32)])
    for variant, optimizer in (("none", js.dbo()), ("all", js.sdbo())):
        alone = run_batch(problem, replace(optimizer, name="sdbo"), 0, range(2), 20, 30)
        kept = ds["fitness"].sel(variant=variant).values
        np.testing.assert_allclose(kept, alone.fitness[0], rtol=1e-4)  # float64 of a float32 search


def test_equal_evaluations_are_equal(artefacts):
    ds = artefacts.dataset("ablation_six").isel(scenario=0)
    equal = ds["evaluations"].sel(budget="evaluations")
    assert (equal <= 30 * 21).all()
    assert (equal > 30 * 21 - 90).all()
    spent = ds["evaluations"].sel(budget="iterations")
    assert spent.sel(variant="all") == 60 + 20 * 90
    assert spent.sel(variant="none") == 30 + 20 * 30
    assert [*ds["variant"].values] == [ablation_effects.label(made) for made in VARIANTS]


def test_effects_are_differences_of_means_of_the_variants(artefacts):
    found = page("ablation", artefacts).tables["ablation"].set_index(["budget", "effect"])
    ds = artefacts.dataset("ablation_six").sel(budget="iterations")
    with_it = [ablation_effects.label(made) for made in VARIANTS if made.pull]
    without = [ablation_effects.label(made) for made in VARIANTS if not made.pull]
    middle = np.log(ds["fitness"]).mean(("scenario", "run"))
    change = middle.sel(variant=with_it).mean() - middle.sel(variant=without).mean()
    told = found.loc[("equal iterations", "pull"), "fitness"]
    assert told == pytest.approx(100 * np.expm1(float(change)))


def test_tasks_that_are_moved_show_who_knows_where_the_origin_is(artefacts):
    """In the world's frame no run ends as in another place; all others end alike."""
    same = origin_bias.alike(artefacts.dataset("origin_tasks"))
    assert same["sdbo"] == 0
    assert same["pso"] == same["sdbo-task"] == 1


def test_functions_moved_with_their_bounds_are_the_same_to_all_but_the_world(artefacts):
    ds = artefacts.dataset("origin_functions").isel(function=0)
    for name in ("pso", "sdbo-task"):
        found = ds["fitness"].sel(algorithm=name)
        np.testing.assert_allclose(found.sel(case="moved"), found.sel(case="printed"), rtol=1e-3)
    world = ds["fitness"].sel(algorithm="sdbo")
    assert (world.sel(case="moved") > 100 * world.sel(case="printed")).all()


def test_budgets_give_what_they_say(artefacts):
    ds = artefacts.dataset("budgets").isel(scenario=0)
    assert (ds["iterations"].sel(budget="iterations") == 20).all()
    assert (ds["evaluations"].sel(budget="evaluations") <= 30 * 21).all()
    assert ds["iterations"].sel(budget="time").max() >= 20
    frame = page("budgets", artefacts).tables["budgets"]
    assert (frame["low"] <= frame["mean_rank"]).all()
    assert (frame["mean_rank"] <= frame["high"]).all()


def test_rules_are_those_of_other_pages_and_of_one_made_here(artefacts):
    ds = artefacts.dataset("spaces")
    box = artefacts.dataset("origin_tasks").sel(distance=0)
    np.testing.assert_array_equal(ds["fitness"].sel(search="box"), box["fitness"])
    free = artefacts.dataset("budgets").sel(budget="iterations")
    np.testing.assert_array_equal(ds["fitness"].sel(search="free-space"), free["fitness"])
    assert (ds["seconds"] > 0).all()


def test_runs_that_do_not_depend_on_a_rule_are_found_and_said(artefacts):
    spaces = module("studies.spaces")
    ds = artefacts.dataset("spaces").copy(deep=True)
    assert "pso" not in spaces.alike(ds)
    polytopes = ds["fitness"].sel(search="free-space", algorithm="pso")
    ds["fitness"].loc[{"search": "ellipsoid", "algorithm": "pso"}] = polytopes
    assert "pso" in spaces.alike(ds)
    told = spaces.findings(ds, spaces.changes_of(ds))
    assert "run of PSO is the very same" in told
    assert "PSO" not in told[told.index("the ellipsoids of") : told.index("Every run")]


def test_data_of_other_settings_are_refused(artefacts, tmp_path):
    spaces = module("studies.spaces")
    with pytest.raises(js.InputError, match="spaces: runs is 3, and 2 in budgets"):
        spaces.make(spaces.MINIATURE._replace(runs=3), Work(artefacts, tmp_path, lambda _: None))
