"""Plan files: exact round trip, and every way in which a file is not what it was."""

import csv
import json

import numpy as np
import pytest
from plans import EXAMPLES, LOW

import jaxsusp as js
from jaxsusp.planning.document import digest
from jaxsusp.planning.plan import ARRAYS


@pytest.fixture(scope="module")
def plan(scenarios) -> js.Plan:
    return js.plan_through(scenarios[0], LOW, settings={"seed": 3, "fitness": np.inf})


@pytest.fixture
def file(plan, tmp_path):
    path = tmp_path / "plan.json"
    plan.save(path)
    return path


LAW = [name for name, shape in ARRAYS.values() if shape == ("breaks",)]


def rewrite(file, change, sign: bool = True) -> None:
    """Change a file's content, with a digest that fits."""
    document = json.loads(file.read_text())
    change(document)
    if sign:
        document["digest"] = digest(document)
    file.write_text(json.dumps(document))


def test_a_plan_loads_back_exactly(plan, file, tmp_path):
    loaded = js.load_plan(file)
    for field in ARRAYS:
        np.testing.assert_array_equal(getattr(loaded, field), getattr(plan, field), strict=True)
    assert loaded.scenario == plan.scenario
    assert loaded.report == plan.report
    assert loaded.certificate == plan.certificate
    assert loaded.settings == plan.settings
    assert (loaded.feasible, loaded.reasons) == (plan.feasible, plan.reasons)
    loaded.save(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == file.read_bytes()


@pytest.mark.fast
def test_a_plan_with_moving_ends_loads_back_exactly(tmp_path):
    plan = js.plan_through(js.load_scenario("base-driven"), EXAMPLES["base-driven"])
    plan.save(tmp_path / "plan.json")
    loaded = js.load_plan(tmp_path / "plan.json")
    assert loaded.ends.shape == loaded.end_path.shape == (40, 3, 3)
    for field in ARRAYS:
        np.testing.assert_array_equal(getattr(loaded, field), getattr(plan, field), strict=True)
    times = np.linspace(0, 40, 7)
    np.testing.assert_array_equal(loaded.ends_at(times), plan.ends_at(times))


def test_a_file_of_the_first_schema_is_read(plan, file):
    def back(document):
        document.update(schema=1)
        for new in ("end_path_m", "angles_rad", *LAW):
            del document[new]

    rewrite(file, back)
    loaded = js.load_plan(file)
    for field in ARRAYS:
        np.testing.assert_allclose(getattr(loaded, field), getattr(plan, field), atol=1e-12)


def test_of_a_file_that_does_not_know_proofs_nothing_but_distances_is_proved(plan, file):
    def back(document):
        document.update(schema=2)
        for row in document["report"]:
            del row["proved"], row["bound"]

    assert all(each.proved == each.ok for each in plan.report)
    rewrite(file, back)
    loaded = js.load_plan(file).report
    assert {each.name.startswith("distance of") for each in loaded if each.proved} <= {True}
    assert any(each.proved for each in loaded) == plan.certificate.proved


def test_the_file_is_plain_json_with_units_in_its_names(file):
    document = json.loads(file.read_text(), parse_constant=lambda word: pytest.fail(word))
    assert document["schema"] == 3
    assert {name for name, _ in ARRAYS.values()} <= set(document)


def test_an_edited_file_is_refused(file):
    file.write_text(file.read_text().replace('"feasible": true', '"feasible": false'))
    with pytest.raises(js.InputError, match="digest does not match"):
        js.load_plan(file)


def test_a_number_changed_in_the_last_digit_is_noticed(file):
    def change(document):
        document["tensions_N"][7][1] += 1e-12

    rewrite(file, change, sign=False)
    with pytest.raises(js.InputError, match="digest"):
        js.load_plan(file)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.99])
def test_a_truncated_file_is_refused(file, share):
    text = file.read_text()
    file.write_text(text[: int(share * len(text))])
    with pytest.raises(js.InputError, match="cut short"):
        js.load_plan(file)


def test_a_newer_version_is_refused_as_such(file):
    rewrite(file, lambda document: document.update(schema=4, wings=[1, 2]))
    with pytest.raises(js.InputError, match="newer version"):
        js.load_plan(file)


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d.pop("tensions_N"),
        lambda d: d.update(times_s=d["times_s"][:-1]),
        lambda d: d.update(ends_m="here"),
        lambda d: d.update(report=[{"name": "what"}]),
        lambda d: d.update(lengths_m=[[True, 1, 2]]),
        lambda d: d["certificate"].pop("proved"),
    ],
)
def test_a_signed_file_that_is_no_plan_is_refused(file, change):
    rewrite(file, change)
    with pytest.raises(js.InputError, match="not a complete plan"):
        js.load_plan(file)


@pytest.mark.fast
def test_other_files_are_refused(tmp_path):
    for content in (b"[]", b"{}", b'{"format": "jaxsusp plan", "schema": true}', b"\xff\xfe"):
        (tmp_path / "other.json").write_bytes(content)
        with pytest.raises(js.InputError, match=r"other\.json"):
            js.load_plan(tmp_path / "other.json")
    with pytest.raises(js.InputError, match="no such file"):
        js.load_plan(tmp_path / "missing.json")


def test_the_csv_holds_the_samples_with_units(plan, tmp_path):
    plan.save_csv(tmp_path / "plan.csv")
    with (tmp_path / "plan.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 40
    found = np.array([[float(row[f"tension_{k}_N"]) for k in (1, 2, 3)] for row in rows])
    np.testing.assert_array_equal(found, plan.tensions)
    assert {"time_s", "x_velocity_m_per_s", "joint_2_3_rad", "end_3_z_m"} <= set(rows[0])
