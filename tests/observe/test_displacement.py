"""Displacement about the flow, in worlds whose diffusion is known: particles that move with the shear and wander by an
Ornstein-Uhlenbeck velocity, wrapped into a box with sheared boundaries.

Every random test has a fixed seed; false-alarm rates are the chance that a seed chosen blindly would have failed.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tether.observe.displacement import Displacement, peculiar_displacement
from tether.observe.moment import Moment


class World:
    """Particles whose peculiar velocity c is an Ornstein-Uhlenbeck process, c' = e c + noise over each step.

    memory: time in which c is forgotten, `math.inf`: never. Position moves by the mean of c over the step and the flow
    at its middle height. Bodies turn by `turn` (2D: normal angles, 3D: rotation vectors) and spin.
    """

    def __init__(self, size, *, count, rate, memory, seed, step=0.1, bodies=0, turn=0.0, spin=0.0):
        self.size, self.rate, self.step, self.bodies = np.array(size), rate, step, bodies
        self.turn, self.spin = turn, spin
        self.generator = np.random.default_rng(seed)
        d = len(size)
        self.keep = math.exp(-step / memory)
        self.c = self.generator.standard_normal((count + bodies, d))
        self.position = self.generator.uniform(0.0, 1.0, self.c.shape) * size
        self.offset = self.strain = 0.0
        self.taken = 0
        self.rotation = np.tile(np.eye(d), (bodies, 1, 1))

    @property
    def diffusion(self):
        """Of each axis: h/2 (1 + e)/(1 - e), the sum over the discrete process's correlations."""
        return 0.5 * self.step * (1.0 + self.keep) / (1.0 - self.keep)

    def rate_now(self):
        return self.rate(self.taken * self.step) if callable(self.rate) else self.rate

    def advance(self):
        before, rate = self.c, self.rate_now()
        noise = self.generator.standard_normal(before.shape) * math.sqrt(1.0 - self.keep**2)
        self.c = self.keep * before + noise
        moved = 0.5 * self.step * (before + self.c)
        middle = self.position[:, 1] + 0.5 * moved[:, 1]
        self.position = self.position + moved
        self.position[:, 0] += self.step * rate * (middle - 0.5 * self.size[1])
        self.strain += self.step * rate
        self.offset = (self.offset + self.step * rate * self.size[1]) % self.size[0]
        crossings = np.floor(self.position[:, 1] / self.size[1])
        self.position[:, 0] -= crossings * self.offset
        self.position -= np.floor(self.position / self.size) * self.size
        self.taken += 1
        if self.bodies:
            self.rotation = self.turns() @ self.rotation

    def turns(self):
        d = len(self.size)
        vectors = self.turn * self.generator.standard_normal((self.bodies, 1 if d == 2 else 3))
        if d == 2:
            vectors = np.column_stack([np.zeros((self.bodies, 2)), vectors + self.spin * self.step])
        return Rotation.from_rotvec(vectors).as_matrix()[:, :d, :d]

    def moment(self):
        d, rate = len(self.size), self.rate_now()
        velocity = self.c.copy()
        velocity[:, 0] += rate * (self.position[:, 1] - 0.5 * self.size[1])
        solvent = len(self.c) - self.bodies
        return Moment(
            step=self.taken, time=self.taken * self.step, size=tuple(self.size.tolist()), offset=self.offset,
            shear_rate=rate, strain=self.strain, position=self.position[:solvent], velocity=velocity[:solvent],
            mass=np.ones(solvent), solvent=solvent, center=self.position[solvent:],
            center_velocity=velocity[solvent:], rotation=self.rotation.reshape(-1, d, d),
            kind=np.zeros(self.bodies, dtype=np.intp),
        )  # fmt: skip

    def observed(self, samples, every=1, see=lambda moment: moment, **how):
        bodies = {"disc": self.bodies} if self.bodies else None
        made = Displacement(every, len(self.size), len(self.c) - self.bodies, bodies, **how)
        for _ in range(samples):
            made.sample(see(self.moment()))
            for _ in range(every):
                self.advance()
        return made


