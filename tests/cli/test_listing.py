"""Listings and help: lines for people, rows for machines."""

import json

import pytest

import jaxsusp as js
from jaxsusp.optim import choices


@pytest.mark.fast
@pytest.mark.parametrize("columns", ["20", "80"])
def test_every_row_of_a_listing_is_one_line(run, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    for arguments in (["scenarios"], ["scenarios", "--examples"], ["algorithms"]):
        lines = run(*arguments)[1].splitlines()
        assert len(lines) == 1 + len(json.loads(run(*arguments, "--json")[1]))
        assert not any("…" in line for line in lines)
        assert max(map(len, lines)) <= 80 or arguments == ["algorithms"]


@pytest.mark.fast
def test_help_shows_flags_as_flags(run):
    for command, flags in (("compare", ["--resume", "--json"]), ("scenarios", ["--examples"])):
        lines = run(command, "--help")[1].splitlines()
        for flag in flags:
            (line,) = (line for line in lines if line.startswith(f"│ {flag} "))
            assert "<bool>" not in line


def test_lists_are_tables_or_json(run):
    for command, name in (("scenarios", "scenario"), ("algorithms", "algorithm")):
        code, out, err = run(command)
        assert code == 0
        assert ('`jaxsusp plan` also takes "taut"' in err) == (command == "algorithms")
        rows = json.loads(run(command, "--json")[1])
        assert all(row[name] in out for row in rows)
    assert [row["algorithm"] for row in rows] == list(js.ALGORITHMS)


@pytest.mark.fast
def test_without_other_libraries_their_list_is_empty_and_says_what_brings_them(run, monkeypatch):
    monkeypatch.setattr(choices, "find_spec", lambda _: None)
    code, out, err = run("algorithms", "--peers", "--json")
    assert (code, json.loads(out)) == (0, [])
    assert (
        'evosax and pymoo: not installed; pip install ".[peers]" in a copy of the repository' in err
    )
    assert run("algorithms", "--peers")[0] == 0


@pytest.mark.parametrize("command", ["compare", "report", "scenarios", "algorithms"])
def test_help_shows_an_example(run, command):
    code, out, err = run(command, "--help")
    assert (code, err) == (0, "")
    assert f"Example: jaxsusp {command}" in out
