"""When two runs are the same, and that no two others share a seed."""

from __future__ import annotations

import pytest
from small_runs import COUETTE
from small_studies import study

from tether.config import Configuration, load
from tether.study.identity import identity, seed_of


def configuration(tmp_path, *changes):
    text = COUETTE
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path = tmp_path / "couette.toml"
    path.write_text(text)
    return load(path)


SAME = [
    ("temperature = 1.0", "temperature = 1"),
    ("temperature = 1.0", "temperature = 1.0\nrepulsion = 18.75\nnoise = 3.0\nexponent = 0.5"),
    ("size = [4.0, 4.0]", "size = [4, 4]"),
    ("timestep = 0.005", "timestep = 5e-3"),
    ('shape = "square"', 'shape = "square"\nmodel = "tethered"\nspacing = 0.25'),
    ("steps = 200", "steps = 200\n[start]\ngentle_steps = 200"),
    ("steps = 200", "steps = 200\n[output]\ncheckpoint = 100"),
    ("steps = 200", "steps = 200\n[output]\ncheckpoint = {seconds = 5.0}\nframes = 10"),
    ("steps = 200", 'steps = 200\n[output]\nfields = ["velocity", "body"]'),
    ("seed = 7", "# a comment\nseed = 7"),
]


@pytest.mark.parametrize(("old", "new"), SAME)
def test_files_that_mean_the_same_make_the_same_run(tmp_path, old: str, new: str) -> None:
    assert identity(configuration(tmp_path, (old, new))) == identity(configuration(tmp_path))
    assert seed_of(configuration(tmp_path, (old, new)), 3) == seed_of(configuration(tmp_path), 3)


def test_every_default_may_be_written_out(tmp_path) -> None:
    asked = configuration(tmp_path)
    assert identity(Configuration.model_validate(asked.model_dump())) == identity(asked)


OTHERS = [
    ("seed = 7", "seed = 8"),
    ("size = [4.0, 4.0]", "size = [4.0, 4.5]"),
    ("size = [4.0, 4.0]", "size = [4.5, 4.0]"),
    ("temperature = 1.0", "temperature = 2.0"),
    ("temperature = 1.0", "temperature = 1.0\ndensity = 3.0"),
    ("temperature = 1.0", "temperature = 1.0\nrepulsion = 20.0"),
    ("temperature = 1.0", "temperature = 1.0\nnoise = 2.0"),
    ("temperature = 1.0", "temperature = 1.0\nfriction = 2.0"),
    ("temperature = 1.0", "temperature = 1.0\nexponent = 1.0"),
    ("temperature = 1.0", "temperature = 1.0\ncutoff = 0.9"),
    ("temperature = 1.0", "temperature = 1.0\nmass = 2.0"),
    ("temperature = 1.0", 'temperature = 1.0\nrandom = "gaussian"'),
    ('shape = "square"', 'shape = "triangle"'),
    ('shape = "square"', 'shape = "square"\nspacing = 0.2'),
    ('shape = "square"', 'shape = "square"\nstiffness = 2000.0'),
    ('shape = "square"', 'shape = "square"\nmass = 2.0'),
    ('shape = "square"', 'shape = "square"\nmodel = "rigid"'),
    ('[[bodies]]\nshape = "square"', '[[bodies]]\nmodel = "single"\nradius = 0.4'),
    ("count = 3", "count = 2"),
    ("count = 3", 'count = 2\n[[bodies]]\nshape = "square"\ncount = 1'),
    ('[[bodies]]\nshape = "square"\ncount = 3\n', ""),
    ("shear_rate = 0.5", "shear_rate = -0.5"),
    ('kind = "couette"\nshear_rate = 0.5', 'kind = "rest"'),
    ('kind = "couette"\nshear_rate = 0.5', 'kind = "poiseuille"\nforce = 0.5'),
    ('kind = "couette"\nshear_rate = 0.5', 'kind = "kolmogorov"\nforce = 0.5'),
    ("timestep = 0.005", "timestep = 0.004"),
    ("equilibration = 40", "equilibration = 41"),
    ("\nsteps = 200", "\nsteps = 201"),
    ("\nsteps = 200", "\nstrain = 0.5"),
    ("timestep = 0.005", "timestep = 0.005\nverlet_lambda = 0.65"),
    ("timestep = 0.005", 'timestep = 0.005\nengine = "reference"'),
    ("timestep = 0.005", 'timestep = 0.005\nprecision = "double"'),
    ("\nsteps = 200", '\nsteps = 200\n[start]\nbodies = "random"'),
    ("\nsteps = 200", "\nsteps = 200\n[start]\ngentle_steps = 100"),
    ("\nsteps = 200", "\nsteps = 200\n[output]\nseries = 2"),
    ("\nsteps = 200", "\nsteps = 200\n[measure]\nstop_when = {viscosity = 0.1}"),
    ("\nsteps = 200", "\nsteps = 200\n[measure]\nradial_distribution = {range = 1.2}"),
    ("\nsteps = 200", "\nsteps = 200\n[measure]\nstop_when = {pressure = 0.1}"),
]


