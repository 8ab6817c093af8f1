"""Shear whose rate changes in time: the box follows the strain exactly, and every velocity gets the change of the
affine profile at once.
"""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from suspensions import Kind, crooked, crooked_flat, cube, engine, law_table, rod, square, suspension

from tether import _core
from tether.flows import Oscillatory, Stage, Stages

IDEAL = law_table([[(0.0, 0.0, 1.0, 0.0)]])
DT = 0.004
PLAN = [(3, 0.0), (4, 0.8), (1, -2.0), (5, 0.3)]  # steps and rate of each stage
FLOWS = {
    "stages": (
        {"stages": PLAN},
        Stages(stages=tuple(Stage(shear_rate=rate, duration=steps * DT) for steps, rate in PLAN)),
    ),
    "oscillation": (
        {"oscillation": (1.3, 9.0)},
        Oscillatory(strain_amplitude=1.3, angular_frequency=9.0),
    ),
}


def ideal_gas(size, count=200, **flow):
    """Particles without forces, at random, thermal about no profile."""
    generator = np.random.default_rng(3)
    made = engine(size, [0] * count, laws=IDEAL, timestep=DT, **flow)
    made.position = generator.random((count, len(size))) * size
    made.velocity = 4.0 * generator.standard_normal((count, len(size)))
    made.place()
    return made


def rates_of(flow, steps):
    """Of each step, from the strains that the flow says; the first is step 1."""
    return np.diff(flow.strain(np.arange(steps + 1), DT)) / DT


# The box


@pytest.mark.parametrize("kind", FLOWS)
def test_the_box_has_the_strain_of_the_flow(kind):
    """Offset = L_y times the strain, into [0, L_x), at the end of each of 200 steps (stages go round many times); the
    rate is the strain gained in the step over its time.
    """
    options, flow = FLOWS[kind]
    size = [5.0, 6.0]
    made = ideal_gas(size, **options)
    rates = rates_of(flow, 200)
    assert np.ptp(rates) > 1.0
    assert made.shear_rate == pytest.approx(rates[0], abs=1e-13)
    for step in range(1, 201):
        made.run(1)
        apart = made.offset - size[1] * flow.strain(step, DT)
        assert abs(apart - size[0] * np.round(apart / size[0])) < 1e-12
        assert 0.0 <= made.offset < size[0]
        assert made.shear_rate == pytest.approx(rates[step - 1], abs=1e-11)


