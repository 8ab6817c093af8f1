"""Moduli and Lissajous curves against exact fluids, and errors against the scatter of many runs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from tether.analysis.oscillatory import averaged_wave, lissajous, moduli

OMEGA, AMPLITUDE = 0.7, 0.4


def ends(cycles: float, samples_of_a_cycle: float, first_time: float = 0.0) -> tuple[np.ndarray, float]:
    """Ends of the intervals, and the interval, of so many cycles."""
    interval = 2.0 * math.pi / OMEGA / samples_of_a_cycle
    return first_time + interval * np.arange(1, math.floor(cycles * samples_of_a_cycle + 1e-9) + 1), interval


def means_over_steps(function, time, interval, steps):
    """Mean of a function of time over the `steps` steps of each interval, the slow way."""
    offsets = interval * (1.0 - np.arange(1, steps + 1) / steps)
    return function(time[:, None] - offsets).mean(axis=1)


def maxwell(time, viscosity=3.0, relaxation=1.3):
    """Stress of a Maxwell fluid, G' = eta tau omega^2/(1 + (omega tau)^2), G'' = eta omega/(1 + (omega tau)^2)."""
    x = OMEGA * relaxation
    return AMPLITUDE * viscosity * OMEGA / (1.0 + x**2) * (x * np.sin(OMEGA * time) + np.cos(OMEGA * time))


class TestAveragedWave:
    @pytest.mark.parametrize("steps", [1, 2, 10])
    def test_is_the_mean_over_steps(self, steps):
        time, interval = ends(3, 13)
        sine, cosine = averaged_wave(time, OMEGA, interval, steps)
        assert sine == pytest.approx(means_over_steps(lambda t: np.sin(OMEGA * t), time, interval, steps), abs=1e-13)
        assert cosine == pytest.approx(means_over_steps(lambda t: np.cos(OMEGA * t), time, interval, steps), abs=1e-13)

    def test_continuous_is_the_integral(self):
        time, interval = ends(3, 13)
        sine, cosine = averaged_wave(time, OMEGA, interval)
        begin = time - interval
        assert sine == pytest.approx((np.cos(OMEGA * begin) - np.cos(OMEGA * time)) / (OMEGA * interval), abs=1e-13)
        assert cosine == pytest.approx((np.sin(OMEGA * time) - np.sin(OMEGA * begin)) / (OMEGA * interval), abs=1e-13)