def test_whatever_changes_the_results_makes_another_run(tmp_path) -> None:
    changed = [configuration(tmp_path, change) for change in OTHERS]
    names = [identity(each) for each in [configuration(tmp_path), *changed]]
    twice = [OTHERS[number - 1] for number, name in enumerate(names) if name in names[:number]]
    assert not twice


def test_a_key_counts_where_it_stands(tmp_path) -> None:
    """The same words and numbers in another order of bodies are another system: their sites are numbered otherwise."""
    one, other = 'shape = "square"\ncount = 1', 'shape = "triangle"\ncount = 2'
    old = 'shape = "square"\ncount = 3'
    names = {
        identity(configuration(tmp_path, (old, f"{first}\n[[bodies]]\n{second}")))
        for first, second in [(one, other), (other, one)]
    }
    assert len(names) == 2


def test_names_and_seeds_are_those_of_earlier_versions(tmp_path) -> None:
    """Recorded: folders of earlier studies are found again, and their runs gone on with."""
    asked = configuration(tmp_path)
    assert identity(asked) == "a6c320a61c0862a2"
    assert [seed_of(asked, repeat) for repeat in range(2)] == [279080286289643, 72146037631028]


MANY = """\
base = "couette.toml"
repeats = {repeats}
relative = true
[sweep]
flow.shear_rate = {{logspace = [0.1, 1.0, {rates}]}}
bodies.0.count = [{counts}]
"""


def test_no_two_runs_of_a_study_share_a_seed_or_a_name(tmp_path) -> None:
    points = study(tmp_path, MANY.format(repeats=20, rates=4, counts="1, 2, 3")).points
    assert len(points) == 20 * (4 * 3 + 4)
    assert len({point.configuration.seed for point in points}) == len(points)
    assert len({point.identity for point in points}) == len(points)
    assert all(len(point.identity) == 16 for point in points)


def test_runs_stay_what_they_are_when_a_study_grows(tmp_path) -> None:
    small = study(tmp_path, MANY.format(repeats=2, rates=2, counts="2"))
    large = study(tmp_path, MANY.format(repeats=3, rates=3, counts="3, 2"))
    before = {point.label: (point.identity, point.configuration.seed) for point in small.points}
    after = {point.label: (point.identity, point.configuration.seed) for point in large.points}
    assert {label: after[label] for label in before} == before
    assert len(after) == 3 * (3 * 2 + 3)


def test_another_seed_of_the_base_makes_all_runs_anew(tmp_path) -> None:
    text = MANY.format(repeats=2, rates=2, counts="2")
    one = study(tmp_path, text)
    other = study(tmp_path, text.replace("[sweep]", "[set]\nseed = 8\n[sweep]"))
    assert not {p.identity for p in one.points} & {p.identity for p in other.points}
    assert not {p.configuration.seed for p in one.points} & {p.configuration.seed for p in other.points}
