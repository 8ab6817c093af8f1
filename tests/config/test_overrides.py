"""What --set and --seed change."""

from __future__ import annotations

from pathlib import Path

import pytest

from tether.config import Source, load
from tether.errors import InputError, RunError
from tether.flows import Couette

pytestmark = pytest.mark.usefixtures("folder")


def test_values_are_toml_or_words() -> None:
    changes = [
        "flow.shear_rate=-0.1",
        "bodies.0.base=newton-euler",
        'bodies.0.torque_arms="sites"',
        "output.fields=['mass', 'body']",
        "run.equilibration = 7",
        "box.size.0=20",
        "start.bodies=random",
    ]
    changed = load("couette.toml", changes)
    assert changed.flow == Couette(shear_rate=-0.1)
    assert changed.bodies[0].base == "newton-euler"
    assert changed.bodies[0].torque_arms == "sites"
    assert changed.output.fields == ("mass", "body")
    assert changed.run.equilibration == 7
    assert changed.box.size == (20, 10, 10)
    assert changed.start.bodies == "random"


def test_the_later_override_holds() -> None:
    assert load("couette.toml", ["run.steps=5", "run.steps=6"]).steps == 6


def test_whole_tables() -> None:
    plain = load("couette.toml", ["bodies=[]", 'flow={kind="rest"}'])
    assert (plain.bodies, plain.flow.shear_rate) == ((), 0)


def test_seed() -> None:
    assert load("couette.toml", ["seed=3"]).seed == 3
    assert load("couette.toml", ["seed=3"], seed=4).seed == 4
    with pytest.raises(InputError, match=r"^--seed -4: seed = -4 must be at least 0"):
        load("couette.toml", seed=-4)


def test_one_of_two_exclusive_keys_replaces_the_other() -> None:
    changed = load("couette.toml", ["fluid.friction=4.5", "run.strain=2", "bodies.0.volume_fraction=0.2"])
    assert (changed.fluid.noise, changed.fluid.friction) == (None, 4.5)
    assert (changed.run.steps, changed.run.strain, changed.steps) == (None, 2, 2000)
    assert (changed.bodies[0].count, changed.body_counts) == (None, (125,))
    assert load("couette.toml", ["output.checkpoint.steps=9"]).output.checkpoint.steps == 9


def test_a_value_that_excludes_keys_takes_them_out(folder: Path, couette: str) -> None:
    rigid = load("couette.toml", ["bodies.0.model=rigid"]).bodies[0]
    assert (rigid.model, rigid.shape, rigid.base, rigid.stiffness) == ("rigid", "cube", None, None)
    single = load("couette.toml", ["bodies.0.model=single", "bodies.0.radius=0.5"]).bodies[0]
    assert (single.model, single.shape, single.spacing, single.radius) == ("single", None, None, 0.5)
    with pytest.raises(InputError, match=r"^--set bodies.0.base=massless: bodies\.0\.base does not go with model"):
        load("couette.toml", ["bodies.0.model=rigid", "bodies.0.base=massless"])
    law = '[[interactions]]\nbetween = ["solvent", "cube"]\nlaw = "exponential"\nsteepness = 20\nfriction = 3.0\n'
    (folder / "steep.toml").write_text(couette + law)
    changed = load("steep.toml", ["interactions.0.law=linear", "interactions.0.noise=2"]).interactions[0]
    assert (changed.law, changed.steepness, changed.friction, changed.noise) == ("linear", None, None, 2.0)


def test_two_exclusive_overrides_are_an_error() -> None:
    with pytest.raises(InputError, match=r"^--set run.strain=2: run\.strain = 2\.0 is given beside steps"):
        load("couette.toml", ["run.strain=2", "run.steps=3"])


@pytest.mark.parametrize(
    ("override", "sentence"),
    [
        ("fluid.temperature=-1", "fluid.temperature = -1 must be greater than 0 (thermal energy kT"),
        ("fluid.temprature=1", "fluid.temprature is not a key of [fluid] (keys are checked"),
        (
            "run.timestep=.005",
            'run.timestep = ".005" is text, not a number (time step dt, in units of time); write 0.005',
        ),
        ("flow=rest", 'flow = "rest" is text, not a table (the flow); write [flow]'),
        ("bodies.1.count=1", "bodies.1 does not exist (there are 1, numbered from 0); give"),
        ("bodies.first.count=1", "bodies.first does not exist (there are 1, numbered from 0); give"),
        ("bodies.0=3", "bodies.0 = 3 is a whole number, not a table (the suspended bodies"),
        ("seed.x=1", "seed.x cannot be set (seed is no table); set seed as a whole"),
        (
            "output.fields=[mass]",
            "the value '[mass]' is not TOML (invalid value); put text in quotation marks",
        ),
        ("seed=", "the value '' is not TOML (nothing follows the =); put"),
        ("seed", "this is not of the form section.key=value (the key says what to change); write --set flow"),
        ("=1", "this is not of the form section.key=value (the key says what to change); write --set flow"),
        ("fluid..mass=1", "this is not of the form section.key=value (the key says what to change); write"),
    ],
)
def test_a_bad_override_is_named(override: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        load("couette.toml", [override])
    assert str(caught.value).startswith(f"--set {override}: {sentence}")


def test_an_override_cannot_smuggle_in_a_second_key() -> None:
    with pytest.raises(InputError, match=r'^--set "seed=1\\nfoo=2": there is more than one value'):
        load("couette.toml", ["seed=1\nfoo=2"])


def test_no_bodies_to_number() -> None:
    with pytest.raises(InputError, match=r"bodies\.0 does not exist \(there are none\)"):
        load("couette.toml", ["bodies=[]", "bodies.0.count=1"])


def test_an_override_next_to_a_bad_line_is_not_blamed(folder: Path, couette: str) -> None:
    (folder / "couette.toml").write_text(couette.replace("density = 4.0", "density = -4"))
    with pytest.raises(InputError, match=r"^couette\.toml, line 7: fluid\.density = -4"):
        load("couette.toml", ["fluid.temperature=2"])


def test_start_file_is_relative_to_the_configuration_or_to_the_shell(folder: Path, couette: str) -> None:
    (folder / "runs").mkdir()
    (folder / "runs" / "a.toml").write_text(couette + '[start]\nfile = "old.gsd"\n')
    assert load("runs/a.toml").start.file == str(folder / "runs" / "old.gsd")
    assert load("runs/a.toml", ["start.file=new.gsd"]).start.file == str(folder / "new.gsd")
    assert load("runs/a.toml", ["start.file=/data/new.gsd"]).start.file == "/data/new.gsd"


def test_later_errors_get_the_place_of_their_key() -> None:
    source = Source.read("couette.toml", ["run.timestep=0.02"])
    crowded = InputError("too many bodies", "no room", "give fewer", key=("bodies", 0, "count"))
    assert str(source.located(crowded)) == "couette.toml, line 17: too many bodies (no room); give fewer"
    exploded = RunError("blew up", "", "try 0.01", key=("run", "timestep"))
    assert str(source.located(exploded)) == "--set run.timestep=0.02: blew up; try 0.01"
    assert isinstance(source.located(exploded), RunError)
    unplaced = RunError("disk full")
    assert source.located(unplaced) is unplaced
