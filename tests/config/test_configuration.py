"""The configuration as a whole: numbers made from others, the resolved file, the schema, the template."""

from __future__ import annotations

import json
import math
import re
import tomllib
from pathlib import Path

import jsonschema
import numpy as np
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
from tether.interactions import Interaction
from tether.shapes import cube, disc, ellipsoid, octahedron, rod, sphere, square


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


# Models of a suspended particle


def test_only_tethered_bodies_have_springs() -> None:
    tethered = Bodies(cube(), count=1)
    assert (tethered.base, tethered.stiffness, tethered.torque_arms, tethered.mass) == ("massless", 3000.0, None, 1.0)
    for keys in ({"shape": cube(), "model": "rigid"}, {"model": "single", "radius": 0.5}):
        of_other = Bodies(count=1, **keys)
        assert (of_other.base, of_other.stiffness, of_other.torque_arms) == (None, None, None)
        text = configuration(bodies=[of_other]).to_toml()
        assert not {"base", "stiffness", "torque_arms"} & set(tomllib.loads(text)["bodies"][0])
    # A default that was filled in is none of the given keys.
    assert tethered.changed(model="rigid") == Bodies(cube(), count=1, model="rigid")
    newton_euler = Bodies(cube(), count=1, base="newton-euler")
    assert newton_euler.torque_arms == "constituents"
    assert newton_euler.changed(base="massless") == tethered


def test_only_tethered_bodies_limit_the_timestep() -> None:
    slow = Run(timestep=0.1, steps=10)
    with pytest.raises(InputError, match=r"run\.timestep = 0\.1 is too long for springs of stiffness 3000 and mass 1 "):
        configuration(bodies=[Bodies(cube(), count=1)], run=slow)
    configuration(bodies=[Bodies(cube(), count=1, model="rigid")], run=slow)
    configuration(bodies=[Bodies(model="single", radius=0.5, count=1)], run=slow)
    # light constituents of a neutrally buoyant sphere: 4 * 4/3 pi 0.5^3 / 55 sites
    mass = 4 * 4 / 3 * math.pi * 0.125 / 55
    limit = 2 * math.sqrt(mass / 3000)
    configuration(bodies=[Bodies(sphere(0.5), count=1)], run=Run(timestep=0.999 * limit, steps=10))
    with pytest.raises(InputError, match=r"run\.timestep = .* and mass 0\.0380799 "):
        configuration(bodies=[Bodies(sphere(0.5), count=1)], run=Run(timestep=1.001 * limit, steps=10))


def test_a_single_particle_is_in_the_box_s_dimension() -> None:
    for box in (Box(9, 9), Box(9, 9, 9)):
        kinds = [Bodies(model="single", radius=0.5, count=3), Bodies(rod(1.0), count=2)]
        single, line = configuration(box=box, bodies=kinds).geometries
        assert np.array_equal(single.sites, np.zeros((1, box.dimension)))
        assert line.sites.shape == (5, box.dimension)
        assert np.array_equal(line.sites[:, 0], [-0.5, -0.25, 0, 0.25, 0.5])
        assert not line.sites[:, 1:].any()


def test_species_names() -> None:
    kinds = [
        Bodies(cube(), count=1),
        Bodies(sphere(0.5), count=1, name="large"),
        Bodies(cube(0.3), count=1),
        Bodies(octahedron(), count=1),
        Bodies(model="single", radius=0.5, count=1),
    ]
    mixed = configuration(bodies=kinds)
    assert mixed.species_names == ("solvent", "cube_1", "large", "cube_2", "octahedron", "single")
    assert configuration().species_names == ("solvent",)


# Masses and volume fractions

DENSE = {"box": Box(10, 10), "fluid": Fluid(temperature=1.0, density=3.0, mass=2.0)}


