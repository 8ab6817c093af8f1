"""Laws of their own for each pair of species, with different reaches, linear and steep: every engine has the forces and
stresses of the equations, and the same bits on every processor.
"""

from __future__ import annotations

import hashlib
import math

import numpy as np
import pytest
from suspensions import engine, law_table, limit, mean_and_error, measured, scattered, species_forces

from tether import _core

ENGINES = {
    "mixed": {"pairs": "packed", "precision": "mixed"},
    "double": {"pairs": "packed", "precision": "double"},
    "reference": {"pairs": "reference"},
}
PACKED = ["mixed", "double"]
FLOWS = [(0.0, 0.0), (0.8, 3.21), (-0.8, 4.4), (0.0, 2.5)]
SIZES = [(4.9, 5.4), (4.4, 5.0, 4.7)]
MASSES = (1.0, 2.5, 0.7)

# Repulsion, friction, cutoff and steepness of each pair of species: reaches of 0.6, 1.0 and 1.4, three repulsions that
# are steep, one that is nothing, one friction that is nothing.
LAWS = law_table(
    [
        [(18.75, 4.5, 1.0, 0.0), (30.0, 3.0, 1.4, 20.0), (0.0, 6.0, 0.6, 0.0)],
        [(30.0, 3.0, 1.4, 20.0), (60.0, 1.0, 0.6, 5.0), (12.0, 2.0, 1.0, 0.0)],
        [(0.0, 6.0, 0.6, 0.0), (12.0, 2.0, 1.0, 0.0), (40.0, 0.0, 1.4, 90.0)],
    ],
    temperature=0.8,
)


def mixture(size, density=4.0, *, places="anywhere", seed=5, step=17, offset=0.0, shear_rate=0.0, **options):
    """As many of each species, in the order of ids 0...0 1...1 2...2, at random, thermal about the imposed profile."""
    generator = np.random.default_rng(seed)
    count = round(density * math.prod(size) / 3.0)
    species = np.repeat(np.arange(3, dtype=np.uint8), count)
    options = {"laws": LAWS, "timestep": 0.004, "seed": seed, "species_mass": MASSES} | options
    made = engine(list(size), species, shear_rate=shear_rate, **options)
    position = scattered(generator, places, len(species), size, 1.0)
    position = position[generator.permutation(len(position))]
    mass = np.array(MASSES)[species][:, None]
    velocity = generator.standard_normal(position.shape) * np.sqrt(0.8 / mass)
    velocity -= (mass * velocity).sum(axis=0) / mass.sum()
    velocity[:, 0] += shear_rate * (position[:, 1] - 0.5 * size[1])
    made.position, made.velocity, made.offset, made.step = position, velocity, offset, step
    made.place()
    return made


def plain(made, velocity, size, shear_rate, **options):
    """Forces and stresses of an engine's particles by the equations, with these velocities."""
    return species_forces(
        LAWS,
        made.species,
        made.position,
        velocity,
        size,
        timestep=0.004,
        seed=5,
        step=made.step,
        shear_rate=shear_rate,
        offset=made.offset,
        **options,
    )


# Forces and stresses


@pytest.mark.parametrize("which", ENGINES)
@pytest.mark.parametrize(("exponent", "random"), [(0.5, "uniform"), (2.0, "gaussian"), (1.3, "uniform")])
@pytest.mark.parametrize(("shear_rate", "offset"), FLOWS)
@pytest.mark.parametrize("size", SIZES, ids=["2D", "3D"])
def test_forces_and_stresses_are_those_of_the_equations(which, size, shear_rate, offset, exponent, random):
    """Against the plain NumPy writing: in double to rounding, in mixed precision to 3e-5 of the largest force; and the
    three terms of the stress after a step. The control: with two species taken for each other nothing agrees.
    """
    options = {"exponent": exponent, "random": random}
    density = 4.0 if len(size) == 2 else 1.5
    made = mixture(size, density, shear_rate=shear_rate, offset=offset, **options, **ENGINES[which])
    for moved in (False, True):
        velocity = made.velocity
        if moved:  # forces are those of the velocity at half a step
            named = measured(made, made.run(1, 1))
            mass = np.array(MASSES)[made.species][:, None]
            velocity = made.velocity - 0.5 * 0.004 * made.force / mass
        force, stress = plain(made, velocity, size, shear_rate, **options)
        bar = (3e-5 if which == "mixed" else 3e-13) * np.abs(force).max()
        assert np.abs(made.force - force).max() < bar
        if moved:
            found = np.stack([named[f"stress_{term}"][0] for term in ("conservative", "dissipative", "random")])
            assert np.abs(found - stress).max() < bar / 10.0
    wrong, _ = species_forces(
        LAWS[[0, 2, 1]][:, [0, 2, 1]],
        made.species,
        made.position,
        velocity,
        size,
        timestep=0.004,
        seed=5,
        step=made.step,
        shear_rate=shear_rate,
        offset=made.offset,
        **options,
    )
    assert np.abs(made.force - wrong).max() > 1.0


