"""Stress in bins and through planes: exact for one pair, in sum the volume average, in balance with momentum in every
step; and the temperature that conservative forces tell.
"""

from __future__ import annotations

import numpy as np
import pytest
from suspensions import (
    Kind,
    crooked,
    crooked_flat,
    cube,
    engine,
    law_table,
    limit,
    measured,
    rod,
    square,
    suspension,
)

from tether import _core


class Seen:
    """What an engine saw of the local stress, by name: sums of m, m v, m v v of each bin (steps, bins, ...); the stress
    of pairs and of what holds constituents in bins (steps, bins, D, D); force per area through planes normal to y and
    to x, (steps, 3, bins, D), of what crosses, of pairs and of what holds; the sums of the configurational temperature.
    """

    def __init__(self, rows, bins, dimension):
        d, n = dimension, len(rows)
        of_bins, planes, temperature = np.split(rows, [bins * (1 + d + 3 * d * d), rows.shape[1] - 2], axis=1)
        of_bins = of_bins.reshape(n, bins, -1)
        self.mass, self.momentum = of_bins[:, :, 0], of_bins[:, :, 1 : 1 + d]
        tensors = of_bins[:, :, 1 + d :].reshape(n, bins, 3, d, d)
        self.flux, self.pairs, self.held = (tensors[:, :, k] for k in range(3))
        planes = planes.reshape(n, 2, bins, 3, d).transpose(0, 1, 3, 2, 4)
        self.planes = {"y": planes[:, 0], "x": planes[:, 1]}
        self.square_force, self.divergence = temperature.T


def seen(made, bins):
    return Seen(made.take_stress(), bins, made.position.shape[1])


CASES = {
    "2D": {"size": [4.0, 5.0]},
    "2D, sheared": {"size": [4.0, 5.0], "shear_rate": 0.9, "verlet_lambda": 0.65},
    "2D, tethered and rigid": {
        "size": [5.0, 6.0],
        "kinds": (Kind(square, 5), Kind(crooked_flat, 4, "rigid"), Kind(np.zeros((1, 2)), 3, stiffness=0.0)),
        "shear_rate": -0.9,
        "species_mass": (1.0, 1.7),
    },
    "3D, tethered and rigid": {
        "size": [4.0, 4.5, 5.0],
        "kinds": (Kind(cube, 5), Kind(crooked, 4, "rigid"), Kind(rod, 3, "rigid"), Kind(crooked, 3, "newton-euler")),
        "shear_rate": 0.9,
        "random": "gaussian",
    },
    "3D, two species, at rest": {
        "size": [4.3, 4.5, 5.0],
        "kinds": (Kind(crooked, 6, "rigid"),),
        "laws": law_table(
            [[(18.75, 4.5, 1.0, 0.0), (30.0, 3.0, 1.4, 20.0)], [(30.0, 3.0, 1.4, 20.0), (9.0, 2.0, 0.6, 0.0)]]
        ),
    },
}


def ready(case, **options):
    return suspension(**({"density": 3.0, "timestep": 0.004, "seed": 5} | CASES[case] | options))


# Volume averages


@pytest.mark.parametrize("which", ["mixed", "double", "reference"])
@pytest.mark.parametrize("bins", [1, 7])
@pytest.mark.parametrize("case", CASES)
def test_mean_over_the_bins_is_the_volume_average(case, bins, which):
    """Of what run() measures at the same step, to 1e-10 in double: pairs have the conservative and the dissipative
    stress (not those within a rigid body), what holds constituents the bodies' one, m v v the kinetic one.
    """
    made = ready(case, **({"pairs": "reference"} if which == "reference" else {"precision": which}))
    made.observe_stress(bins, 5)
    named = measured(made, made.run(20, 1))
    found = seen(made, bins)
    volume = np.prod(CASES[case]["size"])
    mass = np.array(CASES[case].get("species_mass", (1.0, 1.0)))[made.species]
    assert found.mass.shape == (4, bins)
    assert found.mass.sum(axis=1) == pytest.approx(mass.sum(), rel=1e-13)
    bar = 1e-3 if which == "mixed" else 1e-10
    at = slice(4, None, 5)
    for one, wanted in (
        (found.momentum.sum(axis=1), named["momentum"]),
        (-found.flux.sum(axis=1) / volume, named["stress_kinetic"]),
        (found.pairs.mean(axis=1), named["stress_conservative"] + named["stress_dissipative"]),
        (found.held.mean(axis=1), named["stress_body"]),
    ):
        assert one.shape == wanted[at].shape
        assert np.abs(one - wanted[at]).max() < bar
        assert np.abs(one - wanted[at]).max() < 0.1 * np.abs(wanted - wanted.mean(axis=0)).max() + 1e-11  # the control