class TestModuli:
    @pytest.mark.parametrize("samples_of_a_cycle", [8, 20.37, 100])
    @pytest.mark.parametrize("steps", [1, 7])
    def test_maxwell_fluid_exactly(self, samples_of_a_cycle, steps):
        time, interval = ends(6.5, samples_of_a_cycle)
        stress = means_over_steps(maxwell, time, interval, steps)
        found = moduli(time, stress, AMPLITUDE, OMEGA, interval, steps_per_sample=steps)
        assert found.storage.value == pytest.approx(3.0 * 1.3 * OMEGA**2 / (1 + (1.3 * OMEGA) ** 2), rel=1e-10)
        assert found.loss.value == pytest.approx(3.0 * OMEGA / (1 + (1.3 * OMEGA) ** 2), rel=1e-10)
        assert found.complex_viscosity.value == pytest.approx(3.0 / math.sqrt(1 + (1.3 * OMEGA) ** 2), rel=1e-10)
        assert found.third_harmonic.value == pytest.approx(0.0, abs=1e-10)
        assert found.cycles == 6

    def test_newtonian_fluid_has_a_positive_loss_modulus_alone(self):
        """Stress positive in tension: S_xy = +eta rate."""
        time, interval = ends(5, 40)
        found = moduli(
            time, 2.5 * AMPLITUDE * OMEGA * averaged_wave(time, OMEGA, interval)[1], AMPLITUDE, OMEGA, interval
        )
        assert found.loss.value == pytest.approx(2.5 * OMEGA, rel=1e-12)
        assert found.dynamic_viscosity.value == pytest.approx(2.5, rel=1e-12)
        assert found.storage.value == pytest.approx(0.0, abs=1e-12)

    def test_elastic_solid_has_a_storage_modulus_alone(self):
        time, interval = ends(5, 40)
        found = moduli(time, 7.0 * AMPLITUDE * averaged_wave(time, OMEGA, interval)[0], AMPLITUDE, OMEGA, interval)
        assert found.storage.value == pytest.approx(7.0, rel=1e-12)
        assert found.loss.value == pytest.approx(0.0, abs=1e-12)

    def test_without_the_mean_over_the_interval_both_would_be_wrong(self):
        """Control: a fit of the waves at the intervals' ends lags by half an interval."""
        time, interval = ends(5, 20)
        stress = 2.5 * AMPLITUDE * OMEGA * averaged_wave(time, OMEGA, interval)[1]
        naive = 2.0 / (AMPLITUDE * len(time)) * np.array([np.sin(OMEGA * time), np.cos(OMEGA * time)]) @ stress
        assert naive[0] > 0.1 * 2.5 * OMEGA
        assert naive[1] < 0.99 * 2.5 * OMEGA

    def test_start_of_the_oscillation_and_cycles_skipped(self):
        time, interval = ends(6, 25, first_time=3.3)
        stress = maxwell(time - 3.3 - 0.5 * interval)
        stress[:25] *= 1e6  # a first cycle of nonsense
        with_first = moduli(time, stress, AMPLITUDE, OMEGA, interval, 3.3, steps_per_sample=1, skipped_cycles=0)
        assert abs(with_first.loss.value) > 100.0
        found = moduli(
            time, stress, AMPLITUDE, OMEGA, interval, 3.3 + 0.5 * interval, steps_per_sample=1, skipped_cycles=1
        )
        assert found.loss.value == pytest.approx(3.0 * OMEGA / (1 + (1.3 * OMEGA) ** 2), rel=1e-10)

    def test_third_harmonic(self):
        time, interval = ends(5, 40)
        sine, cosine = averaged_wave(time, OMEGA, interval)
        sine3, cosine3 = averaged_wave(time, 3.0 * OMEGA, interval)
        found = moduli(
            time, AMPLITUDE * (3 * sine + 4 * cosine + 0.3 * sine3 - 0.4 * cosine3), AMPLITUDE, OMEGA, interval
        )
        assert found.third_harmonic.value == pytest.approx(0.1, rel=1e-10)
        assert found.third_storage.value == pytest.approx(0.3, rel=1e-10)
        assert found.third_loss.value == pytest.approx(-0.4, rel=1e-10)

    def test_errors_cover(self):
        """z-scores over 200 runs of 8 cycles with correlated noise.

        chi-square of 200 z-scores per coefficient, whose own errors are uncertain by about 15 %: bands of four
        standard deviations of the mean square (0.1) and of the mean (0.07), false-alarm rate 2e-4 in all.
        """
        generator = np.random.default_rng(11)
        time, interval = ends(8, 200)
        exact = means_over_steps(maxwell, time, interval, 10)
        x = 1.3 * OMEGA
        true = {"storage": 3.0 * OMEGA * x / (1 + x**2), "loss": 3.0 * OMEGA / (1 + x**2), "third_loss": 0.0}
        noise = lfilter([1.0], [1.0, -0.6], generator.standard_normal((200, len(time) + 50)), axis=1)[:, 50:]
        runs = [moduli(time, exact + e, AMPLITUDE, OMEGA, interval, steps_per_sample=10) for e in noise]
        for name, value in true.items():
            found = [getattr(run, name) for run in runs]
            assert np.mean([e.converged for e in found]) > 0.95
            z = np.array([(e.value - value) / e.error for e in found if e.converged])
            assert abs(z.mean()) < 0.28
            assert 0.6 < (z**2).mean() < 1.5
            assert ((z + 1.0) ** 2).mean() > 1.5  # control: a bias of one error is seen

    def test_too_few_samples_or_cycles(self):
        time, interval = ends(5, 7)
        with pytest.raises(ValueError, match="shorter intervals"):
            moduli(time, time, AMPLITUDE, OMEGA, interval)
        time, interval = ends(0.9, 20)
        with pytest.raises(ValueError, match="no whole cycle"):
            moduli(time, time, AMPLITUDE, OMEGA, interval)


class TestLissajous:
    def test_curve_and_errors(self):
        """Errors are those of the mean of 40 cycles; the chi-square of 64 bins is within 5 standard deviations."""
        generator = np.random.default_rng(3)
        time, interval = ends(40, 128)
        sine, cosine = averaged_wave(time, OMEGA, interval)
        strain, rate = AMPLITUDE * sine, AMPLITUDE * OMEGA * cosine
        stress = 2.0 * strain + 3.0 * rate
        curve = lissajous(time, stress + 0.3 * generator.standard_normal(len(time)), strain, rate, OMEGA, interval)
        assert curve.sizes == {"phase": 64}
        assert curve.strain.values == pytest.approx(AMPLITUDE * np.sin(curve.phase.values), abs=2e-3 * AMPLITUDE)
        assert curve.shear_rate.values == pytest.approx(AMPLITUDE * OMEGA * np.cos(curve.phase.values), abs=1e-3)
        assert curve.strain_error.values == pytest.approx(0.0, abs=1e-12)
        assert curve.stress_error.values == pytest.approx(0.3 / math.sqrt(80), rel=0.5)
        z = (curve.stress - 2.0 * curve.strain - 3.0 * curve.shear_rate) / curve.stress_error
        assert abs((z**2).sum() - 64 * 39 / 37) < 5.0 * math.sqrt(2 * 64 * 1.2)

    def test_one_cycle_has_no_errors_and_empty_bins_are_left_out(self):
        time, interval = ends(1, 20)
        curve = lissajous(time, time, time, time, OMEGA, interval, bins=64)
        assert curve.sizes == {"phase": 20}
        assert np.isnan(curve.stress_error).all()
