"""The configuration as a whole: numbers made from others, the resolved file, the schema, the template."""

from __future__ import annotations

import json
import math
import re
import tomllib
from pathlib import Path

import jsonschema
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tether.bodies import Bodies
from tether.box import Box
from tether.config import (
    Configuration,
    Interval,
    Output,
    Reference,
    Run,
    Start,
    json_schema,
    load,
    template,
)
from tether.errors import InputError
from tether.flows import Couette, Rest
from tether.fluid import Fluid
from tether.shapes import cube, octahedron, square


def configuration(**changes: object) -> Configuration:
    tables = {"box": Box(10, 10, 10), "fluid": Fluid(temperature=1.0), "run": Run(timestep=0.005, steps=1000)}
    return Configuration(**{**tables, **changes})


def test_counts_of_the_paper() -> None:
    # facts: 2D 10 x 10 with 25 and 100 squares is phi = 0.2 and 0.5, 3D with 250 cubes 1/3
    assert configuration(bodies=[Bodies(cube(), volume_fraction=1 / 3)]).body_counts == (250,)
    assert configuration(box=Box(10, 10), bodies=[Bodies(square(), volume_fraction=0.5)]).body_counts == (100,)
    few = configuration(box=Box(10, 10), bodies=[Bodies(square(), count=25)])
    assert (few.solvent_count, few.constituent_count, few.volume_fraction) == (400, 100, 0.2)
    assert few.dimension == 2


def test_several_kinds_share_one_denominator() -> None:
    kinds = [
        Bodies(cube(), volume_fraction=0.1),
        Bodies(octahedron(), volume_fraction=0.3),
        Bodies(cube(), count=50),
    ]
    mixed = configuration(bodies=kinds)
    particles = mixed.solvent_count + mixed.constituent_count
    for fraction, count, sites in zip((0.1, 0.3), mixed.body_counts[:2], (8, 6), strict=True):
        assert abs(count * sites - fraction * particles) < 8
    assert mixed.body_counts[2] == 50


def test_fractions_that_leave_no_solvent() -> None:
    with pytest.raises(InputError, match=r"bodies\.0\.volume_fraction = 0\.6 leaves no room .* add up to 1\.2\)"):
        configuration(bodies=[Bodies(cube(), volume_fraction=0.6), Bodies(cube(), volume_fraction=0.6)])


def test_the_narrowest_box_takes_the_bodies_of_the_paper() -> None:
    configuration(box=Box(3, 3, 3), bodies=[Bodies(cube(), count=1)])
    configuration(box=Box(3, 3), bodies=[Bodies(square(), count=1)])


@pytest.mark.parametrize(
    ("strain", "rate", "timestep", "steps"),
    [(20.0, 0.05, 0.005, 80_000), (1.0, -0.3, 0.01, 334), (0.3, 0.1, 0.1, 30), (1e-9, 1.0, 0.1, 1)],
)
def test_steps_from_strain(strain: float, rate: float, timestep: float, steps: int) -> None:
    run = Run(timestep=timestep, strain=strain)
    assert configuration(flow=Couette(shear_rate=rate), run=run).steps == steps


@pytest.mark.parametrize(
    ("steps", "series", "frames"), [(3, 3, 1), (1000, 10, 10), (500_000, 10, 5000), (500_001, 11, 5000)]
)
def test_intervals_if_not_given(steps: int, series: int, frames: int) -> None:
    chosen = configuration(run=Run(timestep=0.005, steps=steps))
    assert chosen.series_interval == series
    assert chosen.frame_interval == Interval(steps=frames)
    output = chosen.resolved().output
    assert (output.series, output.frames, output.checkpoint) == (
        series,
        Interval(steps=frames),
        Interval(seconds=60),
    )


def test_plain_fluid() -> None:
    suspension = configuration(bodies=[Bodies(cube(), count=5)], flow=Couette(shear_rate=0.1))
    assert suspension.plain_fluid() == configuration(flow=Couette(shear_rate=0.1))
    assert suspension.volume_fraction == 40 / 4040


VALIDATOR = jsonschema.Draft202012Validator(json_schema())

# Round trip: whatever can be built can be written and read back.

sizes = st.floats(1e-3, 1e3)
counts = st.integers(1, 10**6)
coordinates = st.integers(-4, 4).map(lambda n: n * 0.1)


@st.composite
def body_kinds(draw: st.DrawFn, dimension: int) -> Bodies:
    flat = {"triangle", "square", "polygon", "points"}
    shape = draw(st.sampled_from(sorted(flat if dimension == 2 else {"octahedron", "cube", "points"})))
    keys: dict[str, object] = {"stiffness": draw(st.floats(1, 1e4)), "mass": draw(st.floats(1, 10))}
    if shape == "points":
        sites = st.tuples(*[coordinates] * dimension)
        keys["points"] = draw(st.lists(sites, min_size=2, max_size=6, unique=True))
    else:
        keys["spacing"] = draw(st.floats(0.01, 0.5))
    if shape == "polygon":
        keys["sides"] = draw(st.integers(3, 8))
    base = draw(st.sampled_from(["massless", "newton-euler", "newton-euler-lagged"]))
    if base != "massless" and draw(st.booleans()):
        keys["torque_arms"] = draw(st.sampled_from(["constituents", "sites"]))
    if draw(st.booleans()):
        keys["count"] = draw(st.integers(1, 1000))
    else:
        keys["volume_fraction"] = draw(st.floats(0.05, 0.2))
    return Bodies(shape, base=base, **keys)


@st.composite
def intervals(draw: st.DrawFn) -> Interval:
    return Interval(seconds=draw(sizes)) if draw(st.booleans()) else Interval(steps=draw(counts))