def test_a_bin_has_what_is_in_it():
    """Mass, momentum and its flux, against the imposed profile, from positions and velocities."""
    made = ready("2D, tethered and rigid")
    made.observe_stress(6, 3)
    made.run(3)
    found = seen(made, 6)
    position, velocity = made.position, made.velocity
    velocity[:, 0] -= -0.9 * (position[:, 1] - 3.0)
    mass = np.array([1.0, 1.7])[made.species]
    for b in range(6):
        inside = np.floor(position[:, 1]) == b
        c, m = velocity[inside], mass[inside][:, None]
        assert found.mass[0, b] == pytest.approx(m.sum(), rel=1e-13)
        assert found.momentum[0, b] == pytest.approx((m * c).sum(axis=0), abs=1e-11)
        assert found.flux[0, b] == pytest.approx((m * c).T @ c, abs=1e-11)


@pytest.mark.parametrize("case", CASES)
def test_planes_are_the_bins_mean_where_there_are_many(case):
    """The mean over n planes of a normal is the row of the volume average, but for what a line's or a flight's number
    of crossings is off: less than one, so that the error falls with n. Flights are of the velocities of half a step
    ago.
    """
    dimension = len(CASES[case]["size"])
    errors = []
    for bins in (200, 20_000):
        made = ready(case)
        made.observe_stress(bins, 8)
        made.run(8)
        found = seen(made, bins)
        mass = np.array(CASES[case].get("species_mass", (1.0, 1.0)))[made.species][:, None]
        half = made.velocity - 0.5 * 0.004 * made.force / mass
        half[:, 0] -= made.shear_rate * (made.position[:, 1] - 0.5 * CASES[case]["size"][1])
        kinetic = -(mass * half).T @ half / np.prod(CASES[case]["size"])
        worst = []
        for k, normal in enumerate("xy"):
            mean = found.planes[normal][0].mean(axis=1)
            wanted = (kinetic[k], found.pairs[0].mean(axis=0)[k], found.held[0].mean(axis=0)[k])
            assert mean.shape == (3, dimension)
            worst.append([np.abs(one - other).max() for one, other in zip(mean, wanted, strict=True)])
        errors.append(np.max(worst, axis=0))
    has_rigid = any(kind.base == "rigid" for kind in CASES[case].get("kinds", ()))
    # The half-step velocities of rigid constituents are those of their base, which `half` is only to order dt.
    assert errors[-1][0] < (0.02 if has_rigid else 0.01) * np.abs(kinetic).max()
    assert (errors[-1][1:] < 0.005).all()
    assert (errors[-1] < 0.1 * errors[0] + 0.02).all()


# One pair


def two(first, second, size, bins, *, shear_rate=0.0, offset=0.0, repulsion=20.0):
    """Two particles at rest, seen after a step in which they do not move; and the force on the first from the nearest
    image of the second, a (1 - r) along their separation.
    """
    made = engine(size, [0, 0], timestep=1e-9, friction=0.0, repulsion=repulsion, shear_rate=shear_rate, exponent=2.0)
    position = np.array([first, second], dtype=float)
    velocity = np.zeros_like(position)
    velocity[:, 0] = shear_rate * (position[:, 1] - 0.5 * size[1])
    made.position, made.velocity, made.offset = position, velocity, offset
    made.place()
    made.observe_stress(bins, 1)
    made.run(1)
    box = (_core.Box2 if len(size) == 2 else _core.Box3)(size, shear_rate, offset)
    separation, _ = box.nearest_image(position[:1] - position[1:], np.zeros((1, len(size))))
    r = separation[0]
    force = repulsion * (1.0 - np.linalg.norm(r)) * r / np.linalg.norm(r)
    return seen(made, bins), r, force


def crossings(begin, end, spacing, bins):
    """For each of the equally spaced periodic planes, how often the way from begin to end crosses it, with its sign."""
    low, high = sorted((begin, end))
    planes = np.arange(np.floor(low / spacing) + 1, np.floor(high / spacing) + 1).astype(int)
    found = np.zeros(bins)
    np.add.at(found, planes % bins, 1.0 if end > begin else -1.0)
    return found


PLACES = {
    "inside": ([2.05, 2.93], [2.35, 2.31], 0.0),
    "inside, other way": ([2.35, 2.31], [2.05, 2.93], 0.0),
    "inside one bin": ([2.05, 2.31], [2.15, 2.32], 0.0),
    "across x": ([3.9, 1.2], [0.25, 1.6], 0.0),
    "across y": ([2.1, 4.9], [2.3, 0.3], 0.0),
    "across both": ([0.1, 0.15], [3.85, 4.7], 0.0),
    "across the sheared boundary": ([0.5, 4.9], [2.9, 0.3], 1.6),
    "across the sheared boundary, far": ([3.9, 0.1], [2.0, 4.6], 1.8),
}