@pytest.mark.parametrize(
    ("which", "places"),
    [
        ("mixed", "anywhere"),
        ("mixed", "clumps"),
        *[("double", each) for each in ("anywhere", "clumps", "faces", "points")],
    ],
)
@pytest.mark.parametrize(("size", "shear_rate", "offset"), [((12.3, 9.8), 0.8, 3.3), ((6.1, 5.2, 7.0), -0.8, 2.2)])
def test_forces_of_a_thousand_agree_with_the_reference(which, places, size, shear_rate, offset):
    """Wherever they are: in places that are awkward for the pair loops too, where many pairs stand at a cutoff; with
    s = 2 no force jumps there. (In mixed precision particles that are a rounding apart are on one point.)
    """
    made, reference = (
        mixture(size, 5.0, places=places, shear_rate=shear_rate, offset=offset, exponent=2.0, **ENGINES[each])
        for each in (which, "reference")
    )
    found, wanted = made.force, reference.force
    assert np.abs(found - wanted).max() < (1e-5 if which == "mixed" else 1e-12) * max(100.0, np.abs(wanted).max())


@pytest.mark.parametrize("which", PACKED)
@pytest.mark.parametrize("size", SIZES, ids=["2D", "3D"])
def test_forces_of_all_pairs_sum_up_to_nothing(which, size):
    """Exactly, being multiples of one quantum; and so the momentum of a run stays, to the rounding of velocities. The
    control: in the reference they do not.
    """
    made = mixture(size, shear_rate=0.8, offset=1.0, **ENGINES[which])
    assert [math.fsum(column) for column in made.force.T] == [0.0] * len(size)
    control = mixture(size, shear_rate=0.8, offset=1.0, **ENGINES["reference"])
    assert any(math.fsum(column) != 0.0 for column in control.force.T)
    momentum = measured(made, made.run(200, 1))["momentum"]
    assert np.abs(momentum - momentum[0]).max() < 1e-12 * len(made.position)