@pytest.mark.parametrize("rate", [0.0, 0.9, -0.9])
@pytest.mark.parametrize("size", [(5.0, 4.0), (5.0, 4.0, 3.0)])
def test_ballistic_motion_is_exact(size, rate):
    """With velocities that never change, through every boundary many times: msd = c^2 lag^2, vacf = c^2, and D(lag) =
    c^2 lag/d, to rounding.
    """
    world = World(size, count=20, rate=rate, memory=math.inf, seed=1)
    found = world.observed(300, every=3).dataset()
    square = np.mean(world.c**2, axis=0)
    lag = found["lag"].values
    assert lag[:3] == pytest.approx([0.0, 0.3, 0.6])
    assert lag[-1] > 40.0
    assert found["msd_axes_solvent"].values == pytest.approx(square * lag[:, None] ** 2, rel=1e-9, abs=1e-12)
    assert found["msd_solvent"].values == pytest.approx(square.sum() * lag**2, rel=1e-9, abs=1e-12)
    assert found["vacf_axes_solvent"].values == pytest.approx(np.tile(square, (len(found.velocity_lag), 1)), rel=1e-9)
    running = square.mean() * lag
    assert found["diffusion_running_solvent"].values == pytest.approx(running, rel=1e-9, abs=1e-12)


def known_msd(world, lags):
    """Of one axis: the double sum over steps of the correlation of their mean velocities, in closed form."""
    n, e = lags / world.step, world.keep
    # (1 + e)/2 of a step with itself, (1 + e)^2/4 e^(k - 1) of steps that are k apart.
    pairs = (n / (1.0 - e) - (1.0 - e**n) / (1.0 - e) ** 2) * 0.5 * (1.0 + e) ** 2
    return world.step**2 * (0.5 * n * (1.0 + e) + pairs)


@pytest.mark.parametrize(("size", "rate"), [((6.0, 5.0), 0.0), ((6.0, 5.0), 0.6), ((6.0, 5.0, 4.0), -0.6)])
def test_known_diffusion(size, rate):
    """Both routes to D and each axis are within 4.5 of their errors of the exact one, msd, D(lag) and vacf at every lag
    within 5 (about 60 lags of three quantities: false-alarm rate under 1e-3 in all). What an observer finds that is
    told of no flow must fail.
    """
    world = World(size, count=100, rate=rate, memory=0.15, seed=2)
    found = world.observed(6000).dataset()
    assert world.diffusion == pytest.approx(0.15, rel=0.05)  # kT/m times the memory, but for the step
    for name in ("diffusion_solvent", "diffusion_axes_solvent", "diffusion_velocity_solvent"):
        value, error = found[name].values, found[f"{name}_error"].values
        assert (error < 0.05 * world.diffusion).all()
        assert (np.abs(value - world.diffusion) < 4.5 * error).all()
        assert 20.0 * 0.15 < found["diffusion_solvent"].lag_from < found["diffusion_solvent"].lag_to < 40.0
    lag, exact = found["lag"].values, known_msd(world, found["lag"].values)
    slow = known_msd(world, np.array([1.0, 100.0, 101.0]))
    assert slow[2] - slow[1] == pytest.approx(2.0 * world.diffusion)
    assert agrees(found, "msd_axes_solvent", exact[:, None])
    assert agrees(found, "vacf_axes_solvent", world.keep ** (found["velocity_lag"].values / world.step)[:, None])
    # D(lag), from a velocity at the end: half the derivative of msd.
    slope = (1.0 + world.keep) * 0.5 * world.step * (1.0 - world.keep ** (lag / world.step)) / (1.0 - world.keep)
    assert agrees(found, "diffusion_running_solvent", slope)
    if rate != 0.0:
        again = World(size, count=100, rate=rate, memory=0.15, seed=2)
        told = again.observed(6000, see=lambda moment: replace(moment, shear_rate=0.0, strain=0.0)).dataset()
        assert not agrees(told, "msd_axes_solvent", exact[:, None])
        assert not agrees(told, "vacf_axes_solvent", world.keep ** (found["velocity_lag"].values / world.step)[:, None])


def agrees(found, name, exact) -> bool:
    error = found[f"{name}_error"].values
    known = np.isfinite(error) & (error > 0.0)
    assert known.sum() > 20
    return bool((np.abs(found[name].values - exact)[known] < 5.0 * error[known]).all())