@pytest.mark.parametrize("depth", [None, (1.0, 1.3), (0.1, 3.9)], ids=["2D", "3D", "3D across z"])
@pytest.mark.parametrize("place", PLACES)
def test_one_pair_exactly(place, depth):
    """Bins have -r F/V_bin times the part of the line in them, planes -F sign(r_k)/A where the line crosses them: two
    that repel press. A line through the sheared boundary goes on in the frame of one of the two.
    """
    first, second, offset = PLACES[place]
    size = [4.0, 5.0]
    if depth is not None:
        first, second, size = [*first, depth[0]], [*second, depth[1]], [4.0, 5.0, 4.0]
    bins = 20
    shear_rate = 0.7 if offset else 0.0
    found, r, force = two(first, second, size, bins, shear_rate=shear_rate, offset=offset)
    assert 0.05 < np.linalg.norm(r) < 1.0
    volume = np.prod(size)
    width = size[1] / bins
    # Share of the line in each bin, by counting along it
    points = (first[1] - r[1] * (np.arange(200_000) + 0.5) / 200_000) / width
    share = np.bincount(np.floor(points).astype(int) % bins, minlength=bins) / 200_000
    exact = -bins / volume * share[:, None, None] * np.outer(r, force)
    assert np.abs(found.pairs[0] - exact).max() < 2e-5 * np.abs(exact).max()
    assert found.pairs[0].mean(axis=0) == pytest.approx(-np.outer(r, force) / volume, abs=1e-9)
    through = crossings(first[1] - r[1], first[1], width, bins)
    wanted = -size[1] / volume * through[:, None] * force
    assert found.planes["y"][0, 1] == pytest.approx(wanted, abs=1e-7)
    assert (found.planes["y"][0, 1][through != 0.0][:, 1] < 0.0).all()  # repulsion is pressure
    choices = []
    for begin, end in ((first[0] - r[0], first[0]), (second[0], second[0] + r[0])):
        choices.append(-size[0] / volume * crossings(begin, end, size[0] / bins, bins)[:, None] * force)
    assert any(np.abs(found.planes["x"][0, 1] - each).max() < 1e-7 for each in choices)
    for nothing in (found.planes["y"][0, [0, 2]], found.planes["x"][0, [0, 2]], found.held[0]):
        assert not nothing.any()


def test_a_stretched_body_pulls_on_the_planes_through_it():
    """A square stretched along y by hand: its springs pull its two upper constituents down with H times the stretch,
    each along a line from its center, so the planes through it bear that tension, those beside it none.
    """
    made = engine(
        [4.0, 4.0], [1] * 4, kinds=[Kind(square, 1, stiffness=200.0)], timestep=1e-9, repulsion=0.0, friction=0.0
    )
    made.position = 2.0 + square * np.array([1.0, 1.6])
    made.velocity = np.zeros((4, 2))
    made.place()
    made.observe_stress(80, 1)  # planes at multiples of 0.05; the body reaches from 1.8 to 2.2
    made.run(1)
    found = seen(made, 80)
    planes = found.planes["y"][0, 2]
    at = 0.05 * np.arange(80)
    through = (at > 1.8 + 1e-9) & (at < 2.2 - 1e-9) & (np.abs(at - 2.0) > 1e-9)
    assert planes[through][:, 1] == pytest.approx(2 * 200.0 * 0.6 * 0.125 / 4.0, rel=1e-9)
    assert np.abs(planes[(at < 1.79) | (at > 2.21)]).max() < 1e-12
    assert np.abs(planes[:, 0]).max() < 1e-9
    stress = -np.einsum("ik,il->kl", made.position - 2.0, made.force) / 16.0
    assert found.held[0].mean(axis=0) == pytest.approx(stress, abs=1e-9)


# Balance of momentum

DRIVEN = {
    "at rest": {},
    "poiseuille": {"driving": "poiseuille", "force": 0.8},
    "kolmogorov": {"driving": "kolmogorov", "force": 0.8},
    "sheared": {"shear_rate": 0.9},
    "oscillating": {"oscillation": (0.4, 12.0)},
}


