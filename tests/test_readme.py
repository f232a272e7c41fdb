"""What the README shows works as it stands there, but for fewer runs, iterations and scenarios."""

import re
from pathlib import Path

import pytest

import jaxsusp as js

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


@pytest.mark.parametrize("i", range(len(blocks("python"))))
def test_examples_run(i, capsys):
    code = blocks("python")[i]
    few = "runs=2, iterations=6, population=8"
    if "js.compare" in code:  # as in other tests, which compile these sizes of ga as well
        few = "runs=4, iterations=40, population=30"
    code = code.replace("runs=20", few).replace('["pso", js', '["ga", js')
    code = code.replace("js.compare(", 'js.compare(["scenario-1", "scenario-3"], ')
    exec(compile(code, f"README block {i}", "exec"), {})
    if "print" in code:
        assert "fitness" in capsys.readouterr().out


@pytest.mark.fast
def test_the_scenario_loads():
    (text,) = blocks("toml")
    scenario = js.Scenario.from_toml(text, "yard.toml")
    assert scenario.name == "yard"
    assert scenario.obstacles[0].yaw_deg == 20


@pytest.mark.fast
def test_commands_and_files_exist():
    targets = set(re.findall(r"(?:`|^)make (\w+)", README, re.MULTILINE))
    makefile = (Path(__file__).parents[1] / "Makefile").read_text()
    assert targets
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in targets)
    for path in re.findall(r"`((?:jaxsusp|tests)/[\w/.-]+)`", README):
        assert (Path(__file__).parents[1] / path).exists(), path
    assert not re.search(r"@[A-Z]+@", README)