@pytest.mark.parametrize("which", ENGINES)
@pytest.mark.parametrize("species", [1, 2, 5])
@pytest.mark.parametrize("steepness", [0.0, 20.0])
def test_a_table_of_equals_is_one_law(which, species, steepness):
    """Forces to rounding, whatever number of species; of linear laws, those of the engine without a table."""
    law = (18.75, 4.5, 1.0, steepness)
    generator = np.random.default_rng(3)
    size, count = [4.4, 5.1, 3.9], 300
    position, velocity = generator.random((count, 3)) * size, generator.standard_normal((count, 3))
    found = []
    for kinds, table in ((1, None if steepness == 0.0 else [[law]]), (species, [[law] * species] * species)):
        laws = None if table is None else law_table(table)
        made = engine(size, np.arange(count) * kinds // count, laws=laws, species_mass=[1.0] * 5, **ENGINES[which])
        made.position, made.velocity = position, velocity
        made.place()
        found.append(made.force)
    largest = np.abs(found[0]).max()
    assert largest > 50.0
    assert np.abs(found[1] - found[0]).max() < (1e-6 if which == "mixed" else 1e-14) * largest


@pytest.mark.parametrize("which", ENGINES)
def test_nothing_at_or_beyond_the_pairs_own_cutoff(which):
    """Of each pair of species; just below it what has noise feels it. In mixed precision a distance is known to 2^-32
    sides and rounded to float.
    """
    below = 1e-6 if which == "mixed" else 1e-15
    for i in range(3):
        for j in range(3):
            cutoff, has_noise = LAWS[i, j, 3], bool(LAWS[i, j, 2] > 0.0)
            pair = engine([6.0, 6.0], [i, j], laws=LAWS, species_mass=MASSES, seed=4, **ENGINES[which])
            pair.velocity = np.array([[0.3, 0.2], [-0.1, 0.4]])
            for distance, is_felt in ((cutoff * (1.0 - below), has_noise), (cutoff * (1.0 + below), False)):
                pair.position = np.array([[distance, 0.0], [0.0, 0.0]])
                pair.place()
                assert bool(np.abs(pair.force).max() > 1e-20) is is_felt, (i, j, distance)


# Bits


def digest(made):
    found = hashlib.sha256()
    for array in (made.order, made.position, made.velocity, made.force):
        found.update(array.tobytes())
    return found.hexdigest()


@pytest.mark.parametrize("precision", PACKED)
@pytest.mark.parametrize(("size", "exponent"), [((9.0, 8.0), 0.5), ((6.0, 5.0, 5.0), 2.0), ((5.0, 6.0, 5.0), 1.3)])
def test_same_bits_on_every_instruction_set_with_any_threads(precision, size, exponent):
    """And for any splitting of a run. The control: another precision has other bits."""

    def run(precision, parts=(40,), **options):
        made = mixture(size, shear_rate=0.8, precision=precision, exponent=exponent, timestep=0.002, **options)
        for steps in parts:
            made.run(steps)
        samples = made.run(20, 5)
        return digest(made), samples.tobytes()

    here = [name for name, is_here in _core.instruction_sets() if is_here]
    found = {run(precision, instruction_set=name) for name in here}
    found |= {run(precision, threads=threads) for threads in (2, 3)}
    found.add(run(precision, parts=(1, 0, 7, 32)))
    assert len(found) == 1
    assert run(PACKED[1 - PACKED.index(precision)]) not in found


# Equilibrium


def test_every_species_has_the_temperature_of_the_noise():
    """kT = 0.8 of each of three species, which differ in mass and in the friction of every pair: each pair's noise is
    that of its own friction. False-alarm rate 1e-4 over the three; half a percent is left to the time step. The
    control: the noise of one pair raised by a tenth is noticed.
    """

    def temperatures(laws):
        made = mixture((7.0, 7.0), laws=laws, timestep=0.004)
        made.run(1000)
        mass = np.array(MASSES)[made.species]
        found = []
        for _ in range(1500):
            made.run(5)
            velocity = made.velocity
            mean = (mass[:, None] * velocity).sum(axis=0) / mass.sum()
            energy = mass * np.sum((velocity - mean) ** 2, axis=1)
            share = [1.0 - mass[made.species == k][0] / mass.sum() for k in range(3)]
            found.append([energy[made.species == k].mean() / (2.0 * share[k]) for k in range(3)])
        return [mean_and_error(np.array(series)) for series in np.transpose(found)]

    bar = limit(1e-4, comparisons=3)
    for value, error in temperatures(LAWS):
        assert error < 0.016
        assert abs(value - 0.8) < bar * error + 0.004
    louder = LAWS.copy()
    louder[0, 1, 2] = louder[1, 0, 2] = 1.1 * LAWS[0, 1, 2]
    assert any(abs(value - 0.8) > bar * error + 0.004 for value, error in temperatures(louder))


# What the core refuses


@pytest.mark.parametrize("column", range(5), ids=["repulsion", "friction", "noise", "cutoff", "steepness"])
def test_a_table_that_is_not_symmetric_is_refused(column):
    """Whichever number it is in: which of two laws a pair got would depend on the order of particles in memory."""
    laws = LAWS.copy()
    laws[0, 1, column] *= 1.1
    with pytest.raises(ValueError, match="symmetric"):
        engine([6.0, 6.0], [0, 1, 2], laws=laws, species_mass=MASSES)


@pytest.mark.parametrize("shape", [(0, 0, 5), (3, 2, 5), (2, 3, 5), (3, 3, 4)])
def test_a_table_of_another_shape_is_refused(shape):
    with pytest.raises(ValueError, match="species, species, 5"):
        engine([6.0, 6.0], [0], laws=np.ones(shape))


def test_a_species_without_law_or_mass_is_refused():
    """Else the pair loop and the masses are read from beyond their tables."""
    with pytest.raises(ValueError, match="species"):
        engine([6.0, 6.0], [0, 3], laws=LAWS, species_mass=[1.0] * 4)
    with pytest.raises(ValueError, match="species"):
        engine([6.0, 6.0], [0, 2], laws=LAWS, species_mass=[1.0] * 2)
