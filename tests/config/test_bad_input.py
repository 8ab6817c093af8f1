"""Every kind of bad file: one sentence with file, line, key, reason and remedy."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tether.config import load
from tether.errors import InputError

# what stands in the file, what is written instead, the line that is named, the problem, a part of the remedy
SPOILED = [
    # keys
    (
        "temperature",
        "temprature",
        10,
        "fluid.temprature is not a key of [fluid]",
        "did you mean temperature?",
    ),
    ("temperature", "kT", 10, "fluid.kT is not a key of [fluid]", "did you mean temperature?"),
    ("timestep", "dt", 26, "run.dt is not a key of [run]", "did you mean timestep?"),
    (
        "shear_rate",
        "rate",
        23,
        'flow.rate is not a key of [flow] of kind "couette"',
        "did you mean shear_rate?",
    ),
    ("count", "cuont", 17, "bodies.0.cuont is not a key of [[bodies]]", "did you mean count?"),
    (
        "seconds",
        "second",
        31,
        "output.checkpoint.second is not a key of [output.checkpoint]",
        "mean seconds?",
    ),
    ("seed = 1", "sede = 1", 1, "sede is not a key of the top level", "did you mean seed?"),
    ("seed = 1", "temperature = 1", 1, "temperature is not a key of the top level", "belongs in [fluid]"),
    ("cutoff = 1.0", "shear_rate = 1", 12, "fluid.shear_rate is not a key of [fluid]", "belongs in [flow]"),
    ("equilibration = 4000", "seed = 4", 27, "run.seed is not a key of [run]", "above the first [table]"),
    (
        "exponent = 0.5",
        "colour = 5",
        11,
        "fluid.colour is not a key of [fluid]",
        "the keys there are density, ",
    ),
    ("seed = 1", '"a\\nb" = 1', 1, '"a\\nb" is not a key of the top level', "the keys there are"),
    ("[[bodies]]", "[[body]]", 14, "body is not a key of the top level", "did you mean bodies?"),
    ("[run]", "[ruin]", 25, "ruin is not a key of the top level", "did you mean run?"),
    ('"couette"', '"rest"', 23, 'flow.shear_rate is not a key of [flow] of kind "rest"', 'of kind "couette"'),
    # missing ones: the line is the table's
    ("temperature = 1.0", "", 6, "fluid.temperature is missing", "for example temperature = 1.0"),
    ("timestep = 0.005", "", 25, "run.timestep is missing", "for example timestep = 0.005"),
    ("shear_rate = 0.2", "", 21, "flow.shear_rate is missing", "for example shear_rate = 0.05"),
    ('kind = "couette"', "", 21, "flow.kind is missing", 'give "rest", "couette", '),
    ("size = [10.0, 10.0, 10.0]", "", 3, "box.size is missing", "for example size = [20.0, 20.0, 10.0]"),
    ("[box]\nsize = [10.0, 10.0, 10.0]", "", None, "box is missing", "add a table [box] with size"),
    ("count = 125", "", 14, "bodies.0.count is missing, and so is volume_fraction", "exactly one of"),
    ("steps = 20000", "", 25, "run.steps is missing, and so is strain", "exactly one of steps and strain"),
    ("{ seconds = 60 }", "{}", 31, "output.checkpoint.seconds is missing, and so is steps", "exactly one of"),
    # two that exclude each other
    (
        "noise = 3.0",
        "noise = 3.0\nfriction = 4.5",
        10,
        "fluid.friction = 4.5 is given beside noise",
        "one of",
    ),
    (
        "count = 125",
        "count = 1\nvolume_fraction = 0.1",
        18,
        "bodies.0.volume_fraction = 0.1 is given",
        "one of",
    ),
    (
        "steps = 20000",
        "strain = 2\nsteps = 20",
        28,
        "run.strain = 2.0 is given beside steps",
        "exactly one of",
    ),
    ("seconds = 60", "seconds = 60, steps = 1", 31, "output.checkpoint.steps = 1 is given beside", "one of"),
    # types
    (
        "temperature = 1.0",
        'temperature = "1.0"',
        10,
        'fluid.temperature = "1.0" is text, not a number',
        "write 1.0",
    ),
    ("temperature = 1.0", 'temperature = "nan"', 10, 'fluid.temperature = "nan" is text', "for example"),
    (
        "temperature = 1.0",
        "temperature = true",
        10,
        "fluid.temperature = true is true or false",
        "for example",
    ),
    (
        "temperature = 1.0",
        "temperature = [1]",
        10,
        "fluid.temperature = [1] is a list, not a number",
        "example",
    ),
    (
        "temperature = 1.0",
        "temperature = 1979-05-27",
        10,
        "fluid.temperature = 1979-05-27 is a date",
        "example",
    ),
    (
        "temperature = 1.0",
        "temperature = {}",
        10,
        "fluid.temperature = {} is a table, not a number",
        "example",
    ),
    ("temperature = 1.0", "temperature = 1" + 400 * "0", 10, "fluid.temperature = 1000", "a smaller number"),
    ("steps = 20000", "steps = 2e4", 28, "run.steps = 20000.0 is not a whole number to TOML", "write 20000"),
    ("steps = 20000", "steps = 1.5", 28, "run.steps = 1.5 is a decimal number, not a whole", "example"),
    ("steps = 20000", 'steps = "9"', 28, 'run.steps = "9" is text, not a whole number', "write 9 without"),
    ("steps = 20000", "steps = true", 28, "run.steps = true is true or false, not a whole", "example"),
    ("seed = 1", "seed = 1.0", 1, "seed = 1.0 is not a whole number to TOML", "write 1"),
    ("[10.0, 10.0, 10.0]", "10", 4, "box.size = 10 is a whole number, not a list", "a list in brackets"),
    ("[10.0, 10.0, 10.0]", "[10, 'a', 9]", 4, 'box.size.1 = "a" is text, not a number', "give a number"),
    ("[10.0, 10.0, 10.0]", "[10]", 4, "box.size = [10] has 1 item", "give at least 2"),
    ("[10.0, 10.0, 10.0]", "[10, 9, 8, 7]", 4, "box.size = [10, 9, 8, 7] has 4 items", "give at most 3"),
    ('"cube"', "3", 15, "bodies.0.shape = 3 is none of the values there are", '"triangle", "square", '),
    ("[[bodies]]", "[bodies]", 14, "bodies = {", "write [[bodies]], with two brackets"),
    ("[fluid]", "[[fluid]]", 6, "fluid = [{", "write [fluid] and its keys"),
    (
        'kind = "couette"',
        "kind = 3",
        22,
        "flow.kind = 3 is none of the kinds there are",
        'give "rest", "couette", ',
    ),
    (
        "{ seconds = 60 }",
        '"60 s"',
        31,
        'output.checkpoint = "60 s" is text',
        "checkpoint = {seconds = 60.0}",
    ),
    ("{ seconds = 60 }", "true", 31, "output.checkpoint = true is true or false", "{seconds = 60.0}"),
    # ranges
    (
        "temperature = 1.0",
        "temperature = -1.0",
        10,
        "fluid.temperature = -1.0 must be greater than 0",
        "than 0",
    ),
    ("temperature = 1.0", "temperature = 0", 10, "fluid.temperature = 0 must be greater than 0", "example"),
    (
        "temperature = 1.0",
        "temperature = nan",
        10,
        "fluid.temperature = nan is not a finite number",
        "finite",
    ),
    ("temperature = 1.0", "temperature = -inf", 10, "fluid.temperature = -inf is not a finite", "finite"),
    ("temperature = 1.0", "temperature = 1e300", 10, "fluid.temperature = 1e+300 is absurdly large", "1e30"),
    ("cutoff = 1.0", "cutoff = 1e-300", 12, "fluid.cutoff = 1e-300 is absurdly small", "1e-30"),
    ("density = 4.0", "density = 0.0", 7, "fluid.density = 0.0 must be greater than 0", "example"),
    ("repulsion = 18.75", "repulsion = -1", 8, "fluid.repulsion = -1 must be at least 0", "0 or more"),
    ("noise = 3.0", "noise = -3.0", 9, "fluid.noise = -3.0 must be at least 0", "0 or more"),
    ("exponent = 0.5", "exponent = 0", 11, "fluid.exponent = 0 must be greater than 0", "example"),
    ("[10.0, 10.0, 10.0]", "[10, -10, 10]", 4, "box.size.1 = -10 must be greater than 0", "than 0"),
    ("count = 125", "count = 0", 17, "bodies.0.count = 0 must be at least 1", "give 1 or more"),
    (
        "count = 125",
        "volume_fraction = 20",
        17,
        "bodies.0.volume_fraction = 20 must be less than 1",
        "than 1",
    ),
    ("timestep = 0.005", "timestep = -0.005", 26, "run.timestep = -0.005 must be greater than 0", "example"),
    ("steps = 20000", "steps = 0", 28, "run.steps = 0 must be at least 1", "give 1 or more"),
    ("equilibration = 4000", "equilibration = -1", 27, "run.equilibration = -1 must be at least 0", "0 or"),
    ("seed = 1", "seed = -1", 1, "seed = -1 must be at least 0", "give 0 or more"),
    ("seed = 1", f"seed = {2**63}", 1, f"seed = {2**63} must be at most {2**63 - 1}", "or less"),
    ("{ seconds = 60 }", "0", 31, "output.checkpoint.steps = 0 must be at least 1", "1 or more"),
    ("shear_rate = 0.2", "shear_rate = 0", 23, "flow.shear_rate = 0 does not shear", 'of kind "rest"'),
    # words
    ('"cube"', '"cubes"', 15, 'bodies.0.shape = "cubes" is none of the values', 'did you mean "cube"?'),
    ('"massless"', '"newton-eular"', 18, 'bodies.0.base = "newton-eular" is none', 'mean "newton-euler"?'),
    ('"couette"', '"coutte"', 22, 'flow.kind = "coutte" is none of the kinds', 'did you mean "couette"?'),
    (
        "checkpoint =",
        'fields = ["speed"]\nframes =',
        31,
        'output.fields.0 = "speed" is none',
        '"velocity", "mass"',
    ),
    (
        "checkpoint =",
        'fields = ["mass", "mass"]\nframes =',
        31,
        'output.fields.1 = "mass" is there',
        "take it",
    ),
    ("[output]", '[start]\nfile = ""\n[output]', 31, 'start.file = "" is empty', "or leave it out"),
    # keys of one body that do not go together
    ('"cube"', '"cube"\nsides = 4', 16, 'bodies.0.sides does not go with shape = "cube"', "take it out, or"),
    ('"cube"', '"polygon"', 14, "bodies.0.sides is missing", "for example sides = 6"),
    ('"cube"', '"points"\npoints = [[0, 0, 0], [1, 0, 0]]', 17, "bodies.0.spacing = 0.25 does not go", "out"),
    (
        '"massless"',
        '"massless"\ntorque_arms = "sites"',
        19,
        "bodies.0.torque_arms does not go with",
        "take it",
    ),
    # tables that do not go together
    (
        "[10.0, 10.0, 10.0]",
        "[10, 2.5, 10]",
        4,
        "box.size = [10.0, 2.5, 10.0] has a side of 2.5",
        "at least 3",
    ),
    (
        "[10.0, 10.0, 10.0]",
        "[10, 10]",
        15,
        'bodies.0.shape = "cube" has 3 dimensions and the box has 2',
        '"square"',
    ),
    (
        '"cube"',
        '"square"',
        15,
        'bodies.0.shape = "square" has 2 dimensions and the box has 3',
        '"octahedron", ',
    ),
    ("spacing = 0.25", "spacing = 3", 16, "bodies.0.spacing makes a body of diameter 5.2", "over 11.43"),
    ("timestep = 0.005", "timestep = 0.04", 26, "run.timestep = 0.04 is too long for springs", "try 0.009"),
    (
        "stiffness = 3000.0",
        "stiffness = 3e5",
        26,
        "run.timestep = 0.005 is too long for springs",
        "try 0.0009",
    ),
    (
        "count = 125",
        "volume_fraction = 1e-5",
        17,
        "bodies.0.volume_fraction = 1e-05 is less than half",
        "count = 1",
    ),
    (
        "count = 125",
        "volume_fraction = 0.9999999999",
        17,
        "bodies.0.volume_fraction = 0.9999999999 leaves",
        "smaller",
    ),
    ("[10.0, 10.0, 10.0]", "[1e5, 1e5, 10]", 4, "box.size asks for 4e+11 particles", "smaller box"),
    ("[10.0, 10.0, 10.0]", "[1e30, 1e30, 10]", 4, "box.size asks for over 1e18 particles", "smaller box"),
    (
        "count = 125",
        "count = 1000000000",
        14,
        "bodies asks for 8e+09 particles",
        "smaller box, density or count",
    ),
    (
        "checkpoint =",
        "series = 30000\ncheckpoint =",
        31,
        "output.series = 30000 is more than the 20000",
        "fewer",
    ),
    (
        "steps = 20000",
        "strain = 1e20",
        28,
        "run.strain = 1e+20 takes more than 1e+15 steps",
        "smaller strain",
    ),
    # no TOML
    ("seed = 1", "seed", 1, '"seed" is not TOML', "write [table] or key = value"),
    ('"cube"', "cube", 15, '"shape = cube" is not TOML', "put text in quotation marks"),
    (
        "temperature = 1.0",
        "temperature = .5",
        10,
        '"temperature = .5" is not TOML',
        "both sides of a decimal point",
    ),
    (
        "temperature = 1.0",
        "temperature = 5.",
        10,
        '"temperature = 5." is not TOML',
        "both sides of a decimal point",
    ),
    ("seed = 1", "seed = 1\nseed = 2", 2, '"seed = 2" is not TOML', "each key and each table once"),
    ("[run]", "[fluid]", 25, '"[fluid]" is not TOML', "each key and each table once"),
    ("[run]", "[run", 25, '"[run" is not TOML', "write [table] or key = value"),
    ("seed = 1", "seed = 1" + 5000 * "0", None, "a number has thousands of digits", "shorten it"),
    (
        "seed = 1",
        "seed = " + 9000 * "[" + 9000 * "]",
        None,
        "the lists or tables are nested too deeply",
        "write them flat",
    ),
]


@pytest.mark.parametrize(("old", "new", "line", "problem", "remedy"), SPOILED)
def test_one_sentence(
    folder: Path, couette: str, old: str, new: str, line: int | None, problem: str, remedy: str
) -> None:
    assert old in couette
    (folder / "couette.toml").write_text(couette.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        load("couette.toml")
    sentence = str(caught.value)
    place = "couette.toml" if line is None else f"couette.toml, line {line}"
    assert sentence.startswith(f"{place}: {problem}")
    assert remedy in sentence.rpartition("; ")[2]
    assert re.fullmatch(r"[^\n]+ \(.+\); [^\n]+", sentence)
    assert len(sentence) < 400
    assert "more error" not in sentence
    assert caught.value.exit_code == 2


def test_several_errors_name_the_first_line_and_count_the_others(folder: Path, couette: str) -> None:
    text = couette.replace("timestep = 0.005", "timestep = -1").replace("steps = 20000", "steps = 1.5")
    (folder / "couette.toml").write_text(text)
    with pytest.raises(InputError, match=r"line 26: run\.timestep = -1 .* \(and 1 more error\)$"):
        load("couette.toml")
    (folder / "couette.toml").write_text(text.replace("temperature", "temprature"))
    with pytest.raises(InputError, match=r"line 10: fluid\.temprature .* \(and 2 more errors\)$"):
        load("couette.toml")


def test_a_refused_item_does_not_make_its_list_too_short(folder: Path, couette: str) -> None:
    (folder / "couette.toml").write_text(couette.replace("[10.0, 10.0, 10.0]", "[true, '1']"))
    with pytest.raises(InputError, match=r"box\.size\.0 = true .* \(and 1 more error\)$"):
        load("couette.toml")


POINTS = [
    ("[[0, 0, 0], [1]]", "bodies.0.points.1 = [1] has 1 item"),
    ("[[0, 0, 0]]", "bodies.0.points = [[0, 0, 0]] has 1 item"),
    ("[[0, 0, 0], [1, 2]]", "bodies.0.points is not a table of numbers"),
    ("[[0, 0, 0], [0, 0, 0], [1, 0, 0]]", "bodies.0.points puts sites 0 and 1 in one place"),
    ("[[0, 0, 0], [1e200, 0, 0]]", "bodies.0.points has a number that is not finite or absurdly large"),
    ("[[0, 0], [1, 0]]", "bodies.0.points has sites of 2 numbers and the box has 3 dimensions"),
    ("[[0, 0, 0], [9, 0, 0]]", "bodies.0.points makes a body of diameter 9, too large"),
    ("3", "bodies.0.points = 3 is a whole number, not a list"),
]


@pytest.mark.parametrize(("points", "problem"), POINTS)
def test_points(folder: Path, couette: str, points: str, problem: str) -> None:
    text = couette.replace('"cube"\nspacing = 0.25', f'"points"\npoints = {points}')
    (folder / "couette.toml").write_text(text)
    with pytest.raises(InputError) as caught:
        load("couette.toml")
    assert str(caught.value).startswith(f"couette.toml, line 16: {problem}")


# what stands instead of the table of bodies, the line that is named, the problem, a part of the remedy
BODIES = [
    ('shape = "disc"', 14, "bodies.0.radius is missing (shape", "for example radius = 1.0"),
    ('shape = "rod"', 14, "bodies.0.length is missing (shape", "for example length = 1.0"),
    ('shape = "ellipsoid"', 14, "bodies.0.semiaxes is missing (shape", "for example semiaxes = [1.0, 0.5, 0.5]"),
    ('shape = "cube"\nradius = 1', 16, "bodies.0.radius does not go with", 'or give shape = "disc" or "sphere"'),
    ('shape = "sphere"\nlength = 1\nradius = 1', 16, "bodies.0.length does not go with", 'give shape = "rod"'),
    ('shape = "sphere"\nradius = 0.2', 16, "bodies.0.radius = 0.2 is shorter than the spacing", "a smaller spacing"),
    ('shape = "sphere"\nradius = 1.5', 16, "bodies.0.radius = 1.5 makes 1163 sites", "a larger spacing"),
    ('shape = "sphere"\nradius = 1e9', 16, "bodies.0.radius = 1000000000.0 makes 2.68", "a smaller body"),
    ('shape = "sphere"\nradius = 2.4\nspacing = 0.6', 16, "bodies.0.radius makes a body of diameter 4.8", "smaller"),
    ('shape = "disc"\nradius = 1', 15, 'bodies.0.shape = "disc" has 2 dimensions', '"cube" or "sphere"'),
    ('shape = "rod"\nlength = 300', 16, "bodies.0.length = 300.0 makes 1200 sites", "a smaller body"),
    ('shape = "rod"\nlength = 1e99', 16, "bodies.0.length = 1e+99 is absurdly large", "to 1e30"),
    ('shape = "rod"\nlength = 8', 16, "bodies.0.length makes a body of diameter 8", "over 17.6"),
    ('shape = "ellipsoid"\nsemiaxes = [1, 0.1, 1]', 16, "bodies.0.semiaxes = 0.1 is shorter than", "a smaller spacing"),
    ('shape = "ellipsoid"\nsemiaxes = [1, 0, 1]', 16, "bodies.0.semiaxes.1 = 0 must be greater than 0", "than 0"),
    ('shape = "ellipsoid"\nsemiaxes = [1, 0.5]', 16, "bodies.0.semiaxes has 2 numbers and the box", "give 3 numbers"),
    ('shape = "ellipsoid"\nsemiaxes = [1]', 16, "bodies.0.semiaxes = [1] has 1 item", "give at least 2"),
    ('model = "rigid"\nstiffness = 1e5', 16, 'bodies.0.stiffness does not go with model = "rigid"', "take it out"),
    ('model = "rigid"\nbase = "massless"', 16, 'bodies.0.base does not go with model = "rigid"', "take it out"),
    ('model = "stiff"', 15, 'bodies.0.model = "stiff" is none of the values', '"tethered", "rigid" or "single"'),
    ('model = "single"', 14, 'bodies.0.radius is missing (model = "single"', "for example radius = 1.0"),
    ('model = "single"\nradius = 1\nshape = "cube"', 17, 'bodies.0.shape does not go with model = "single"', "out"),
    ('model = "single"\nradius = 1\nstiffness = 9', 17, "bodies.0.stiffness does not go with model", "out"),
    ('model = "single"\nradius = 1\neffective_radius = 1', 17, "bodies.0.effective_radius does not go", "out"),
    ('model = "single"\nradius = 3', 16, "bodies.0.radius makes a body of diameter 6", "sides of box.size over 13.2"),
    ("effective_radius = 5", 16, "bodies.0.count = 2 makes bodies of a volume of 1047", "fewer or smaller"),
    ("effective_radius = 0", 15, "bodies.0.effective_radius = 0 must be greater than 0", "than 0"),
    ('name = "solvent"', 15, 'bodies.0.name = "solvent" is taken', "give the bodies another name"),
    ('name = ""', 15, 'bodies.0.name = "" is empty', "or leave it out"),
    ('name = "a\\nb"', 15, "bodies.0.name is no plain word", "at most 60 letters"),
    ('name = "a/b"', 15, "bodies.0.name is no plain word", "at most 60 letters"),
    ('name = "bodies"', 15, 'bodies.0.name = "bodies" could be taken for another result', "give another one"),
    (
        'name = "two"\ncount = 1\n[[bodies]]\nname = "two"',
        18,
        'bodies.1.name = "two" is the name of bodies.0',
        "of its own",
    ),
    ('name = "cube"\ncount = 1\n[[bodies]]', 15, 'bodies.0.name = "cube" is the name of bodies.1', "of its own"),
]


@pytest.mark.parametrize(("table", "line", "problem", "remedy"), BODIES)
def test_bodies(folder: Path, couette: str, table: str, line: int, problem: str, remedy: str) -> None:
    before, after = couette.split("[[bodies]]")[0], couette.split("stiffness = 3000.0\n")[1]
    (folder / "couette.toml").write_text(f"{before}[[bodies]]\n{table}\ncount = 2\n{after}")
    with pytest.raises(InputError) as caught:
        load("couette.toml")
    sentence = str(caught.value)
    assert sentence.startswith(f"couette.toml, line {line}: {problem}")
    assert remedy in sentence.rpartition("; ")[2]
    assert re.fullmatch(r"[^\n]+ \(.+\); [^\n]+", sentence)
    assert "more error" not in sentence


# the keys of one [[interactions]] table, the problem, a part of the remedy
INTERACTIONS = [
    ('between = ["solvent", "cubes"]', 'interactions.0.between.1 = "cubes" is no species', 'did you mean "cube"?'),
    ('between = ["solvent", "x"]', 'interactions.0.between.1 = "x" is no species', 'give "solvent" or "cube"'),
    ('between = ["solvent"]', 'interactions.0.between = ["solvent"] has 1 item', "give at least 2"),
    ('between = "solvent"', 'interactions.0.between = "solvent" is text, not a list', "a list in brackets"),
    ("cutoff = 1", "interactions.0.between is missing", 'for example between = ["solvent", "colloid"]'),
    ('between = ["cube", "cube"]\nsteepness = 2', "interactions.0.steepness does not go with law", "take it out, or"),
    ('between = ["cube", "cube"]\nlaw = "exponential"', "interactions.0.steepness is missing", "steepness = 20.0"),
    ('between = ["cube", "cube"]\nlaw = "steep"', 'interactions.0.law = "steep" is none', '"linear" or "exponential"'),
    (
        'between = ["cube", "cube"]\ncutoff = 4',
        "box.size = [10.0, 10.0, 10.0] has a side",
        "smaller interactions.0.cutoff",
    ),
    (
        'between = ["cube", "cube"]\nfriction = 1\nnoise = 1',
        "interactions.0.noise = 1.0 is given beside friction",
        "give one of them, or neither",
    ),
    (
        'between = ["cube", "solvent"]\n[[interactions]]\nbetween = ["solvent", "cube"]',
        'interactions.1.between = ["solvent", "cube"] is there already (interactions.0 is',
        "take one of them out",
    ),
]


@pytest.mark.parametrize(("keys", "problem", "remedy"), INTERACTIONS)
def test_interactions(folder: Path, couette: str, keys: str, problem: str, remedy: str) -> None:
    (folder / "couette.toml").write_text(f"{couette}[[interactions]]\n{keys}\n")
    with pytest.raises(InputError) as caught:
        load("couette.toml")
    sentence = str(caught.value)
    assert sentence.partition(": ")[2].startswith(problem)
    assert remedy in sentence.rpartition("; ")[2]
    assert re.fullmatch(r"[^\n]+ \(.+\); [^\n]+", sentence)
    assert "more error" not in sentence


def test_strain_at_rest(folder: Path, couette: str) -> None:
    text = couette.replace('"couette"\nshear_rate = 0.2', '"rest"').replace("steps = 20000", "strain = 2")
    (folder / "couette.toml").write_text(text)
    with pytest.raises(InputError, match=r"line 27: run\.strain = 2\.0 needs a flow that shears steadily \("):
        load("couette.toml")


def test_a_stage_shorter_than_a_step(folder: Path, couette: str) -> None:
    stages = '"stages"\nstages = [{ shear_rate = 0.0, duration = 1.0 }, { shear_rate = 0.2, duration = 0.002 }]'
    (folder / "couette.toml").write_text(couette.replace('"couette"\nshear_rate = 0.2', stages))
    with pytest.raises(InputError, match=r"line 23: flow\.stages\.1\.duration = 0\.002 is less than half a step \("):
        load("couette.toml")


def test_no_particle_at_all(folder: Path, couette: str) -> None:
    text = couette.replace("density = 4.0", "density = 1e-9").replace("[[bodies]]", "[[bodies]]\nmass = 2")
    (folder / "couette.toml").write_text(text)
    assert load("couette.toml").solvent_count == 0  # bodies alone are fine
    with pytest.raises(InputError, match=r"line 7: fluid\.density makes no particle in this box"):
        load("couette.toml", ["bodies=[]"])


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "c.toml: box is missing (the periodic box); add a table [box] with size (and 2 more errors)"),
        (
            b"a = 1\n\n# \xff",
            "c.toml, line 3: this is not UTF-8 text (TOML files are); save the file as UTF-8, or ",
        ),
        ("seed = 1".encode("utf-16"), "c.toml, line 1: this is not UTF-8 text (TOML files are); save"),
        (b"\x00", 'c.toml, line 1: "\\u0000" is not TOML (invalid statement); write [table] or '),
        (b"a = [\n1,\n\n", "c.toml, line 2: "),
    ],
)
def test_hardly_a_file(folder: Path, content: bytes, sentence: str) -> None:
    (folder / "c.toml").write_bytes(content)
    with pytest.raises(InputError) as caught:
        load("c.toml")
    assert str(caught.value).startswith(sentence)


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        ("none.toml", "none.toml cannot be read (no such file or directory); look at the path"),
        (".", ". cannot be read (is a directory); look at the path"),
        ("a\0b", '"a\\u0000b" cannot be read (embedded null byte); look at the path'),
    ],
)
def test_no_file(path: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        load(path)
    assert str(caught.value).startswith(sentence)


def test_byte_order_mark_and_windows_line_ends_are_read(folder: Path, couette: str) -> None:
    (folder / "windows.toml").write_bytes(b"\xef\xbb\xbf" + couette.replace("\n", "\r\n").encode())
    assert load("windows.toml") == load("couette.toml")
    text = couette.replace("temperature = 1.0", "temperature = -1").replace("\n", "\r\n")
    (folder / "windows.toml").write_bytes(b"\xef\xbb\xbf" + text.encode())
    with pytest.raises(InputError, match=r"windows\.toml, line 10: fluid\.temperature = -1 must"):
        load("windows.toml")
