"""The same bits for any number of threads, any splitting of a run, on every instruction set, and through a copy of the
state; and faults.
"""

from __future__ import annotations

import hashlib
import math

import numpy as np
import pytest
from suspensions import Kind, crooked, cube, engine, rod, square, suspension

from tether import _core


def digest(made):
    """SHA-256 of the whole state."""
    found = hashlib.sha256()
    for array in (made.order, made.position, made.velocity, made.force, made.bases):
        found.update(array.tobytes())
    found.update(f"{made.step} {made.offset.hex()}".encode())
    return found.hexdigest()


CASES = {
    "2D fluid": {"size": [7.0, 6.0]},
    "2D fluid, sheared": {"size": [7.0, 6.0], "shear_rate": 0.8},
    "2D, two kinds of bodies": {
        "size": [8.0, 7.0],
        "kinds": (Kind(square, 9), Kind(2.0 * square, 3)),
        "shear_rate": -0.8,
    },
    "3D fluid": {"size": [5.0, 4.0, 4.0], "random": "gaussian"},
    "3D fluid, sheared": {"size": [5.0, 5.0, 4.0], "shear_rate": 0.8, "exponent": 1.3},
    "3D, two kinds of bodies": {"size": [6.0, 6.0, 6.0], "kinds": (Kind(cube, 40), Kind(rod, 20)), "shear_rate": 0.8},
    "3D, Newton-Euler": {"size": [5.0, 5.0, 5.0], "kinds": (Kind(crooked, 12, "newton-euler"),), "shear_rate": 0.8},
    "3D, Newton-Euler, lagged": {"size": [5.0, 5.0, 5.0], "kinds": (Kind(crooked, 12, "newton-euler-lagged"),)},
    "Groot-Warren 0.65": {"size": [7.0, 6.0], "verlet_lambda": 0.65, "kinds": (Kind(square, 9),)},
}


PRECISIONS = ["mixed", "double"]


def ready(case, precision, **options):
    return suspension(**CASES[case], seed=21, timestep=0.005, gentle_steps=50, precision=precision, **options)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("case", CASES)
def test_same_bits_for_any_number_of_threads(case, precision):
    """Gentle start, plain steps and measured steps."""
    digests, samples = set(), set()
    for threads in (1, 2, 3):
        made = ready(case, precision, threads=threads)
        assert made.threads == threads
        made.run(30)
        samples.add(made.run(30, 10).tobytes())
        digests.add(digest(made))
    assert len(digests) == len(samples) == 1


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("case", CASES)
def test_same_bits_on_every_instruction_set(case, precision):
    """Gentle start, plain steps and measured steps, on all that this processor has."""
    digests, samples = set(), set()
    for name in [name for name, is_here in _core.instruction_sets() if is_here]:
        made = ready(case, precision, instruction_set=name)
        assert made.instruction_set == name
        made.run(30)
        samples.add(made.run(30, 10).tobytes())
        digests.add(digest(made))
    assert len(digests) == len(samples) == 1


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("case", CASES)
def test_same_bits_for_any_splitting_of_a_run(case, precision):
    """Measuring changes nothing either."""
    whole, parts, watched = (ready(case, precision) for _ in range(3))
    whole.run(60)
    for steps in (1, 0, 7, 22, 30):
        parts.run(steps)
    watched.run(60, 5)
    assert digest(whole) == digest(parts) == digest(watched)


STATE = ("order", "position", "velocity", "force", "bases", "step", "offset")


def copied(made, case, precision, names=STATE):
    """A new engine that is given these parts of a state."""
    options = dict(CASES[case])
    copy = engine(options.pop("size"), made.species, seed=21, timestep=0.005, precision=precision, **options)
    for name in names:
        setattr(copy, name, getattr(made, name))
    return copy


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("case", CASES)
def test_same_bits_through_a_copy_of_the_state(case, precision):
    """Order in memory, positions, velocities, forces, bases, step and offset are all there is: a new engine goes on in
    the same bits, measurements included.
    """
    made = ready(case, precision)
    made.run(31)
    copy = copied(made, case, precision)
    assert digest(copy) == digest(made)
    samples = [one.run(30, 10).tobytes() for one in (made, copy)]
    assert samples[0] == samples[1]
    assert digest(copy) == digest(made)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("case", CASES)
def test_order_in_memory_is_nothing_to_the_motion(case, precision):
    """The control: a copy without the order that particles have in memory, which changes at every 16th step, moves in
    the same bits; forces are sums of integers. What is measured is a sum over particles, whose last bits may differ.
    """
    made = ready(case, precision)
    made.run(31)
    copy = copied(made, case, precision, STATE[1:])
    assert not np.array_equal(copy.order, made.order)
    samples = [one.run(30, 10) for one in (made, copy)]
    for name in STATE[1:]:
        assert np.array_equal(getattr(copy, name), getattr(made, name)), name
    scale = np.abs(samples[0]).max()
    assert np.abs(samples[0] - samples[1]).max() < (1e-7 if precision == "mixed" else 1e-14) * scale


def test_seed_changes_the_noise():
    """The control of the three tests above: another seed is another run from the same start."""
    digests = set()
    for seed in (1, 2):
        made = engine([4.0, 4.0], [0] * 64, seed=seed)
        generator = np.random.default_rng(1)
        made.position, made.velocity = generator.random((64, 2)) * 4.0, generator.standard_normal((64, 2))
        made.place()
        made.run(1)
        digests.add(digest(made))
    assert len(digests) == 2


@pytest.mark.parametrize("dimension", [2, 3])
def test_noise_counts_steps_and_not_calls(dimension):
    """The noise of a step depends on its number: from step 1000 on another path than from step 0."""
    ends = []
    for step in (0, 1000, 2**40):
        made = suspension([4.0] * dimension, seed=2, timestep=0.005)
        made.step = step
        made.place()
        made.run(5)
        assert made.step == step + 5
        ends.append(made.velocity)
    assert np.abs(ends[0] - ends[1]).min() > 0.0
    assert np.abs(ends[1] - ends[2]).min() > 0.0


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("dimension", [2, 3])
def test_absurd_time_step_is_a_fault_with_its_step(dimension, threads):
    """It stops at once, says at which step and which particle, and does not go on."""
    made = suspension([4.0] * dimension, timestep=0.8, gentle_steps=0, seed=1, threads=threads)
    assert made.fault is None
    made.run(10_000)
    step, particle, speed = made.fault
    assert 1 <= step < 100
    assert made.step == step
    assert 0 <= particle < len(made.position)
    assert not speed <= 0.5 / 0.8  # too fast, or not a number
    first = made.fault
    made.run(10)
    assert (made.fault, made.step) == (first, step)


def test_velocity_that_is_not_a_number_is_a_fault():
    made = suspension([4.0, 4.0])
    velocity = made.velocity
    velocity[17, 1] = math.nan
    made.velocity = velocity
    made.run(5)
    step, particle, speed = made.fault
    assert (step, particle) == (1, 17)
    assert math.isnan(speed)


def test_arrays_of_the_wrong_shape_are_refused():
    made = engine([4.0, 4.0], [0] * 5, kinds=())
    for name in ("position", "velocity", "force"):
        with pytest.raises(ValueError, match="row for each particle"):
            setattr(made, name, np.zeros((4, 2)))
        with pytest.raises(ValueError, match=r"\(n, 2\)"):
            setattr(made, name, np.zeros((5, 3)))
    with pytest.raises(ValueError, match="for each body"):
        made.bases = np.zeros((1, 10))
    with pytest.raises(ValueError, match="multiple of interval"):
        made.run(10, 3)