def test_errors_of_diffusion_cover():
    """30 worlds: the mean square of (D - exact)/error is 1 within 4.5 standard errors, false-alarm rate 1e-5, and 15 %
    for errors that are a little high and uncertain; the two routes alike.
    """
    distances = []
    for seed in range(30):
        world = World((6.0, 5.0), count=10, rate=0.5, memory=0.05, seed=seed + 100)
        found = world.observed(2000).dataset()
        routes = ("diffusion_solvent", "diffusion_velocity_solvent")
        distances += [float((found[name] - world.diffusion) / found[f"{name}_error"]) for name in routes]
    kept = np.array(distances)
    kept = kept[np.isfinite(kept)]
    assert len(kept) > 50
    assert np.mean(kept**2) == pytest.approx(1.0, abs=0.15 + 4.5 * math.sqrt(2.0 / 30.0))


def test_rate_that_changes_in_time():
    """Oscillatory shear, samples ten steps apart, strain 0.1 between two of them: D of x as of y, within 4.5 errors."""
    world = World((6.0, 5.0), count=60, rate=lambda t: 1.5 * math.cos(1.1 * t), memory=0.05, seed=3, step=0.02)
    found = world.observed(2500, every=5).dataset()
    value, error = found["diffusion_axes_solvent"].values, found["diffusion_axes_solvent_error"].values
    assert (error < 0.1 * world.diffusion).all()
    assert (np.abs(value - world.diffusion) < 4.5 * error).all()


def test_error_of_the_trapezoid_rule_is_the_stated_one():
    """Brownian paths in y of 400 steps: what `peculiar_displacement` finds less the true one has mean square
    rate^2 D h^3 / 6, within 5 standard errors of 4000 squares (false-alarm rate 1e-6), also through boundaries.
    """
    generator = np.random.default_rng(4)
    count, steps, rate, diffusion, interval = 4000, 400, 0.8, 0.3, 2.0
    size = (9.0, 14.0)
    start = generator.uniform(0.0, 1.0, (2, count)) * np.array(size)[:, None]
    noise = math.sqrt(2.0 * diffusion * interval / steps) * generator.standard_normal((2, steps, count))
    y = start[1] + np.cumsum(noise[1], axis=0)
    heights = np.concatenate([start[1:], y])
    affine = rate * interval / steps * (0.5 * (heights[1:] + heights[:-1]) - 0.5 * size[1]).sum(axis=0)
    end = start + noise.sum(axis=1)
    end[0] += affine
    offset = 3.0 + rate * size[1] * interval  # any at the start: only the later one enters
    crossings = np.floor(end[1] / size[1])
    assert np.count_nonzero(crossings) > 100
    end[0] -= crossings * offset
    inside = end - np.floor(end / np.array(size)[:, None]) * np.array(size)[:, None]
    found = peculiar_displacement(start, inside, size=size, offset=offset % size[0], strain=rate * interval)
    wrong = found - noise.sum(axis=1)
    assert wrong[1] == pytest.approx(np.zeros(count), abs=1e-12)
    expected = rate**2 * diffusion * interval**3 / 6.0
    assert np.mean(wrong[0] ** 2) == pytest.approx(expected, rel=5.0 * math.sqrt(2.0 / count))


def test_angles_diffuse_about_their_mean_spin():
    """Discs that spin at -0.3 with D_r = 0.05: both within 4.5 errors; the spin not taken off would make it ten times
    that. Bodies' centers diffuse as they should.
    """
    world = World(
        (6.0, 5.0), count=0, bodies=40, rate=0.6, memory=0.2, seed=5, turn=math.sqrt(2.0 * 0.05 * 0.1), spin=-0.3
    )
    found = world.observed(5000).dataset()
    expected = {"diffusion_rotational_disc": 0.05, "spin_disc": -0.3, "diffusion_disc": world.diffusion}
    for name, exact in expected.items():
        error = float(found[f"{name}_error"])
        assert error < 0.1 * abs(exact)
        assert abs(float(found[name]) - exact) < 4.5 * error
    plain = found["msd_angle_disc"] + (0.3 * found["lag"]) ** 2
    assert float(plain.interp(lag=10.0)) / 20.0 > 0.4
    assert "msd_solvent" not in found