def imbalance(made, size, bins, steps, timestep, driving, mass):
    """Of each step and slab between two planes normal to y, what its momentum changes by less what the planes and the
    applied force give it, (steps, bins, D); and the momentum that each source gives, (steps, 3, bins, D).

    Velocities are those of half a step ago, against the imposed profile; in shear they lose rate v_y of v_x. With P(t)
    of the particles that are in the slab at t, and S what planes bear (S A is the force on what is below):
        P(t + dt) = P(t) + dt A (S_forces(t) at the upper edge - at the lower) + dt sum F_applied
                    + dt A (S_crossing(t + dt) likewise) - dt rate sum m v_y(t + dt/2)
    """
    area, width = np.prod(size) / size[1], size[1] / bins
    planes, states = [], []
    for _ in range(steps + 1):
        made.run(1)
        planes.append(seen(made, bins).planes["y"][0])
        position, velocity = made.position, made.velocity
        kick = 0.5 * timestep * made.force / mass[:, None]
        half = velocity - kick
        half[:, 0] -= made.shear_rate * (position[:, 1] - 0.5 * size[1])
        slab = np.floor(position[:, 1] / width).astype(int)
        states.append((position[:, 1], slab, half, (velocity + kick)[:, 1], made.shear_rate))

    def sums(values, slab):
        return np.stack([np.bincount(slab, column, bins) for column in values.T], axis=1)

    rest, impulses = [], []
    for step in range(steps):
        y, slab, half, rising, _ = states[step]
        _, next_slab, next_half, _, next_rate = states[step + 1]
        edges = np.concatenate([planes[step + 1][:1], planes[step][1:]])  # what crosses in the step that comes
        impulses.append(timestep * area * (np.roll(edges, -1, axis=1) - edges))
        applied = np.zeros_like(half)
        applied[:, 0] = -next_rate * mass * rising
        if driving:
            is_steps = driving["driving"] == "poiseuille"
            profile = np.where(y > 0.5 * size[1], 1.0, -1.0) if is_steps else np.sin(2.0 * np.pi * y / size[1])
            applied[:, 0] += driving["force"] * (profile - np.mean(profile))
        change = sums(mass[:, None] * next_half, next_slab) - sums(mass[:, None] * half, slab)
        rest.append(change - impulses[-1].sum(axis=0) - timestep * sums(applied, slab))
    return np.array(rest), np.array(impulses)


BALANCED = {
    "2D fluid": ([4.0, 5.0], ()),
    "2D squares": ([4.0, 5.0], (Kind(square, 4),)),
    "3D cubes": ([4.0, 4.0, 3.5], (Kind(cube, 3),)),
}


@pytest.mark.parametrize("flow", DRIVEN)
@pytest.mark.parametrize("case", BALANCED)
def test_momentum_between_planes_balances_in_every_step(case, flow):
    """To rounding, slab by slab, with friction and without noise (whose stress is left out), in every flow. The
    control: without what crosses, what pairs do, or what holds the bodies' constituents, it does not.
    """
    size, kinds = BALANCED[case]
    options = DRIVEN[flow]
    masses = (1.0, 1.5)
    made = suspension(
        size, kinds=kinds, density=3.0, timestep=0.004, noise=0.0, species_mass=masses, precision="double", **options
    )
    made.observe_stress(9, 1)
    driving = options if "driving" in options else {}
    rest, impulses = imbalance(made, size, 9, 60, 0.004, driving, np.array(masses)[made.species])
    assert np.abs(rest).max() < 1e-11
    for source in range(3 if kinds else 2):
        assert np.abs(rest + impulses[:, source]).max() > 0.05


@pytest.mark.parametrize("sites", [square, crooked], ids=["2D", "3D"])
def test_momentum_balances_with_rigid_bodies_but_for_their_turning(sites):
    """Their constituents go on circles from step to step, not straight: what a slab gains is off in a higher order of
    the time step, or by the momentum of a constituent that turns across a plane just there. On average that is below
    2e-3 of what planes give in a step.
    """
    size = [4.0] * sites.shape[1]
    kinds = (Kind(sites, 4, "rigid"),)
    made = suspension(size, kinds=kinds, density=3.0, timestep=0.002, noise=0.0, precision="double")
    made.observe_stress(9, 1)
    rest, impulses = imbalance(made, size, 9, 300, 0.002, {}, np.ones(len(made.position)))
    given = np.abs(impulses.sum(axis=1)).mean()
    assert np.abs(rest).mean() < 2e-3 * given
    assert np.abs(rest + impulses[:, 2]).mean() > 0.1 * given  # the control: without what holds constituents


# Configurational temperature


