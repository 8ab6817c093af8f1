"""What is varied, and in which combinations."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_studies import study

from tether.errors import InputError
from tether.study import Study
from tether.study.sweep import axes_of, settings

BASE = {
    "box": {"size": [4.0, 4.0]},
    "fluid": {"temperature": 1.0},
    "bodies": [{"shape": "square", "count": 3}],
    "flow": {"kind": "couette", "shear_rate": 0.5},
    "run": {"timestep": 0.005, "steps": 200},
}


def test_axes_are_crossed_in_the_order_of_the_file_and_the_last_changes_fastest(tmp_path) -> None:
    text = """\
base = "couette.toml"
[sweep]
flow.shear_rate = [0.5, 1.0]
[[sweep.zip]]
bodies.0.count = [1, 2, 3]
fluid.temperature = [0.5, 1.0, 2.0]
[sweep.box]
size = [[4.0, 4.0], [5.0, 4.0]]
"""
    asked = study(tmp_path, text)
    assert [axis.name for axis in asked.axes] == ["flow.shear_rate", "bodies.0.count", "box.size"]
    assert asked.axes[1].names == ("bodies.0.count", "fluid.temperature")
    counts_and_temperatures = [(1, 0.5), (2, 1.0), (3, 2.0)]
    wanted = itertools.product([0.5, 1.0], counts_and_temperatures, [(4.0, 4.0), (5.0, 4.0)])
    for ensemble, (rate, (count, temperature), size) in zip(asked.ensembles, wanted, strict=True):
        made = ensemble.configuration
        assert made.flow.shear_rate == rate
        assert made.bodies[0].count == count
        assert made.fluid.temperature == temperature
        assert made.box.size == size
        assert made.run == asked.ensembles[0].configuration.run
    assert asked.ensembles[1].label == "shear_rate = 0.5, count = 1, temperature = 0.5, size = [5.0, 4.0]"


@pytest.mark.parametrize(
    ("written", "values"),
    [
        ("{linspace = [0.1, 0.3, 3]}", [0.1, 0.2, 0.3]),  # not 0.30000000000000004
        ("{linspace = [1, 9, 5]}", [1, 3, 5, 7, 9]),
        ("{linspace = [1, 2, 3]}", [1.0, 1.5, 2.0]),
        ("{linspace = [2.0, -1.0, 3]}", [2.0, 0.5, -1.0]),
        ("{logspace = [0.01, 1.0, 3]}", [0.01, 0.1, 1.0]),
        ("{logspace = [1, 100, 3]}", [1, 10, 100]),
        ("{logspace = [-8.0, -2.0, 3]}", [-8.0, -4.0, -2.0]),
    ],
)
def test_ranges_have_the_values_that_one_would_write(tmp_path, written: str, values: list[float]) -> None:
    asked = study(tmp_path, f'base = "couette.toml"\n[sweep]\nflow.shear_rate = {written}\n')
    found = list(asked.axes[0].values[0])
    assert found == values
    assert [type(value) for value in found] == [type(value) for value in values]


def test_ranges_are_linear_and_logarithmic(tmp_path) -> None:
    for kind, steps in {"linspace": np.diff, "logspace": lambda x: np.diff(np.log(x))}.items():
        asked = study(tmp_path, f'base = "couette.toml"\n[sweep]\nflow.shear_rate = {{{kind} = [0.03, 1.7, 12]}}\n')
        step = steps(np.array(asked.axes[0].values[0]))
        assert len(step) == 11
        np.testing.assert_allclose(step, step[0], rtol=1e-9)


def test_any_key_can_be_swept_tables_and_keys_that_the_base_lacks_as_well(tmp_path) -> None:
    text = """\
