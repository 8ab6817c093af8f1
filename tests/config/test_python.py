"""The same models from Python: the same checks, the same sentences."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

from tether.bodies import Bodies
from tether.box import Box
from tether.config import Configuration, Interval, Output, Run
from tether.errors import InputError, RunError, TetherError
from tether.flows import Couette, Rest
from tether.fluid import Fluid
from tether.shapes import cube, points, polygon, square


@pytest.mark.parametrize(
    ("model", "values", "sentence"),
    [
        (Fluid, {"temperature": -1}, "Fluid: temperature = -1 must be greater than 0 (thermal energy kT"),
        (
            Fluid,
            {},
            "Fluid: temperature is missing (thermal energy kT, in units of energy); give temperature, for",
        ),
        (Fluid, {"temprature": 1}, "Fluid: temprature is not a key of Fluid (keys are checked so that"),
        (Fluid, {"temperature": None}, "Fluid: temperature = None is nothing, not a number ("),
        (Fluid, {"temperature": object()}, "Fluid: temperature = <object object at"),
        (Couette, {"shear_rate": 0.0}, "Couette: shear_rate = 0 does not shear ("),
        (Couette, {"shear_rate": np.nan}, "Couette: shear_rate = nan is not a finite number ("),
        (Bodies, {"shape": 3, "count": 1}, "Bodies: shape = 3 is none of the values there are ("),
        (
            Bodies,
            {"shape": cube(), "count": 1, "spacing": 0.3},
            "Bodies: spacing is given beside a Shape object (",
        ),
        (
            Bodies,
            {"shape": "points", "count": 1},
            'Bodies: points is missing (shape = "points" needs it); give it',
        ),
        (Box, {"size": [3]}, "Box: size = [3] has 1 item ("),
        (Run, {"timestep": 0.1, "steps": 1, "strain": 2}, "Run: strain = 2.0 is given beside steps ("),
        (
            Output,
            {"frames": {"steps": -1}},
            "Output: frames.steps = -1 must be at least 1 (steps); give 1 or more",
        ),
    ],
)
def test_one_sentence(model: Any, values: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        model(**values)
    assert str(caught.value).startswith(sentence)
    assert "pydantic" not in str(caught.value)


def test_nested_errors_keep_their_place() -> None:
    run = {"timestep": 0.005, "steps": 10}
    with pytest.raises(InputError, match=r"^Configuration: fluid\.temperature = -1 must be greater than 0"):
        Configuration(box={"size": [10, 10]}, fluid={"temperature": -1}, run=run)
    with pytest.raises(InputError, match=r"^Configuration: box\.size\.0 = true is .* \(and 1 more error\)$"):
        Configuration(box={"size": [True, 10]}, fluid={"temperature": -1}, run=run)
    kinds = [Bodies(square(), count=1), {"cuont": 3}]
    with pytest.raises(InputError, match=r"^Configuration: bodies\.1\.cuont is not a key of \[\[bodies\]\]"):
        Configuration(box=Box(10, 10), fluid=Fluid(temperature=1.0), bodies=kinds, run=run)
    with pytest.raises(InputError, match=r"^Configuration: flow\.shear_rate = 0 does not shear"):
        Configuration(box=Box(9, 9), fluid=Fluid(temperature=1.0), run=run, flow={"kind": "couette", "shear_rate": 0})


def test_wrong_objects() -> None:
    tables: dict[str, Any] = {
        "box": Box(9, 9),
        "fluid": Fluid(temperature=1.0),
        "run": Run(timestep=0.1, steps=1),
    }
    for name in tables:
        with pytest.raises(InputError, match=rf"^Configuration: {name} = 3 is a whole number, not a table"):
            Configuration(**{**tables, name: 3})
    with pytest.raises(InputError, match=r"^Configuration: flow\.kind is missing"):
        Configuration(**tables, flow=tables["box"])


def test_box() -> None:
    assert Box(20, 20, 10) == Box(size=[20, 20, 10])
    assert (Box(20, 20, 10).dimension, Box(20, 20, 10).volume) == (3, 4000)
    assert (Box(20, 5).dimension, Box(20, 5).volume) == (2, 100)
    with pytest.raises(TypeError):
        Box(1, 2, size=[1, 2])


def test_shape_objects() -> None:
    assert Bodies(cube(0.3), count=5) == Bodies("cube", spacing=0.3, count=5)
    assert Bodies(polygon(6, 0.2), count=5) == Bodies(shape="polygon", sides=6, spacing=0.2, count=5)
    rod = points([[0, 0], [1, 0], [2, 0]])
    assert np.array_equal(Bodies(rod, count=5).geometry.sites, rod.sites)
    assert Bodies(count=5).geometry.name == "cube"


def test_numpy_numbers_are_numbers() -> None:
    assert Fluid(temperature=np.float32(0.5)).temperature == 0.5
    assert Bodies(cube(), count=np.int64(7)).count == 7
    assert Box(size=np.array([4, 5])).size == (4.0, 5.0)
    assert Bodies("points", points=[np.array([0, 0]), np.array([1, 0])], count=1).geometry.dimension == 2
    with pytest.raises(InputError):
        Fluid(temperature=np.bool_(True))


def test_a_bare_number_is_an_interval_in_steps() -> None:
    assert Output(frames=100, checkpoint=50) == Output(frames=Interval(steps=100), checkpoint=Interval(steps=50))


def test_nothing_can_be_changed_but_copied() -> None:
    fluid = Fluid(temperature=1.0)
    with pytest.raises(InputError, match=r"^Fluid\.temperature cannot be changed .* changed\(temperature=\.\.\.\)$"):
        fluid.temperature = 2.0  # type: ignore[misc]
    with pytest.raises(InputError, match=r"^Fluid\.temperature cannot be changed"):
        del fluid.temperature
    assert fluid.changed(temperature=2.0) == Fluid(temperature=2.0)
    assert fluid.changed(noise=None, friction=4.5) == Fluid(temperature=1.0, friction=4.5)
    assert Bodies(cube(), count=3).changed(count=4) == Bodies(cube(), count=4)
    with pytest.raises(InputError):
        fluid.changed(temperature=-2.0)


def test_flows_have_a_shear_rate() -> None:
    assert (Rest().shear_rate, Couette(shear_rate=-2).shear_rate) == (0.0, -2.0)


def test_errors() -> None:
    error = InputError("a is wrong", "it has to be right", "mend it", key=("a",), place="file, line 1", more=2)
    assert str(error) == "file, line 1: a is wrong (it has to be right); mend it (and 2 more errors)"
    assert str(RunError("it stopped")) == "it stopped"
    assert [kind.exit_code for kind in (TetherError, InputError, RunError)] == [1, 2, 1]
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again), again.key) == (InputError, str(error), ("a",))
