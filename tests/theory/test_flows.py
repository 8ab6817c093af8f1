"""Force-driven flows against a spectral solution of the momentum balance, and its energy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tether.theory import flows

FORCE, DENSITY, VISCOSITY, LENGTH = 0.3, 4.2, 2.5, 12.0
POSITION = (np.arange(2400) + 0.5) * LENGTH / 2400


def solved(force):
    """Velocity and stress of eta u'' + n g(y) = 0 in a periodic box, mode by mode."""
    modes = np.fft.rfft(DENSITY * force)
    wave = 2.0 * math.pi * np.fft.rfftfreq(force.size, LENGTH / force.size)
    wave[0] = math.inf
    velocity = np.fft.irfft(modes / (VISCOSITY * wave**2), force.size)
    stress = np.fft.irfft(1j * modes / wave, force.size)
    return velocity, stress


def test_reverse_poiseuille():
    force = np.where(POSITION > LENGTH / 2.0, FORCE, -FORCE)
    velocity, stress = solved(force)
    ours = flows.reverse_poiseuille_velocity(POSITION, force=FORCE, density=DENSITY, viscosity=VISCOSITY, length=LENGTH)
    np.testing.assert_allclose(ours, velocity, atol=1e-5 * velocity.max())
    ours = flows.reverse_poiseuille_stress(POSITION, force=FORCE, density=DENSITY, length=LENGTH)
    np.testing.assert_allclose(ours, stress, atol=2e-3 * stress.max())  # the spectrum rounds the corners


@pytest.mark.parametrize("periods", [1, 3])
def test_kolmogorov(periods):
    velocity, stress = solved(FORCE * np.sin(2.0 * math.pi * periods * POSITION / LENGTH))
    fluid = {"force": FORCE, "density": DENSITY, "length": LENGTH, "periods": periods}
    np.testing.assert_allclose(
        flows.kolmogorov_velocity(POSITION, viscosity=VISCOSITY, **fluid), velocity, atol=1e-12 * velocity.max() + 1e-13
    )
    np.testing.assert_allclose(flows.kolmogorov_stress(POSITION, **fluid), stress, atol=1e-12)


@pytest.mark.parametrize("flow", ["reverse_poiseuille", "kolmogorov"])
def test_stress_and_work(flow):
    """S_xy = eta du/dy; the work of the force, n g u, is the heat, S_xy du/dy, over the box."""
    driven = {"force": FORCE, "density": DENSITY, "length": LENGTH}
    velocity = getattr(flows, f"{flow}_velocity")
    step = 1e-5
    slope = (
        velocity(POSITION + step, viscosity=VISCOSITY, **driven)
        - velocity(POSITION - step, viscosity=VISCOSITY, **driven)
    ) / (2.0 * step)
    stress = getattr(flows, f"{flow}_stress")(POSITION, **driven)
    np.testing.assert_allclose(VISCOSITY * slope, stress, atol=1e-6 * stress.max())
    force = np.where(POSITION > LENGTH / 2.0, FORCE, -FORCE)
    if flow == "kolmogorov":
        force = FORCE * np.sin(2.0 * math.pi * POSITION / LENGTH)
    work = DENSITY * force * velocity(POSITION, viscosity=VISCOSITY, **driven)
    assert np.mean(work) == pytest.approx(np.mean(stress * slope), rel=1e-5)


def test_viscosities_come_back():
    driven = {"force": FORCE, "density": DENSITY, "length": LENGTH}
    velocity = flows.reverse_poiseuille_velocity(POSITION, viscosity=VISCOSITY, **driven)
    maximum, mean = velocity.max(), velocity[POSITION > LENGTH / 2.0].mean()
    assert flows.reverse_poiseuille_viscosity(maximum_velocity=maximum, **driven) == pytest.approx(VISCOSITY, rel=1e-5)
    assert flows.reverse_poiseuille_viscosity_from_mean(mean_velocity=mean, **driven) == pytest.approx(
        VISCOSITY, rel=1e-5
    )
    velocity = flows.kolmogorov_velocity(POSITION, viscosity=VISCOSITY, periods=2, **driven)
    amplitude = 2.0 * np.mean(velocity * np.sin(4.0 * math.pi * POSITION / LENGTH))
    assert flows.kolmogorov_viscosity(amplitude=amplitude, periods=2, **driven) == pytest.approx(VISCOSITY)


def test_by_hand():
    """Section 4.8: n = 4/(1 - 0.4635), g = 0.4, L = 20, maximum 3.94: an apparent viscosity of 9.46."""
    value = flows.reverse_poiseuille_viscosity(maximum_velocity=3.94, force=0.4, density=4.0 / 0.5365, length=20.0)
    assert value == pytest.approx(7.4557 * 0.4 * 25.0 / 7.88, rel=1e-4)
    assert flows.reverse_poiseuille_velocity(15.0, force=0.4, density=2.0, viscosity=5.0, length=20.0) == 2.0
    assert flows.reverse_poiseuille_velocity(5.0, force=0.4, density=2.0, viscosity=5.0, length=20.0) == -2.0
    assert flows.reverse_poiseuille_velocity(-5.0, force=0.4, density=2.0, viscosity=5.0, length=20.0) == 2.0
    assert flows.reverse_poiseuille_velocity(10.0, force=0.4, density=2.0, viscosity=5.0, length=20.0) == 0.0


def test_numbers_give_numbers_and_arrays_arrays():
    driven = {"density": 4.0, "length": 10.0}
    assert isinstance(flows.kolmogorov_viscosity(amplitude=0.1, force=0.1, **driven), float)
    assert isinstance(flows.reverse_poiseuille_stress(1.0, force=0.1, **driven), float)
    forces = np.array([[0.1], [0.2]])
    assert flows.reverse_poiseuille_stress(np.arange(3.0), force=forces, **driven).shape == (2, 3)