def test_an_oscillation_comes_back():
    """After whole cycles the box is where it was, and at a quarter of one it has the amplitude."""
    steps = 1000
    omega = 2.0 * np.pi / (steps * DT)
    made = ideal_gas([40.0, 6.0], oscillation=(1.5, omega))
    made.run(steps // 4)
    assert made.offset == pytest.approx(1.5 * 6.0, abs=1e-11)
    made.run(steps // 4)
    assert min(made.offset, 40.0 - made.offset) < 1e-11
    made.run(steps // 4)
    assert made.offset == pytest.approx(40.0 - 1.5 * 6.0, abs=1e-11)


def test_after_the_last_stage_comes_the_first():
    made = ideal_gas([5.0, 6.0], stages=PLAN)
    wanted = [rate for steps, rate in PLAN for _ in range(steps)]
    found = []
    for _ in range(3 * len(wanted)):
        made.run(1)
        found.append(made.shear_rate)
    assert found == 3 * wanted


# Velocities


@pytest.mark.parametrize("kind", FLOWS)
@pytest.mark.parametrize("size", [[5.0, 6.0], [5.0, 6.0, 4.0]], ids=["2D", "3D"])
def test_free_particles_get_the_change_of_the_profile_and_nothing_else(kind, size):
    """An ideal gas over 60 steps: at the beginning of a step v_x grows by the change of the rate times y - L/2, so that
    the velocity against the profile is untouched; then all go straight, and through the boundary as the box says.
    """
    options, flow = FLOWS[kind]
    made = ideal_gas(size, **options)
    position, velocity, rate = made.position, made.velocity, made.shear_rate
    box_of = _core.Box2 if len(size) == 2 else _core.Box3
    crossed = 0
    for step, new in enumerate(rates_of(flow, 60), start=1):
        velocity[:, 0] += (new - rate) * (position[:, 1] - 0.5 * size[1])
        rate = new
        straight = position + DT * velocity
        offset = np.mod(size[1] * flow.strain(step, DT), size[0])
        position, velocity = box_of(size, rate, offset).wrap(straight, velocity)
        crossed += np.count_nonzero(np.abs(position - straight)[:, 1] > 1.0)
        made.run(1)
        apart = made.position - position
        assert np.abs(apart - size * np.round(apart / size)).max() < 1e-11
        assert made.velocity == pytest.approx(velocity, abs=1e-10)
    assert crossed > 10


BODIES = {
    "rigid, 2D": (square, "rigid"),
    "rigid, crooked in 2D": (crooked_flat, "rigid"),
    "rigid, crooked": (crooked, "rigid"),
    "rigid rod": (rod, "rigid"),
    "Newton-Euler base": (crooked, "newton-euler"),
}


@pytest.mark.parametrize("case", BODIES)
@pytest.mark.parametrize("height", [0.4, 2.0, 5.97])
def test_bodies_with_inertia_get_it_too(case, height):
    """Momentum and angular momentum of a body, alone, when the rate goes from r0 to r: those that its constituents get,
    M (r - r0) (Y - L/2) along x and sum m (r - r0) arm x (arm_y, 0, 0); also when the boundary cuts it. Center and base
    are then moved on freely.
    """
    sites, base = BODIES[case]
    dimension, p, mass = sites.shape[1], len(sites), 1.5
    size = [7.0, 6.0, 5.0][:dimension]
    generator = np.random.default_rng(5)
    kinds = (Kind(sites, 1, base, stiffness=1e-12),)
    plan = [(1, 0.4), (1, -0.7)]
    made = engine(size, [1] * p, kinds=kinds, laws=IDEAL, timestep=1e-7, species_mass=(1.0, mass), stages=plan)
    arm = sites @ np.linalg.qr(generator.standard_normal((dimension, dimension)))[0].T if dimension == 3 else sites
    if dimension == 3 and np.linalg.det(np.linalg.lstsq(sites, arm, rcond=None)[0]) < 0.0:
        arm = arm * np.array([1.0, 1.0, -1.0])
    at = np.array([3.0, height, 2.5])[:dimension] + arm
    velocity = generator.standard_normal(dimension) * np.ones((p, 1))
    box = (_core.Box2 if dimension == 2 else _core.Box3)(size, 0.4, 0.0)
    made.position, made.velocity = box.wrap(at, velocity)
    made.place()
    made.run(1)
    before = made.bases[0]
    made.run(1)
    after = made.bases[0]
    turns = 2 if dimension == 2 else 4
    at_velocity = slice(dimension + turns, 2 * dimension + turns)
    at_momentum = slice(2 * dimension + turns, 2 * dimension + turns + (1 if dimension == 2 else 3))
    change = np.zeros(dimension)
    change[0] = -1.1 * (before[1] - 0.5 * size[1])
    assert after[at_velocity] - before[at_velocity] == pytest.approx(change, abs=1e-5)
    affine = np.zeros((p, dimension))
    affine[:, 0] = -1.1 * arm[:, 1]
    turning = arm[:, 0] * affine[:, 1] - arm[:, 1] * affine[:, 0] if dimension == 2 else np.cross(arm, affine)
    wanted = mass * np.atleast_1d(turning.sum(axis=0))
    assert np.abs(wanted).max() > 0.01
    assert after[at_momentum] - before[at_momentum] == pytest.approx(wanted, abs=1e-5)


def test_a_body_at_rest_in_the_old_profile_is_at_rest_in_the_new():
    """A rigid square that turns as the profile does, -r/2, and goes with it, does both with the new rate."""
    made = engine(
        [7.0, 6.0], [1] * 4, kinds=[Kind(square, 1, "rigid")], laws=IDEAL, timestep=1e-6, stages=[(1, 0.4), (9, 1.7)]
    )
    made.position = np.array([3.0, 4.5]) + square
    made.velocity = 0.4 * np.stack([1.5 + 0.5 * square[:, 1], -0.5 * square[:, 0]], axis=1)
    made.place()
    made.run(5)
    wanted = 1.7 * np.stack([1.5 + 0.5 * square[:, 1], -0.5 * square[:, 0]], axis=1)
    assert made.velocity == pytest.approx(wanted, abs=1e-4)


# Bits

CASES = {
    "2D": {"size": [7.0, 6.0], "kinds": (Kind(square, 6), Kind(crooked_flat, 4, "rigid"))},
    "3D": {
        "size": [5.0, 5.0, 4.0],
        "kinds": (Kind(cube, 6), Kind(crooked, 4, "rigid"), Kind(crooked, 3, "newton-euler")),
    },
}


def digest(made):
    arrays = (made.order, made.position, made.velocity, made.force, made.bases)
    return b"".join(array.tobytes() for array in arrays) + f"{made.step} {made.offset.hex()}".encode()


def ready(case, precision="mixed", **flow):
    return suspension(**CASES[case], seed=21, timestep=DT, gentle_steps=50, precision=precision, **flow)


@pytest.mark.parametrize("precision", ["mixed", "double"])
@pytest.mark.parametrize("case", CASES)
def test_stages_of_one_rate_are_steady_shear_in_the_same_bits(case, precision):
    """From the same start, whose velocities are about no profile. The control: stages of two rates are not."""
    ends = []
    for flow in (
        {"shear_rate": 0.8},
        {"stages": [(1, 0.8)]},
        {"stages": [(7, 0.8), (11, 0.8)]},
        {"stages": [(7, 0.8), (11, 0.9)]},
    ):
        made = ready(case, precision)
        options = dict(CASES[case]) | flow
        copy = engine(options.pop("size"), made.species, seed=21, timestep=DT, precision=precision, **options)
        copy.position, copy.velocity = made.position, made.velocity
        copy.place()
        samples = copy.run(60, 10)
        ends.append(digest(copy) + samples.tobytes())
    assert ends[0] == ends[1] == ends[2] != ends[3]


@pytest.mark.parametrize("precision", ["mixed", "double"])
@pytest.mark.parametrize("kind", FLOWS)
@pytest.mark.parametrize("case", CASES)
def test_same_bits_through_a_copy_in_the_middle(case, kind, precision):
    """A new engine that is given the state inside a stage or between two (after 3, 5, 8, 13 or 31 steps), or anywhere
    in a cycle, goes on in the same bits; so does a run in pieces, or with other threads. The control: without the
    step, which tells where in the cycle it is, it does not.
    """
    flow = FLOWS[kind][0]
    whole = ready(case, precision, **flow)
    whole.run(40)
    samples = whole.run(20, 5).tobytes()
    threads = ready(case, precision, threads=2, **flow)
    for steps in (3, 2, 0, 8, 27):
        threads.run(steps)
    assert threads.run(20, 5).tobytes() == samples
    assert digest(threads) == digest(whole)
    names = ("order", "position", "velocity", "force", "bases", "offset", "step")
    for at in (3, 5, 8, 13, 31):
        made = ready(case, precision, **flow)
        made.run(at)
        options = dict(CASES[case]) | flow
        size = options.pop("size")
        copy, control = (
            engine(size, made.species, seed=21, timestep=DT, precision=precision, **options) for _ in range(2)
        )
        for name in names:
            setattr(copy, name, getattr(made, name))
            if name != "step":
                setattr(control, name, getattr(made, name))
        assert copy.shear_rate == made.shear_rate
        for one in (copy, control):
            one.run(40 - at)
        assert copy.run(20, 5).tobytes() == samples
        assert digest(copy) == digest(whole) != digest(control)


def test_stages_without_a_step_are_refused():
    """In a process of its own: the core would divide by the number of all their steps."""
    text = """
import numpy as np
import pytest
from tether import _core
others = {"exponent": 0.5, "random": "uniform", "timestep": 0.01, "verlet_lambda": 0.5, "seed": 1, "species_mass": [1]}
for stages in ([(0, 1.0)], [(0, 1.0), (0, 2.0)]):
    with pytest.raises(ValueError, match="stage"):
        _core.CpuEngine2(
            size=[4.0, 4.0], laws=np.ones((1, 1, 5)), stages=stages, species=np.zeros(1, np.uint8), **others
        )
"""
    subprocess.run([sys.executable, "-c", text], check=True)
