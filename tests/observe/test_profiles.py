"""Profiles across y: sums written out, cold affine flow, and a gas of known density, velocity and temperature.

Every random test has a fixed seed; false-alarm rates are the chance that a seed chosen blindly would have failed.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from tether.observe.moment import Moment
from tether.observe.profiles import Profiles


def moment(position, velocity, mass, solvent, *, size, rate=0.0, center=None, kind=()) -> Moment:
    d = len(size)
    center = np.zeros((0, d)) if center is None else np.asarray(center)
    return Moment(
        step=0, time=0.0, size=tuple(size), offset=0.0, shear_rate=rate, strain=0.0,
        position=np.asarray(position), velocity=np.asarray(velocity), mass=np.asarray(mass), solvent=solvent,
        center=center, center_velocity=np.zeros_like(center), rotation=np.tile(np.eye(d), (len(center), 1, 1)),
        kind=np.array(kind, dtype=np.intp),
    )  # fmt: skip


def random_moment(generator, *, size=(4.0, 5.0, 6.0), rate=0.7) -> Moment:
    d, count = len(size), 90
    return moment(
        generator.uniform(0.0, 1.0, (count, d)) * size,
        generator.standard_normal((count, d)),
        generator.uniform(1.0, 3.0, count),
        60,
        size=size,
        rate=rate,
        center=generator.uniform(0.0, 1.0, (9, d)) * size,
        kind=[0, 0, 0, 0, 1, 1, 1, 1, 1],
    )


@pytest.mark.parametrize("size", [(4.0, 5.0), (4.0, 5.0, 6.0)])
def test_sums_written_out(size):
    """Two samples, each quantity from a loop over particles."""
    d, bins, rate = len(size), 4, 0.7
    generator = np.random.default_rng(1)
    made = Profiles(bins, 10, size, ("cube", "rod"))
    moments = [random_moment(generator, size=size, rate=rate) for _ in range(2)]
    sums = np.zeros((2, 2 + 2 * d, bins))
    bodies = np.zeros((2, bins))
    for one in moments:
        made.sample(one)
        for i in range(len(one.mass)):
            y = one.position[i, 1]
            c = one.velocity[i] - [rate * (y - 2.5), *[0.0] * (d - 1)]
            m = one.mass[i]
            sums[int(i >= 60), :, int(y / 1.25)] += 0.5 * np.array([1.0, m, *(m * c), *(m * c * c)])
        for place, kind in zip(one.center, one.kind, strict=True):
            bodies[kind, int(place[1] / 1.25)] += 0.5
    found = made.dataset()
    volume = np.prod(size) / bins
    every = sums.sum(axis=0)
    by_name = {"": every, "_solvent": sums[0], "_constituents": sums[1]}
    for of, part in by_name.items():
        count, mass, momentum, energy = part[0], part[1], part[2 : 2 + d], part[2 + d :]
        thermal = energy - momentum**2 / mass
        freedom = count - mass / moments[-1].mass.sum()
        assert found[f"density{of}"].values == pytest.approx(count / volume)
        assert found[f"velocity{of}"].values == pytest.approx(momentum[0] / mass + rate * (made.y - 2.5))
        assert found[f"temperature{of}"].values == pytest.approx(thermal.sum(axis=0) / (d * freedom))
    thermal = every[2 + d :] - every[2 : 2 + d] ** 2 / every[1]
    freedom = every[0] - every[1] / moments[-1].mass.sum()
    for axis in range(d):
        assert found["temperature_axes"].values[:, axis] == pytest.approx(thermal[axis] / freedom)
    assert found["particle_fraction"].values == pytest.approx(sums[1, 0] / every[0])
    assert found["density_bodies_cube"].values == pytest.approx(bodies[0] / volume)
    assert found["density_bodies_rod"].values == pytest.approx(bodies[1] / volume)
    assert found["density_bodies"].values == pytest.approx(bodies.sum(axis=0) / volume)
    assert found["y"].values == pytest.approx([0.625, 1.875, 3.125, 4.375])
    for name, variable in found.data_vars.items():
        assert variable.attrs["units"]
        assert variable.attrs["long_name"]
        assert name.endswith("_error") or f"{name}_error" in found
    # Densities over the bins hold every particle.
    assert found["density"].values.sum() * volume == pytest.approx(90.0)


def test_cold_particles_in_affine_flow_have_no_temperature():
    """In three bins as wide as a third of the box the shear within each is no heat, and u_x is that of the middle."""
    generator = np.random.default_rng(2)
    made = Profiles(3, 1, (3.0, 6.0))
    for _ in range(100):
        position = generator.uniform(0.0, 1.0, (40, 2)) * (3.0, 6.0)
        velocity = np.column_stack([0.5 * (position[:, 1] - 3.0), np.zeros(40)])
        made.sample(moment(position, velocity, np.ones(40), 40, size=(3.0, 6.0), rate=0.5))
    found = made.dataset()
    assert found["temperature"].values == pytest.approx([0.0] * 3, abs=1e-14)
    assert found["velocity"].values == pytest.approx([-1.0, 0.0, 1.0], abs=1e-14)
    assert found["velocity_error"].values == pytest.approx([0.0] * 3, abs=1e-14)
    assert "density_constituents" not in found


def gas(samples, *, seed, size=(5.0, 5.0), count=40, rate=0.4, bend=0.3, temperature=0.8, bins=8) -> Profiles:
    """An ideal gas whose total peculiar momentum does not fluctuate, about imposed + bend * sin(2 pi y/L_y)."""
    generator = np.random.default_rng(seed)
    made = Profiles(bins, 1, size)
    mass = np.repeat([1.0, 2.0], count // 2)
    for _ in range(samples):
        position = generator.uniform(0.0, 1.0, (count, 2)) * size
        velocity = generator.standard_normal((count, 2)) * np.sqrt(temperature / mass)[:, None]
        velocity -= mass @ velocity / mass.sum()
        velocity[:, 0] += rate * (position[:, 1] - 0.5 * size[1]) + bend * np.sin(
            2.0 * np.pi * position[:, 1] / size[1]
        )
        made.sample(moment(position, velocity, mass, count, size=size, rate=rate))
    return made


def chance(made: Profiles, name: str, expected, bins=slice(None)) -> float:
    """Of deviations this large, by Hotelling's test."""
    covariance, blocks = made.covariance(name)
    away = (made.dataset()[name].values - expected)[bins]
    width = len(away)
    square = away @ np.linalg.solve(covariance[bins, bins], away)
    return float(stats.f.sf(square * (blocks - width) / (width * (blocks - 1)), width, blocks - width))


