"""The pages of the site: their examples run, they name what there is, and nothing is left out.

`make docs` checks the rest while it builds: what pages run, every link, every public name.
"""

import importlib
import re
import sys
from collections import Counter

import pages
import pytest
import yaml

import jaxsusp as js

sys.path.append(str(pages.ROOT / "docs"))
import links

DOCS = pages.ROOT / "docs"
PAGES = [path for path in sorted(DOCS.rglob("*.md")) if path.name != "architecture.md"]
PROGRAMS = [example for page in PAGES for example in pages.examples(page, "python")]
FILES = [example for page in PAGES for example in pages.examples(page, "toml")]


@pytest.mark.pages
@pytest.mark.parametrize("example", PROGRAMS, ids=lambda each: each.name.removeprefix("docs/"))
def test_programs_run(example, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    pages.run(example)
    assert bool(capsys.readouterr().out) == ("print" in example.text)


@pytest.mark.fast
@pytest.mark.parametrize("example", FILES, ids=lambda each: each.name.removeprefix("docs/"))
def test_scenario_files_load(example):
    assert js.Scenario.from_toml(example.text, "yard.toml").name == "yard"


@pytest.mark.fast
def test_every_public_name_is_in_the_reference_once():
    text = "\n".join(path.read_text(encoding="utf-8") for path in (DOCS / "api").glob("*.md"))
    named = Counter(" ".join(re.findall(r"```\{public\}\n(.*?)```", text, re.DOTALL)).split())
    assert named == Counter(js.__all__)


@pytest.mark.fast
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_files_and_targets_exist(page):
    text = page.read_text(encoding="utf-8")
    makefile = (pages.ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"(?:`|^)make ([\w-]+)", text, re.MULTILINE):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target
    for path in re.findall(r"`((?:jaxsusp|tests|experiments)/[\w/.-]+)`", text):
        assert (pages.ROOT / path).exists(), path


@pytest.mark.fast
def test_functions_that_draw_are_where_the_page_says():
    text = (DOCS / "howto" / "figures.md").read_text(encoding="utf-8")
    rows = re.findall(r"\| ((?:`\w+`(?:, )?)+) in `(jaxsusp\.[\w.]+)` \|", text)
    assert len(rows) == 7
    for names, module in rows:
        for name in re.findall(r"\w+", names):
            assert callable(getattr(importlib.import_module(module), name))


@pytest.mark.fast
@pytest.mark.parametrize(
    ("page", "fault"),
    [
        ('<a href="gone.html">x</a>', "links to gone.html: there is no such file"),
        ('<a href="#gone">x</a>', "links to #gone: there is no such anchor"),
        ('<a href="other.html#gone">x</a>', "links to other.html#gone: there is no such anchor"),
        ('<img src="gone.png">', "loads gone.png: there is no such file"),
        (
            '<script src="https://a.org/x.js"></script>',
            "loads https://a.org/x.js from another host",
        ),
        ('<img src="//a.org/x.png">', "loads //a.org/x.png from another host"),
    ],
)
def test_faults_of_a_site_are_found(page, fault, tmp_path):
    (tmp_path / "other.html").write_text('<p id="here">')
    (tmp_path / "index.html").write_text(page)
    assert links.wrong(tmp_path) == [f"index.html {fault}"]


@pytest.mark.fast
def test_a_site_without_faults_has_none(tmp_path):
    (tmp_path / "index.html").write_text(
        '<a id="top" href="index.html#top">x</a> <a href="https://a.org">y</a> '
        '<img src="data:image/png;base64,">'
    )
    (tmp_path / "site.css").write_text('a { background: url("data:image/png;base64,") }')
    assert links.wrong(tmp_path) == []
    (tmp_path / "far.css").write_text('@import "https://a.org/x.css";')
    assert links.wrong(tmp_path) == ["far.css asks another host"]


@pytest.mark.fast
def test_the_citation_is_in_the_citation_file_format():
    """The keys that version 1.2.0 asks for, of the software and of what it refers to."""
    cited = yaml.safe_load((pages.ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert cited["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= cited.keys()
    assert cited["authors"] == [{"name": "The jaxsusp authors"}]
    assert cited["type"] in ("software", "dataset")
    assert cited["version"] == js.__version__
    assert cited["license"] == "Apache-2.0"
    (paper,) = cited["references"]
    assert {"type", "title", "authors"} <= paper.keys()
    names = [author["family-names"] for author in paper["authors"]]
    assert names == ["Zhao", "Zhao", "Su", "Meng", "Sang"]
    assert all(author.keys() == {"family-names", "given-names"} for author in paper["authors"])
