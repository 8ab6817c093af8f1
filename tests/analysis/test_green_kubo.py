"""Green-Kubo viscosity of synthetic stresses whose viscosity is known exactly, and its control without the noise.

The stress of a synthetic fluid is taken step by step:

    S_i = b x_i + w_i - a y_i,    y_(i+1) = rho y_i + x_i,    x, w independent white noises of variance 1 and w^2,

the random stress b x, and a stress -a y that relaxes and remembers the noise, as the dissipative one of DPD does. From
x to S the response at zero frequency is b - a/(1 - rho), so the spectrum there is dt ((b - a/(1 - rho))^2 + w^2).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import special_ortho_group

from tether.analysis.green_kubo import green_kubo, running_integral, shear_components

DT, VOLUME, TEMPERATURE = 0.01, 50.0, 0.8


def noises(samples: int, count: int, generator: np.random.Generator, rho: float) -> tuple[np.ndarray, np.ndarray]:
    """x and y, (count, samples) each, stationary from the first sample on."""
    settle = math.ceil(12.0 / (1.0 - rho))
    x = generator.standard_normal((count, samples + settle))
    y = lfilter([0.0, 1.0], [1.0, -rho], x, axis=1)
    return x[:, settle:], y[:, settle:]


def tensor(components: np.ndarray) -> np.ndarray:
    """The traceless symmetric stress with these shear components, (n, d, d), plus a pressure."""
    d = 3 if len(components) == 5 else 2
    s = np.zeros((components.shape[1], d, d))
    s[:, 0, 1] = s[:, 1, 0] = components[0]
    s[:, 0, 0], s[:, 1, 1] = components[1], -components[1]
    if d == 3:
        s[:, 0, 2] = s[:, 2, 0] = components[2]
        s[:, 1, 2] = s[:, 2, 1] = components[3]
        third = components[4] / math.sqrt(3.0)
        s[:, 0, 0] += third
        s[:, 1, 1] += third
        s[:, 2, 2] -= 2.0 * third
    return s - 30.0 * np.eye(d)


def means(steps: np.ndarray, interval: int) -> np.ndarray:
    return steps[:, : steps.shape[1] // interval * interval].reshape(len(steps), -1, interval).mean(axis=2)


class TestComponents:
    @pytest.mark.parametrize("count", [2, 5])
    def test_are_those_of_the_tensor(self, count):
        components = np.random.default_rng(1).standard_normal((count, 20))
        assert shear_components(tensor(components)) == pytest.approx(components)

    @pytest.mark.parametrize("d", [2, 3])
    def test_squares_sum_to_half_the_traceless_contraction(self, d):
        """So the mean of the components is the average of Daivis and Evans, whatever axes were chosen."""
        stress = np.random.default_rng(2).standard_normal((20, d, d))
        symmetric = 0.5 * (stress + stress.transpose(0, 2, 1))
        traceless = symmetric - np.trace(symmetric, axis1=1, axis2=2)[:, None, None] / d * np.eye(d)
        contraction = 0.5 * np.einsum("nij,nij->n", traceless, traceless)
        assert (shear_components(stress) ** 2).sum(axis=0) == pytest.approx(contraction)

    @pytest.mark.parametrize("d", [2, 3])
    def test_are_independent_and_equal_in_an_isotropic_fluid(self, d):
        """Covariance over all axes: of one tensor in 20000 random orientations it is the unit matrix's multiple.

        Entries are uncertain by about 1 % of the diagonal: bands of five.
        """
        generator = np.random.default_rng(3)
        frames = special_ortho_group.rvs(d, size=20_000, random_state=generator)
        one = generator.standard_normal((d, d))
        components = shear_components(frames @ (one + one.T) @ frames.transpose(0, 2, 1))
        covariance = components @ components.T / 20_000
        assert covariance == pytest.approx(np.eye(len(components)) * np.trace(covariance) / len(components),
                                           abs=0.05 * covariance.max())  # fmt: skip


class TestViscosity:
    def test_coverage_and_the_control_without_the_random_stress(self):
        """12 runs of 1000 samples in 3D: white noise and a relaxation of 3 samples that it drives.

        z-scores have a mean within 1.2 and a mean square from 0.1 to 2.7 (four standard deviations about 0 and 1): a
        false-alarm rate of 2e-4. At most 3 runs have no error. The control leaves the random term out: it is more than
        4 errors too low in each run.
        """
        generator = np.random.default_rng(4)
        b, a, rho, w = 2.0, 0.2, math.exp(-1.0 / 3.0), 0.5
        true = VOLUME / (2.0 * TEMPERATURE) * DT * ((b - a / (1.0 - rho)) ** 2 + w**2)
        found = []
        for _ in range(12):
            x, y = noises(1000, 5, generator, rho)
            other = w * generator.standard_normal(x.shape) - a * y
            found.append(green_kubo(tensor(b * x + other), DT, VOLUME, TEMPERATURE).viscosity)
        z = np.array([(e.value - true) / e.error for e in found if e.converged])
        assert len(z) >= 9
        assert abs(z.mean()) < 1.2
        assert 0.1 < (z**2).mean() < 2.7
        error = np.nanmean([e.error for e in found])
        assert error < 0.15 * true
        without = green_kubo(tensor(other), DT, VOLUME, TEMPERATURE).viscosity
        assert without.value < true - 4.0 * error

    def test_intervals_change_nothing(self):
        """Means over 1 and over 12 steps of one run: the same viscosity within the run's own error, and the true one.

        A relaxation of 20 steps, 2D. Bands: four errors of the run against the true value, two between intervals.
        """
        generator = np.random.default_rng(5)
        b, a, rho = 2.0, -0.06, math.exp(-1.0 / 20.0)
        true = VOLUME / (2.0 * TEMPERATURE) * DT * (b - a / (1.0 - rho)) ** 2
        x, y = noises(24_000, 2, generator, rho)
        found = [
            green_kubo(tensor(means(b * x - a * y, steps)), DT * steps, VOLUME, TEMPERATURE).viscosity
            for steps in (1, 12)
        ]
        for estimate in found:
            assert estimate.converged
            assert abs(estimate.value - true) < 4.0 * estimate.error
            assert abs(estimate.value - found[0].value) < 2.0 * found[0].error
            assert estimate.relative_error < 0.1

    def test_white_noise_is_its_variance(self):
        """eta = V/(2 kT) h sigma^2; the band is four errors, which are 2 %."""
        components = np.random.default_rng(6).standard_normal((5, 3000))
        found = green_kubo(tensor(components), DT, VOLUME, TEMPERATURE)
        assert abs(found.viscosity.value / (VOLUME / (2 * TEMPERATURE) * DT) - 1.0) < 4 * found.viscosity.relative_error
        assert found.viscosity.relative_error < 0.05
        assert found.viscosity.inefficiency == pytest.approx(1.0, abs=0.2)
        assert found.warnings == []
        assert found.spectrum.amplitude.mean() == pytest.approx(VOLUME / (2 * TEMPERATURE) * DT, rel=0.05)
        assert (found.spectrum.weight > 0.0).sum() >= found.points

    def test_a_slow_component_beneath_the_noise_is_not_overlooked(self):
        """Half of eta from 1 % of the variance, with a memory of 50 of 10 000 samples: flagged, or within 4 errors.

        STACIE's own criterion alone gives errors of 2 % and values 30 to 50 % too low here.
        """
        generator = np.random.default_rng(7)
        rho = math.exp(-1.0 / 50.0)
        true = VOLUME / (2.0 * TEMPERATURE) * DT * (1.0 + 0.01 * (1.0 + rho) / (1.0 - rho))
        x, y = noises(10_000, 5, generator, rho)
        slow = 0.1 * math.sqrt(1.0 - rho**2) * y
        found = green_kubo(tensor(slow + generator.standard_normal(x.shape)), DT, VOLUME, TEMPERATURE)
        if found.viscosity.converged:
            assert abs(found.viscosity.value - true) < 4.0 * found.viscosity.error
        else:
            assert math.isnan(found.viscosity.error)
            assert found.warnings

    def test_a_run_too_short_for_its_relaxation_is_called_so(self):
        generator = np.random.default_rng(8)
        _, y = noises(1000, 2, generator, math.exp(-1.0 / 100.0))
        found = green_kubo(tensor(y), DT, VOLUME, TEMPERATURE)
        assert not found.viscosity.converged
        assert math.isnan(found.viscosity.error)
        assert "measure more steps" in found.warnings[0]

    def test_hardly_any_samples(self):
        for stress in (tensor(np.random.default_rng(9).standard_normal((2, 20))), np.zeros((500, 2, 2))):
            found = green_kubo(stress, DT, VOLUME, TEMPERATURE)
            assert not found.viscosity.converged
            assert len(found.warnings) == 1

    def test_wrong_arguments(self):
        with pytest.raises(ValueError, match="not samples by d by d"):
            green_kubo(np.zeros(5), DT, VOLUME, TEMPERATURE)
        with pytest.raises(ValueError, match="not finite"):
            green_kubo(np.full((200, 2, 2), math.nan), DT, VOLUME, TEMPERATURE)
        with pytest.raises(ValueError, match="positive"):
            green_kubo(np.zeros((200, 2, 2)), DT, 0.0, TEMPERATURE)


class TestRunningIntegral:
    @pytest.mark.parametrize("interval", [1, 5])
    def test_goes_from_the_white_part_to_the_viscosity(self, interval):
        """Sum over lags of the exact correlation, against 40 000 steps; bands of five errors."""
        generator = np.random.default_rng(10)
        b, a, rho = 2.0, -0.15, math.exp(-1.0 / 6.0)
        x, y = noises(40_000, 5, generator, rho)
        curve = running_integral(
            tensor(means(b * x - a * y, interval)), DT * interval, VOLUME, TEMPERATURE, longest=100 * DT
        )
        assert curve.sizes["time"] == 100 // interval
        assert curve.time.values[0] == pytest.approx(0.5 * DT * interval)
        scale = VOLUME / TEMPERATURE * DT
        final = 0.5 * scale * (b - a / (1.0 - rho)) ** 2
        assert abs(curve.viscosity.values[-1] - final) < 5.0 * curve.viscosity_error.values[-1]
        assert curve.viscosity_error.values[-1] < 0.1 * final
        if interval == 1:
            # <S_0 S_k> = a^2 rho^k/(1 - rho^2) - a b rho^(k - 1) for k > 0; b^2 + a^2/(1 - rho^2) for k = 0
            k = np.arange(1, 100)
            later = a**2 * rho**k / (1.0 - rho**2) - a * b * rho ** (k - 1)
            first = 0.5 * (b**2 + a**2 / (1.0 - rho**2))
            exact = scale * np.concatenate([[first], first + np.cumsum(later)])
            assert (np.abs(curve.viscosity.values - exact) < 5.0 * curve.viscosity_error.values).all()
            assert exact[-1] == pytest.approx(final, rel=1e-6)

    def test_correlation_by_hand(self):
        stress = np.zeros((8, 2, 2))
        stress[:, 0, 1] = stress[:, 1, 0] = [1, -1, 2, -2, 1, -1, 2, -2]
        curve = running_integral(stress, 1.0, 2.0, 1.0, longest=2.0, blocks=2)
        # Blocks are equal: (1 + 1 + 4 + 4)/4 and (-1 - 2 - 4)/3 of the first component, none of the second.
        assert curve.correlation.values == pytest.approx([2.5, -7.0 / 3.0])
        assert curve.correlation_error.values == pytest.approx([0.0, 0.0])
        assert curve.viscosity.values == pytest.approx([1.25, 1.25 - 7.0 / 3.0])

    def test_blocks_too_short(self):
        with pytest.raises(ValueError, match="fewer blocks"):
            running_integral(np.zeros((100, 2, 2)), 1.0, 1.0, 1.0, longest=4.0)
