"""Viscosities by momentum balance from exact profiles, and their errors from noisy ones."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.signal import lfilter

from tether.analysis.momentum_balance import (
    kolmogorov_viscosity,
    local_viscosity,
    stress_at_edges,
    stress_of_force,
    viscosity_of_modes,
    wave_amplitude,
    work_viscosity,
)

L, BINS, ETA, FORCE = 12.0, 48, 3.1, 0.4
WIDTH = L / BINS
EDGES = np.linspace(0.0, L, BINS + 1)


def bin_means(function) -> np.ndarray:
    return np.array([quad(function, a, b)[0] / WIDTH for a, b in pairwise(EDGES)])


def rows(profile: np.ndarray, count: int = 3) -> np.ndarray:
    return np.tile(profile, (count, 1))


def wave(periods: int) -> tuple[np.ndarray, np.ndarray]:
    """Force density n g sin(k y) and the velocity n g/(eta k^2) sin(k y) of a Newtonian fluid."""
    k = 2.0 * math.pi * periods / L
    return (
        bin_means(lambda y: FORCE * math.sin(k * y)),
        bin_means(lambda y: FORCE / (ETA * k**2) * math.sin(k * y)),
    )


def reverse_poiseuille() -> tuple[np.ndarray, np.ndarray]:
    """-f below and +f above the middle; the velocity is -+ f/(2 eta) y (h - y) in the halves of height h."""
    h = 0.5 * L

    def velocity(y: float) -> float:
        return math.copysign(FORCE / (2.0 * ETA) * (y % h) * (h - y % h), y - h)

    return np.where(EDGES[:-1] < h, -FORCE, FORCE), bin_means(velocity)


class TestStress:
    def test_is_minus_the_integral_of_the_force(self):
        k = 2.0 * math.pi / L
        force, _ = wave(1)
        assert stress_at_edges(L, force) == pytest.approx(FORCE / k * np.cos(k * EDGES[1:]), abs=1e-12)
        exact = bin_means(lambda y: FORCE / k * math.cos(k * y))
        assert stress_of_force(L, force) == pytest.approx(exact, abs=(k * WIDTH) ** 2 / 12.0 * FORCE / k * 1.01)

    def test_has_the_sign_of_the_rate(self):
        """S_xy = +eta du/dy, whatever the sign of the force."""
        for force, velocity in (wave(2), reverse_poiseuille()):
            rate = (np.roll(velocity, -1) - velocity) / WIDTH
            stress = stress_at_edges(L, force)
            assert stress == pytest.approx(ETA * rate, abs=0.03 * np.abs(stress).max())

    def test_reverse_poiseuille_is_linear_in_each_half(self):
        force, _ = reverse_poiseuille()
        exact = FORCE * (np.minimum(EDGES[1:], L - EDGES[1:]) - 0.25 * L)
        assert stress_at_edges(L, force) == pytest.approx(exact, abs=1e-12)
        assert stress_of_force(L, force).mean() == pytest.approx(0.0, abs=1e-14)

    def test_a_mean_force_makes_no_stress_and_rows_go_one_by_one(self):
        force, _ = wave(1)
        both = stress_of_force(L, np.stack([force, force + 7.0]))
        assert both[1] == pytest.approx(both[0], abs=1e-12)
        assert both[0] == pytest.approx(stress_of_force(L, force))


class TestExactProfiles:
    @pytest.mark.parametrize("periods", [1, 2, 5])
    def test_kolmogorov(self, periods):
        force, velocity = wave(periods)
        assert kolmogorov_viscosity(L, rows(force), rows(velocity), periods).value == pytest.approx(ETA, rel=1e-10)
        assert wave_amplitude(L, force, periods) == pytest.approx(FORCE, rel=1e-10)
        k = 2.0 * math.pi * periods / L
        found = viscosity_of_modes(k, np.full(5, FORCE), np.full(5, FORCE / (ETA * k**2)))
        assert found.value == pytest.approx(ETA, rel=1e-12)

    def test_kolmogorov_is_the_ratio_of_first_harmonics_in_an_uneven_fluid(self):
        """Density and viscosity depend on y; the rate's harmonic from a solution of the balance by quadrature."""
        k = 2.0 * math.pi / L

        def eta(y: float) -> float:
            return ETA * (1.0 + 0.3 * math.cos(2.0 * k * y))

        def density(y: float) -> float:
            return 4.0 * (1.0 + 0.2 * math.cos(2.0 * k * y))

        fine = (np.arange(4800) + 0.5) * L / 4800
        f = np.array([0.1 * density(y) * math.sin(k * y) for y in fine])
        stress = -np.cumsum(f) * L / 4800
        stress += 0.5 * f * L / 4800  # at the middles
        stress -= stress.mean()
        rate = stress / np.array([eta(y) for y in fine])
        u = np.cumsum(rate) * L / 4800 - 0.5 * rate * L / 4800
        expected = (stress @ np.cos(k * fine)) / (rate @ np.cos(k * fine))
        force, velocity = (a.reshape(BINS, -1).mean(axis=1) for a in (f, u - u.mean()))
        assert kolmogorov_viscosity(L, rows(force), rows(velocity)).value == pytest.approx(expected, rel=2e-4)
        # and the one from the power is the harmonic mean weighted with the stress squared
        expected = (stress @ stress) / (stress @ rate)
        bias = (k * WIDTH) ** 2 / 12.0
        assert work_viscosity(L, rows(force), rows(velocity)).value == pytest.approx(expected * (1 - bias), rel=5e-4)

    def test_poiseuille(self):
        force, velocity = reverse_poiseuille()
        assert work_viscosity(L, rows(force), rows(velocity)).value == pytest.approx(ETA, rel=1e-10)
        upper = velocity[BINS // 2 :].mean()
        assert FORCE * (0.5 * L) ** 2 / (12.0 * upper) == pytest.approx(ETA, rel=1e-10)

    def test_a_frame_that_moves_and_a_mean_force_change_nothing(self):
        force, velocity = reverse_poiseuille()
        found = work_viscosity(L, rows(force + 0.3), rows(velocity + 5.0))
        assert found.value == pytest.approx(ETA, rel=1e-10)
        force, velocity = wave(1)
        found = kolmogorov_viscosity(L, rows(force + 0.3), rows(velocity + 5.0))
        assert found.value == pytest.approx(ETA, rel=1e-10)

    def test_local(self):
        force, velocity = reverse_poiseuille()
        found = local_viscosity(L, rows(force), rows(velocity))
        known = np.isfinite(found.viscosity.values)
        assert 0.7 * BINS < known.sum() < BINS
        smooth = known & (np.abs(np.abs(found.y.values - 0.5 * L) - 0.25 * L) < 0.2 * L)  # not at the force's jumps
        assert found.viscosity.values[smooth] == pytest.approx(ETA, rel=1e-9)


class TestErrors:
    def test_cover(self):
        """z-scores over 100 runs of 1000 rows of noise that is correlated between bins and in time.

        The error's own uncertainty is about 12 %. Bands of four standard deviations on the mean (0.1) and on the mean
        square (0.15): false-alarm rate 3e-4 in all. Control: rows shuffled in time, whose error is too small.
        """
        generator = np.random.default_rng(8)
        z = {"kolmogorov": [], "work": [], "shuffled": []}
        for _ in range(100):
            noise = lfilter([1.0], [1.0, -0.6], generator.standard_normal((2, 1050, BINS)), axis=1)[:, 50:]
            noise = 0.3 * (noise + np.roll(noise, 1, axis=2))
            force, velocity = wave(1)
            f, u = force + 0.1 * noise[0], velocity + noise[1]
            order = generator.permutation(1000)
            parabola_force, parabola = reverse_poiseuille()
            for name, found in (
                ("kolmogorov", kolmogorov_viscosity(L, f, u)),
                ("shuffled", kolmogorov_viscosity(L, f[order], u[order])),
                ("work", work_viscosity(L, parabola_force + 0.1 * noise[0], parabola + noise[1])),
            ):
                if found.converged:
                    z[name].append((found.value - ETA) / found.error)
        for route in ("kolmogorov", "work"):
            assert len(z[route]) > 90
            assert abs(np.mean(z[route])) < 0.5
            assert 0.5 < np.mean(np.square(z[route])) < 1.8
        assert np.mean(np.square(z["shuffled"])) > 3.0

    def test_shapes(self):
        with pytest.raises(ValueError, match="rows of samples"):
            work_viscosity(L, np.zeros(5), np.zeros(5))
        with pytest.raises(ValueError, match="rows of samples"):
            kolmogorov_viscosity(L, np.zeros((5, 4)), np.zeros((5, 3)))