base = "couette.toml"
[set]
run.steps = 100
[sweep]
flow = [{kind = "couette", shear_rate = 0.5}, {kind = "poiseuille", force = 0.1}, {kind = "rest"}]
bodies.0.volume_fraction = [0.1, 0.2]
"run.engine" = ["cpu", "reference"]
"""
    asked = study(tmp_path, text)
    made = [ensemble.configuration for ensemble in asked.ensembles]
    assert [each.flow.kind for each in made] == ["couette"] * 4 + ["poiseuille"] * 4 + ["rest"] * 4
    assert {each.run.steps for each in made} == {100}
    assert {each.bodies[0].count for each in made} == {None}, "the base's count has made way"
    assert [each.run.engine for each in made[:2]] == ["cpu", "reference"]


def test_bodies_can_be_swept_as_a_whole() -> None:
    two, three = ([{"shape": "square", "count": count}] for count in (2, 3))
    asked = Study(base=BASE, sweep={"bodies": [two, three]})
    assert [ensemble.configuration.bodies[0].count for ensemble in asked.ensembles] == [2, 3]


def test_without_a_sweep_there_is_one_setting() -> None:
    asked = Study(base=BASE, repeats=3)
    assert len(asked.ensembles) == 1
    assert asked.ensembles[0].label == "the base as it is"
    assert len({point.identity for point in asked.points}) == 3


KEYS = st.lists(st.text("abcdefgh", min_size=1, max_size=4), min_size=1, max_size=5, unique=True)
NUMBERS = st.floats(-1e6, 1e6, allow_nan=False)


@st.composite
def sweeps(draw):
    """A sweep, and how many values each of its axes has."""
    keys, table, lengths, zipped = draw(KEYS), {}, [], []
    for key in keys:
        kind = draw(st.sampled_from(["list", "linspace", "zip"]))
        length = draw(st.integers(1 if kind != "linspace" else 2, 4))
        if kind == "linspace":
            table[f"section.{key}"] = {"linspace": [0, draw(st.floats(1, 100)), length]}
            lengths.append(length)
            continue
        values = draw(st.lists(NUMBERS, min_size=length, max_size=length, unique=True))
        if kind == "list":
            table[key] = values
            lengths.append(length)
        else:
            zipped.append({f"zipped.{key}": values, f"also.{key}": values})
    if zipped:
        table["zip"] = zipped
        lengths += [len(next(iter(each.values()))) for each in zipped]
    return table, lengths


@given(sweeps())
def test_there_are_as_many_settings_as_the_product_of_the_axes(sweep) -> None:
    table, lengths = sweep
    axes = axes_of(table)
    found = settings(axes)
    assert [len(axis) for axis in axes] == lengths
    assert len(found) == math.prod(lengths)
    assert len({each.places for each in found}) == len(found)
    assert len({tuple(each.values.items()) for each in found}) == len(found)
    for each in found:
        for axis, place in zip(axes, each.places, strict=True):
            for name, values in zip(axis.names, axis.values, strict=True):
                assert each.values[name] == values[place]
    assert [each.places for each in found] == sorted(each.places for each in found)


@given(sweeps(), st.integers(2, 6))
def test_a_zip_whose_lists_differ_in_length_is_refused(sweep, length: int) -> None:
    table, _ = sweep
    with pytest.raises(InputError, match="change together"):
        axes_of({**table, "zip": {"one": list(range(length)), "other": list(range(length + 1))}})


def test_a_study_in_its_folder_is_the_same_study(tmp_path) -> None:
    text = """\
base = "couette.toml"
repeats = 2
stop_when = {viscosity = 0.05, pressure = 0.001}
relative = true
[set]
bodies.0.volume_fraction = 0.1
output.series = 2
[sweep]
"flow.shear_rate" = {logspace = [0.1, 1.0, 3]}
box.size = [[4.0, 4.0], [5.0, 5.0]]
[[sweep.zip]]
fluid.temperature = [0.5, 1.0]
fluid.repulsion = [10.0, 20.0]
"""
    asked = study(tmp_path, text)
    path = tmp_path / "again.toml"
    path.write_text(asked.to_toml(), encoding="utf-8")
    again = Study.read(path)
    assert [point.identity for point in again.points] == [point.identity for point in asked.points]
    assert [point.label for point in again.points] == [point.label for point in asked.points]
    assert [axis.names for axis in again.axes] == [axis.names for axis in asked.axes]
    assert (again.repeats, again.stop_when, again.relative) == (asked.repeats, asked.stop_when, asked.relative)
    assert again.to_toml() == asked.to_toml()


def test_the_plain_fluid_is_run_once_for_settings_that_share_it(tmp_path) -> None:
    text = 'base = "couette.toml"\nrelative = true\n[sweep]\nflow.shear_rate = [0.5, 1.0]\nbodies.0.count = [1, 2]\n'
    asked = study(tmp_path, text)
    slow, slow_again, fast, fast_again = asked.plain_fluids
    assert slow is slow_again
    assert fast is fast_again
    assert slow is not fast
    assert len(asked.all_ensembles) == 6
    for plain in (slow, fast):
        assert plain is not None
        assert not plain.configuration.bodies
    flow = '{kind = "rest"}, {kind = "couette", shear_rate = 1.0}'
    some = study(tmp_path, f'base = "couette.toml"\nrelative = true\n[sweep]\nflow = [{flow}]\n')
    assert [plain is not None for plain in some.plain_fluids] == [False, True]