@pytest.mark.parametrize(
    ("keys", "volume", "sites", "source"),
    [
        ({"shape": disc(1.0)}, math.pi, 64, "effective radius 1 (outermost sites)"),
        ({"shape": disc(1.0), "effective_radius": 1.2}, math.pi * 1.44, 64, "effective radius 1.2 (given)"),
        ({"shape": ellipsoid([1.0, 0.5])}, math.pi / 2, 39, "semiaxes 1, 0.5 (outermost sites)"),
        ({"shape": rod(1.0), "effective_radius": 0.5}, 1.0 + math.pi / 4, 5, "effective radius 0.5 (given)"),
        ({"model": "single", "radius": 0.5}, math.pi / 4, 1, "effective radius 0.5 (given)"),
    ],
)
def test_large_bodies_count_by_volume_and_are_neutrally_buoyant(
    keys: dict[str, object], volume: float, sites: int, source: str
) -> None:
    suspension = configuration(**DENSE, bodies=[Bodies(count=3, **keys)], run=Run(timestep=1e-3, steps=10))
    assert suspension.volume_fraction == pytest.approx(3 * volume / 100, rel=1e-14)
    assert suspension.volume_fraction_sources == (source,)
    assert len(suspension.geometries[0].sites) == sites
    assert suspension.body_masses[0] * sites == pytest.approx(3.0 * 2.0 * volume, rel=1e-14)
    # Neutral buoyancy: the density of mass inside equals the solvent's, so the mass fraction follows from phi (eq. 45).
    phi = suspension.volume_fraction
    assert suspension.mass_fraction == pytest.approx(phi / (phi + 1), rel=1e-14)
    assert suspension.effective_radii[0] == pytest.approx(math.sqrt(volume / math.pi), rel=1e-14)
    assert suspension.resolved().bodies[0].mass == suspension.body_masses[0]
    heavy = configuration(**DENSE, bodies=[Bodies(count=3, mass=5.0, **keys)])
    assert heavy.body_masses == (5.0,)
    assert heavy.volume_fraction == suspension.volume_fraction


@pytest.mark.parametrize("shape", [square(), rod(1.0)])
def test_small_bodies_and_thin_rods_count_by_particles(shape: object) -> None:
    suspension = configuration(**DENSE, bodies=[Bodies(shape, count=30)])
    constituents = 30 * len(shape.sites)
    assert suspension.volume_fraction == suspension.particle_fraction == constituents / (constituents + 300)
    assert suspension.volume_fraction_sources == ("eq. 42",)
    assert suspension.effective_radii == (None,)
    assert suspension.body_masses == (1.0,)
    assert suspension.mass_fraction == constituents / (constituents + 600)


def test_both_rules_at_once() -> None:
    kinds = [
        Bodies(square(), volume_fraction=0.2),
        Bodies(disc(1.0), volume_fraction=0.1),
        Bodies(rod(1.0), count=10),
        Bodies(square(), count=10, effective_radius=0.4),
    ]
    mixed = configuration(box=Box(20, 20), bodies=kinds, run=Run(timestep=1e-3, steps=10))
    squares, discs, rods, large = mixed.body_counts
    # discs take no part in the fraction of the squares: phi = 4 n / (1600 + 4 n + 5 * 10)
    assert squares == round(0.2 * (1600 + 50) / 0.8 / 4)
    assert discs == round(0.1 * 400 / math.pi)
    assert (rods, large) == (10, 10)
    by_particles = (4 * squares + 50) / (1600 + 4 * squares + 50)
    by_volume = (discs * math.pi + 10 * math.pi * 0.16) / 400
    assert mixed.volume_fraction == pytest.approx(by_particles + by_volume, rel=1e-14)
    everything = 4 * squares + 64 * discs + 50 + 40
    assert mixed.particle_fraction == everything / (everything + 1600)
    assert mixed.volume_fraction_sources == (
        "eq. 42",
        "effective radius 1 (outermost sites)",
        "eq. 42",
        "effective radius 0.4 (given)",
    )