def test_a_gas_of_known_profiles():
    """10000 independent samples. Density, velocity and temperature in 8 bins pass Hotelling's test at 1e-4 each
    (density in 7: the last is what the others leave). The same against a velocity without the bend's last tenth, a
    temperature 2 % higher, and one that forgets that momentum does not fluctuate, must fail.
    """
    made = gas(10_000, seed=3)
    edges = np.linspace(0.0, 5.0, 9)
    wave = -np.diff(np.cos(2.0 * np.pi * edges / 5.0)) / (2.0 * np.pi / 5.0) / np.diff(edges)  # mean over a bin
    square = 0.5 - np.diff(np.sin(4.0 * np.pi * edges / 5.0)) / (8.0 * np.pi / 5.0) / np.diff(edges)
    velocity = 0.4 * (made.y - 2.5) + 0.3 * wave
    # In a bin the bend varies about its mean: a little heat, m times its variance over d, as the module says.
    temperature = 0.8 + 1.5 * 0.09 * (square - wave**2) / 2.0
    assert chance(made, "density", 40.0 / 25.0, slice(0, 7)) > 1e-4
    assert chance(made, "velocity", velocity) > 1e-4
    assert chance(made, "temperature", temperature) > 1e-4
    assert chance(made, "velocity", velocity - 0.03 * wave) < 1e-4
    assert chance(made, "temperature", 1.02 * temperature) < 1e-4
    assert chance(made, "temperature", temperature * (1.0 - 1.0 / 40.0)) < 1e-4
    slopes = 0.3 * 2.0 * np.pi / 5.0 * np.cos(2.0 * np.pi * made.y / 5.0)
    assert temperature == pytest.approx(0.8 + 1.5 * (slopes * 5.0 / 8.0) ** 2 / 24.0, abs=1e-3)


def test_errors_cover():
    """Velocities of 60 bins over their errors: mean square 1 within 4.5 of its standard errors, and 12 %."""
    found = gas(3000, seed=4, bins=60, bend=0.0).dataset()
    distance = (found["velocity"] - 0.4 * (found["y"] - 2.5)) / found["velocity_error"]
    kept = distance.values[np.isfinite(distance.values)]
    assert len(kept) > 50
    assert np.mean(kept**2) == pytest.approx(1.0, abs=0.12 + 4.5 * np.sqrt(2.0 / 60.0))


def test_a_bin_that_is_always_empty():
    made = Profiles(2, 1, (2.0, 2.0))
    for _ in range(60):
        made.sample(moment([[0.5, 0.5], [0.5, 2.0]], np.zeros((2, 2)), np.ones(2), 2, size=(2.0, 2.0)))
    found = made.dataset()
    assert found["density"].values == pytest.approx([0.5, 0.5])  # y = L_y, by rounding, is in the last bin
    made = Profiles(4, 1, (2.0, 2.0))
    for _ in range(60):
        made.sample(moment([[0.5, 0.3], [0.5, 0.2]], np.ones((2, 2)), np.ones(2), 2, size=(2.0, 2.0)))
    found = made.dataset()
    assert found["density"].values == pytest.approx([2.0, 0.0, 0.0, 0.0])
    assert np.isnan(found["velocity"].values[1:]).all()
    assert np.isnan(found["velocity_error"].values[1:]).all()


def test_before_any_sample():
    assert Profiles(4, 1, (2.0, 2.0)).dataset() is None


@pytest.mark.parametrize("middle", [1, 300, 650])
def test_goes_on_bit_for_bit(middle):
    generator = np.random.default_rng(5)
    moments = [random_moment(generator) for _ in range(700)]
    straight, first, second = (Profiles(5, 10, (4.0, 5.0, 6.0), ("cube", "rod")) for _ in range(3))
    for one in moments:
        straight.sample(one)
    for one in moments[:middle]:
        first.sample(one)
    second.restore(first.state())
    for one in moments[middle:]:
        first.sample(one)
        second.sample(one)
    for name, value in straight.state().items():
        assert second.state()[name].tobytes() == value.tobytes()
    assert second.dataset().identical(straight.dataset())