@pytest.mark.parametrize("steepness", [0.0, 8.0])
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("partner", ["solvent", "constituent"])
def test_configurational_temperature_of_two_particles(dimension, steepness, partner):
    """sum |F|^2 and the sum of -dF/dr - (d - 1) F/r, of both or of the one that is solvent."""
    made = engine(
        [6.0] * dimension,
        [0, 0 if partner == "solvent" else 1],
        laws=law_table([[(20.0, 0.0, 1.2, steepness)] * 2] * 2),
        timestep=1e-9,
    )
    position = np.full((2, dimension), 3.0)
    position[0, :2] += 0.27, 0.36  # 0.45 apart
    made.position, made.velocity = position, np.zeros_like(position)
    made.place()
    made.observe_stress(3, 1)
    made.run(1)
    found = seen(made, 3)

    def force(r):
        r = r / 1.2
        if steepness == 0.0:
            return 20.0 * (1.0 - r)
        return 20.0 * (np.exp(-steepness * r) - np.exp(-steepness)) / (1.0 - np.exp(-steepness))

    slope = (force(0.45 + 1e-5) - force(0.45 - 1e-5)) / 2e-5
    count = 2 if partner == "solvent" else 1
    assert found.square_force[0] == pytest.approx(count * force(0.45) ** 2, rel=1e-9)
    assert found.divergence[0] == pytest.approx(count * (-slope - (dimension - 1) * force(0.45) / 0.45), rel=1e-7)


@pytest.mark.parametrize("size", [[5.0, 5.0], [4.0, 4.0, 4.0]], ids=["2D", "3D"])
def test_configurational_temperature_is_that_of_the_fluid(size):
    """kT = 0.8 at a time step of 0.002: the ratio of two means, with its error from 20 blocks, false-alarm rate 1e-4;
    one percent is left to the time step. The sums of some steps are found again from positions; the control is the
    formula without -(d - 1) F/r, from the same positions.
    """
    dimension = len(size)
    made = suspension(size, temperature=0.8, timestep=0.002, seed=3)
    made.run(2000)
    made.observe_stress(1, 20)
    sums, plain = [], []
    for _ in range(300):
        made.run(60)
        found = seen(made, 1)
        sums += list(zip(found.square_force, found.divergence, strict=True))
        pairs, separation, _ = _core.neighbor_pairs(made.position, size)
        distance = np.linalg.norm(separation, axis=1)
        force = np.zeros_like(made.position)
        push = (18.75 * (1.0 - distance) / distance)[:, None] * separation
        np.add.at(force, pairs[:, 0], push)
        np.subtract.at(force, pairs[:, 1], push)
        wrong = 2.0 * 18.75 * len(distance)
        right = wrong - 2.0 * np.sum((dimension - 1) * 18.75 * (1.0 - distance) / distance)
        assert sums[-1] == pytest.approx((np.sum(force**2), right), rel=1e-9)
        plain.append((np.sum(force**2), wrong))

    def is_kt(series):
        blocks = np.array([block.sum(axis=0) for block in np.array_split(np.array(series), 20)])
        whole = blocks.sum(axis=0)
        value = whole[0] / whole[1]
        error = np.std(blocks[:, 0] - value * blocks[:, 1], ddof=1) * np.sqrt(20) / whole[1]
        assert error < 0.02
        return abs(value - 0.8) < limit(1e-4) * error + 0.008

    assert is_kt(sums)
    assert not is_kt(plain)


# How it is done


@pytest.mark.parametrize("precision", ["mixed", "double"])
@pytest.mark.parametrize("case", CASES)
def test_looking_changes_nothing_and_does_not_depend_on_threads(case, precision):
    """Same numbers in every bit for any number of threads, any splitting, and whether the step is measured too; and the
    run is the one that nobody looked at.
    """
    ends, found = set(), set()
    for threads, parts, interval in ((1, (30,), 0), (2, (1, 0, 12, 17), 0), (3, (30,), 1), (None, (30,), 0)):
        made = ready(case, precision=precision, threads=threads or 1)
        if threads:
            made.observe_stress(7, 4)
        for steps in parts:
            made.run(steps, interval)
        if threads:
            found.add(made.take_stress().tobytes())
        ends.add(made.position.tobytes() + made.velocity.tobytes() + made.force.tobytes() + made.bases.tobytes())
    assert len(ends) == len(found) == 1


def test_steps_that_the_interval_divides_are_seen_once():
    made = ready("2D")
    assert made.take_stress().shape[0] == 0
    made.observe_stress(4, 10)
    made.run(9)
    assert made.take_stress().shape == (0, 4 * (1 + 2 + 12 + 12) + 2)
    made.run(1)
    assert made.take_stress().shape[0] == 1
    made.run(35)
    assert made.take_stress().shape[0] == 3
    assert made.take_stress().shape[0] == 0