@given(phi=st.floats(0.01, 0.4), density=st.floats(1, 6), by=st.sampled_from(["cube", "sphere", "single", "effective"]))
@settings(max_examples=50, deadline=None)
def test_the_number_of_bodies_is_the_nearest_whole_one(phi: float, density: float, by: str) -> None:
    """The fraction that comes out differs from the one asked for by at most half a body, whichever rule holds."""
    keys = {
        "cube": {"shape": "cube"},
        "sphere": {"shape": "sphere", "radius": 0.5},
        "single": {"model": "single", "radius": 0.5},
        "effective": {"shape": "cube", "effective_radius": 0.6},
    }[by]
    made = {"fluid": Fluid(temperature=1.0, density=density), "run": Run(timestep=1e-3, steps=10)}
    suspension = configuration(**made, bodies=[Bodies(volume_fraction=phi, **keys)])
    count = suspension.body_counts[0]
    around = [
        configuration(**made, bodies=[Bodies(count=n, **keys)]).volume_fraction
        for n in (count - 1, count, count + 1)
        if n
    ]
    assert suspension.volume_fraction in around
    assert min(abs(each - phi) for each in around) >= abs(suspension.volume_fraction - phi) * (1 - 1e-9)


# Forces between species


def test_without_interactions_every_pair_has_the_fluid_s_law() -> None:
    pairs = configuration(bodies=[Bodies(cube(), count=1), Bodies(octahedron(), count=1)]).pair_parameters()
    assert pairs.is_uniform
    assert pairs.largest_cutoff == 1.0
    fluid = Fluid(temperature=1.0)
    expected = [
        (pairs.repulsion, 18.75),
        (pairs.steepness, 0.0),
        (pairs.friction, fluid.gamma),
        (pairs.noise, 3.0),
        (pairs.cutoff, 1.0),
    ]
    for table, value in expected:
        assert np.array_equal(table, np.full((3, 3), value))


def test_interactions_change_their_pair_alone() -> None:
    fluid = Fluid(temperature=0.5, friction=4.0)
    kinds = [Bodies(cube(), count=1), Bodies(model="single", radius=0.8, count=1, name="ball")]
    laws = [
        Interaction(
            between=["ball", "solvent"], law="exponential", steepness=20.0, repulsion=200.0, cutoff=1.5, noise=2
        ),
        Interaction(between=("ball", "ball"), cutoff=2.0),
        Interaction(between=("cube", "solvent"), friction=9.0),
    ]
    pairs = configuration(fluid=fluid, bodies=kinds, interactions=laws).pair_parameters()
    assert not pairs.is_uniform
    assert pairs.largest_cutoff == 2.0
    for table in (pairs.repulsion, pairs.steepness, pairs.friction, pairs.noise, pairs.cutoff):
        assert np.array_equal(table, table.T)
    assert np.array_equal(pairs.repulsion, [[18.75, 18.75, 200], [18.75, 18.75, 18.75], [200, 18.75, 18.75]])
    assert np.array_equal(pairs.steepness, [[0, 0, 20], [0, 0, 0], [20, 0, 0]])
    assert np.array_equal(pairs.cutoff, [[1, 1, 1.5], [1, 1, 1], [1.5, 1, 2]])
    np.testing.assert_allclose(pairs.friction, [[4, 9, 4], [9, 4, 4], [4, 4, 4]], rtol=1e-15)
    # fluctuation and dissipation belong together, pair by pair
    np.testing.assert_allclose(pairs.noise**2, 2 * pairs.friction * 0.5, rtol=1e-15)
    # the same law under its own pair is uniform
    same = configuration(interactions=[Interaction(between=("solvent", "solvent"), repulsion=18.75, noise=3.0)])
    assert same.pair_parameters().is_uniform


def test_the_longest_cutoff_makes_the_narrowest_box() -> None:
    far = [Interaction(between=("solvent", "solvent"), cutoff=4.0)]
    with pytest.raises(InputError, match=r"box\.size .* at least 12, or a smaller interactions\.0\.cutoff$"):
        configuration(interactions=far)
    configuration(box=Box(12, 12, 12), interactions=far)


def test_a_plain_fluid_keeps_its_own_interaction() -> None:
    laws = [Interaction(between=("solvent", "cube")), Interaction(between=("solvent", "solvent"), repulsion=20.0)]
    suspension = configuration(bodies=[Bodies(cube(), count=5)], interactions=laws)
    assert suspension.plain_fluid() == configuration(interactions=laws[1:])


VALIDATOR = jsonschema.Draft202012Validator(json_schema())