@st.composite
def configurations(draw: st.DrawFn) -> Configuration:
    dimension = draw(st.sampled_from([2, 3]))
    amplitude = draw(st.sampled_from(["noise", "friction"]))
    sheared = draw(st.booleans())
    rate = draw(st.one_of(st.floats(-10, -1e-6), st.floats(1e-6, 10)))
    steps = draw(counts)
    length = {"strain": draw(sizes)} if sheared and draw(st.booleans()) else {"steps": steps}
    optional = st.one_of(st.none(), sizes)
    return Configuration(
        seed=draw(st.integers(0, 2**63 - 1)),
        box=Box(*draw(st.lists(st.floats(12, 50), min_size=dimension, max_size=dimension))),
        fluid=Fluid(
            density=draw(st.floats(0.5, 10)),
            repulsion=draw(st.one_of(st.just(0.0), sizes)),
            temperature=draw(sizes),
            exponent=draw(st.floats(0.1, 4)),
            cutoff=draw(st.floats(0.5, 2)),
            mass=draw(sizes),
            random=draw(st.sampled_from(["uniform", "gaussian"])),
            **{amplitude: draw(st.one_of(st.just(0.0), sizes))},
        ),
        bodies=draw(st.lists(body_kinds(dimension), max_size=3)),
        flow=Couette(shear_rate=rate) if sheared else Rest(),
        run=Run(
            timestep=draw(st.floats(1e-5, 1e-2)),
            equilibration=draw(counts),
            verlet_lambda=draw(st.floats(0, 1).filter(lambda x: x == 0 or x > 1e-30)),
            **length,
        ),
        start=Start(
            bodies=draw(st.sampled_from(["lattice", "random"])),
            file=draw(st.one_of(st.none(), st.text(min_size=1).map(lambda name: "/" + name))),
            frame=draw(st.integers(-10, 10)),
            gentle_steps=draw(counts),
        ),
        output=Output(
            checkpoint=draw(intervals()),
            frames=draw(st.one_of(st.none(), intervals())),
            series=draw(st.one_of(st.none(), st.just(1))),
            fields=draw(st.lists(st.sampled_from(["velocity", "mass", "body"]), unique=True)),
        ),
        reference=Reference(radius=draw(optional), viscosity=draw(optional)),
    )


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("round trip") / "config.toml"


@given(original=configurations())
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_round_trip(path: Path, original: Configuration) -> None:
    text = original.to_toml()
    path.write_text(text, encoding="utf-8", newline="")
    again = load(path)
    assert again == original.resolved()
    assert again.to_toml() == text
    assert original.body_counts == again.body_counts
    VALIDATOR.validate(tomllib.loads(text))


# The schema and the template


def test_schema_is_one_and_is_json() -> None:
    schema = json.loads(json.dumps(json_schema()))
    jsonschema.Draft202012Validator.check_schema(schema)
    assert "null" not in json.dumps(schema)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("temperature", "temprature"),
        ("temperature = 1.0", "temperature = 0.0"),
        ("temperature = 1.0", 'temperature = "1.0"'),
        ('kind = "couette"', ""),
        ('"cube"', '"cubes"'),
        ("[box]", "[crate]"),
        ("steps = 20000", "steps = 2.5"),
        ("{ seconds = 60 }", "true"),
    ],
)
def test_schema_refuses(couette: str, old: str, new: str) -> None:
    VALIDATOR.validate(tomllib.loads(couette))
    with pytest.raises(jsonschema.ValidationError):
        VALIDATOR.validate(tomllib.loads(couette.replace(old, new)))


def test_every_key_is_documented() -> None:
    schema = json_schema()
    tables = [schema, *schema["$defs"].values()]
    assert len(tables) == 11
    for table in tables:
        for name, key in table["properties"].items():
            assert re.fullmatch(r"[A-Z][^\n]+\.", key["description"]), name
            if key.get("type") == "number" and name != "kind":
                assert re.search(r"in units of|pure number|seconds of", key["description"], re.IGNORECASE), name


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("flow", ["couette", "rest"])
def test_template_is_valid_as_it_is(tmp_path: Path, flow: str, dimension: int) -> None:
    path = tmp_path / "new.toml"
    path.write_text(template(flow, dimension))
    made = load(path)
    assert (made.flow.kind, made.dimension) == (flow, dimension)
    assert made.volume_fraction == (0.2 if dimension == 3 else 400 / 2000)
    assert max(map(len, path.read_text().splitlines())) <= 110


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("flow", ["couette", "rest"])
def test_template_names_every_key_and_its_comments_are_valid_too(tmp_path: Path, flow: str, dimension: int) -> None:
    text = re.sub(r"^# (?=\[|\w+ = )", "", template(flow, dimension), flags=re.MULTILINE)
    path = tmp_path / "new.toml"
    path.write_text(text)
    load(path)
    written = tomllib.loads(text)
    left_out = {"start": {"gentle_steps"}}
    for table, model in [("start", Start), ("output", Output), ("reference", Reference), ("fluid", Fluid)]:
        missing = set(model.model_fields) - set(written[table]) - left_out.get(table, set())
        assert missing <= {"friction"}, table


@pytest.mark.parametrize(("flow", "dimension"), [("poiseuille", 3), ("couette", 4)])
def test_template_of_nothing(flow: str, dimension: int) -> None:
    with pytest.raises(InputError):
        template(flow, dimension)


def test_amplitudes() -> None:
    given_noise = Fluid(temperature=0.5, noise=3.0)
    assert given_noise.gamma == 9.0
    assert math.isclose(Fluid(temperature=0.5, friction=9.0).sigma, 3.0)
    assert Fluid(temperature=2.0).noise == 3.0
    assert Fluid(temperature=2.0, friction=0).sigma == 0
