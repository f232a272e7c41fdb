"""What the README shows works as it stands there, but for fewer runs, iterations and scenarios."""

import re

import pages
import pytest

import jaxsusp as js

README = pages.ROOT / "README.md"


@pytest.mark.parametrize("example", pages.examples(README, "python"), ids=lambda each: each.name)
def test_examples_run(example, capsys):
    pages.run(example)
    if "print" in example.text:
        assert "fitness" in capsys.readouterr().out


@pytest.mark.fast
def test_the_scenario_loads():
    (example,) = pages.examples(README, "toml")
    scenario = js.Scenario.from_toml(example.text, "yard.toml")
    assert scenario.name == "yard"
    assert scenario.obstacles[0].yaw_deg == 20


@pytest.mark.fast
def test_commands_and_files_exist():
    text = README.read_text(encoding="utf-8")
    targets = set(re.findall(r"(?:`|^)make (\w+)", text, re.MULTILINE))
    makefile = (pages.ROOT / "Makefile").read_text()
    assert targets
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in targets)
    for path in re.findall(r"`((?:jaxsusp|tests)/[\w/.-]+)`", text):
        assert (pages.ROOT / path).exists(), path
    assert not re.search(r"@[A-Z]+@", text)