# Round trip: whatever can be built can be written and read back.

sizes = st.floats(1e-3, 1e3)
counts = st.integers(1, 10**6)
coordinates = st.integers(-4, 4).map(lambda n: n * 0.1)


@st.composite
def body_kinds(draw: st.DrawFn, dimension: int, name: str | None) -> Bodies:
    keys: dict[str, object] = {"name": name} if name else {}
    keys |= draw(st.sampled_from([{"count": 3}, {"count": 40}, {"volume_fraction": 0.05}, {"volume_fraction": 0.2}]))
    keys["model"] = model = draw(st.sampled_from(["tethered", "rigid", "single"]))
    if model != "tethered" and draw(st.booleans()):
        keys["mass"] = draw(st.floats(1, 10))
    if model == "single":
        return Bodies(radius=draw(st.floats(0.2, 0.5)), **keys)
    either = {"points", "rod", "ellipsoid"}
    flat, spatial = {"triangle", "square", "polygon", "disc"}, {"octahedron", "cube", "sphere"}
    shape = draw(st.sampled_from(sorted(either | (flat if dimension == 2 else spatial))))
    if shape == "points":
        sites = st.tuples(*[coordinates] * dimension)
        keys["points"] = draw(st.lists(sites, min_size=2, max_size=6, unique=True))
    else:
        keys["spacing"] = draw(st.floats(0.1, 0.3))
    if shape in ("disc", "sphere"):
        keys["radius"] = draw(st.floats(0.4, 0.6))
    if shape == "ellipsoid":
        keys["semiaxes"] = draw(st.lists(st.floats(0.4, 0.6), min_size=dimension, max_size=dimension))
    if shape == "rod":
        keys["length"] = draw(st.floats(0.4, 2))
    if shape == "polygon":
        keys["sides"] = draw(st.integers(3, 8))
    if draw(st.booleans()):
        keys["effective_radius"] = draw(st.floats(0.2, 0.7))
    if model == "tethered":
        keys |= {"stiffness": draw(st.floats(1, 1e4)), "mass": draw(st.floats(1, 10))}
        keys["base"] = draw(st.sampled_from(["massless", "newton-euler", "newton-euler-lagged"]))
        if keys["base"] != "massless" and draw(st.booleans()):
            keys["torque_arms"] = draw(st.sampled_from(["constituents", "sites"]))
    return Bodies(shape, **keys)


@st.composite
def pair_laws(draw: st.DrawFn, between: tuple[str, str]) -> Interaction:
    keys: dict[str, object] = {}
    if draw(st.booleans()):
        keys |= {"law": "exponential", "steepness": draw(st.floats(0.1, 30))}
    for name, values in [("repulsion", st.one_of(st.just(0.0), sizes)), ("cutoff", st.floats(0.5, 3))]:
        if draw(st.booleans()):
            keys[name] = draw(values)
    if draw(st.booleans()):
        keys[draw(st.sampled_from(["friction", "noise"]))] = draw(st.one_of(st.just(0.0), sizes))
    return Interaction(between=between, **keys)


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
    kinds = draw(st.integers(0, 3))
    pairs = draw(st.sets(st.sampled_from([("solvent", "solvent"), ("solvent", "disc-0"), ("disc-0", "disc-0")])))
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
        bodies=[draw(body_kinds(dimension, "disc-0" if number == 0 else None)) for number in range(kinds)],
        interactions=[draw(pair_laws(pair)) for pair in sorted(pairs) if kinds or "disc-0" not in pair],
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
    assert len(tables) >= 12
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


@pytest.mark.parametrize(("flow", "dimension"), [("vortex", 3), ("couette", 4)])
def test_template_of_nothing(flow: str, dimension: int) -> None:
    with pytest.raises(InputError):
        template(flow, dimension)


def test_amplitudes() -> None:
    given_noise = Fluid(temperature=0.5, noise=3.0)
    assert given_noise.gamma == 9.0
    assert math.isclose(Fluid(temperature=0.5, friction=9.0).sigma, 3.0)
    assert Fluid(temperature=2.0).noise == 3.0
    assert Fluid(temperature=2.0, friction=0).sigma == 0