@pytest.mark.parametrize("rate", [0.0, 0.5])
def test_axes_diffuse_at_rest(rate):
    """Bodies that turn by normal rotation vectors: <e(t).e(0)> = k^(t/h) with k = (1 + 2 <cos angle>)/3, exactly; every
    lag within 5 errors and D_r = -log(k)/(2h) within 4.5; a D_r 5 % less must fail. Under shear there is none, and
    it is said why.
    """
    turn = 0.1
    world = World((6.0, 5.0, 4.0), count=0, bodies=40, rate=rate, memory=0.05, seed=6, turn=turn)
    found = world.observed(6000).dataset()
    if rate != 0.0:
        assert "diffusion_rotational_disc" not in found
        assert "turn with the flow" in found.attrs["no_diffusion_rotational_disc"]
        return
    # The angle of a normal vector has the density of Maxwell: <cos> = (1 - turn^2) exp(-turn^2/2).
    kept = (1.0 + 2.0 * (1.0 - turn**2) * math.exp(-0.5 * turn**2)) / 3.0
    exact = -math.log(kept) / (2.0 * world.step)
    value, error = float(found["diffusion_rotational_disc"]), float(found["diffusion_rotational_disc_error"])
    assert error < 0.03 * exact
    assert abs(value - exact) < 4.5 * error
    correlation = kept ** (found["lag"].values / world.step)
    assert agrees(found, "orientation_disc", correlation)
    assert agrees(found, "orientation_axes_disc", correlation[:, None])
    assert not agrees(found, "orientation_disc", correlation**0.95)


def test_a_driven_flow_leaves_x_out():
    world = World((6.0, 5.0), count=60, rate=0.0, memory=0.2, seed=7)

    def driven(moment):
        place = moment.position.copy()
        place[:, 0] = np.mod(place[:, 0] + 2.0 * moment.time, 6.0)  # a stream of velocity 2
        return replace(moment, position=place, velocity=moment.velocity + np.array([2.0, 0.0]))

    found = world.observed(3000, see=driven, driven=True).dataset()
    assert abs(float(found["diffusion_solvent"]) - world.diffusion) < 4.5 * float(found["diffusion_solvent_error"])
    assert np.isnan(found["diffusion_axes_solvent"].values[0])
    assert found["msd_solvent"].values == pytest.approx(found["msd_axes_solvent"].values[:, 1])


def test_too_short_a_run_has_no_diffusion_and_says_so():
    world = World((6.0, 5.0), count=10, rate=0.0, memory=2.0, seed=8)
    assert world.observed(10).dataset() is None
    found = world.observed(200).dataset()
    assert np.isnan(found["diffusion_solvent"].values)
    assert "too short" in found["diffusion_solvent"].attrs["no_value"]
    for name, variable in found.data_vars.items():
        assert variable.attrs["units"]
        assert name.endswith("_error") or f"{name}_error" in found


def test_a_sample_of_the_solvent_is_spread_evenly():
    """Of 70 particles 20 are followed, every 3.5th."""
    world = World((6.0, 5.0), count=70, rate=0.0, memory=math.inf, seed=9)
    made = world.observed(40, solvent_sample=20)
    chosen = np.arange(20) * 70 // 20
    expected = np.mean(np.sum(world.c[chosen] ** 2, axis=1))
    assert made.dataset()["vacf_solvent"].values[0] == pytest.approx(expected)


def test_samples_at_other_intervals_are_refused():
    world = World((6.0, 5.0), count=10, rate=0.0, memory=1.0, seed=10)
    made = world.observed(3)
    world.advance()
    with pytest.raises(ValueError, match="at steps 2 and 4"):
        made.sample(world.moment())


@pytest.mark.parametrize("size", [(6.0, 5.0), (6.0, 5.0, 4.0)])
@pytest.mark.parametrize("middle", [0, 1, 47, 300])
def test_goes_on_bit_for_bit(size, middle):
    """Saved and restored at any sample, at rest at first and sheared later, the rest leaves the same bits."""
    world = World(
        size, count=15, bodies=4, rate=lambda t: 0.8 if t > 20.0 else 0.0, memory=0.5, seed=11, turn=0.1, spin=0.2
    )
    moments = []
    for _ in range(420):
        moments.append(world.moment())
        world.advance()
    straight, first, second = (Displacement(1, len(size), 15, {"disc": 4}) for _ in range(3))
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
