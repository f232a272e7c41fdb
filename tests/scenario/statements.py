"""A short scenario file, what can be put into it, and the sentence that it is refused with."""

import pytest

from jaxsusp.errors import ScenarioError
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.toml import value_text

MINIMAL = """\
payload = { mass = 10, radius = 0.1, height = 0.3 }
task = { start = [0, 2, 1], goal = [0, -2, 3] }
robots = [
    { base = [0, 5, 0], links = [4, 3, 2], end = [0, 6, 7] },
    { base = [-4.33, -2.5, 0], links = [4, 3, 2], end = [-5.2, -3, 7] },
    { base = [4.33, -2.5, 0], links = [4, 3, 2], end = [5.2, -3, 7] },
]
"""

TOWER = '[[obstacles]]\nname = "tower"\nkind = "box"\ncenter = [2, -1, 1.8]\nsize = [1, 1, 3.6]\n'


def complaint(text, source="my.toml"):
    """The one line that a text is refused with."""
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(text, source)
    (line,) = caught.value.problems
    assert str(caught.value) == line
    return line


def changed(old, new, text=MINIMAL):
    assert old in text
    return text.replace(old, new, 1)


def mesh_table(**keys):
    lines = [f"{key} = {value_text(value)}" for key, value in keys.items()]
    return "\n".join(["[[obstacles]]", 'kind = "mesh"', "center = [2, 2, 0.4]", *lines, ""])
