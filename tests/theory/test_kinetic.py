"""Kinetic theory against the paper's closed forms, its Table 2, quadrature, and sampled particles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from tether.theory import kinetic


def paper_diffusivity(dimension, density, friction, temperature, cutoff):
    """Eq. 37."""
    if dimension == 2:
        return 15.0 * temperature / (4.0 * math.pi * density * friction * cutoff**2)
    return 315.0 * temperature / (64.0 * math.pi * density * friction * cutoff**3)


def paper_viscosity(dimension, density, friction, temperature, cutoff, mass):
    """Eq. 36."""
    if dimension == 2:
        return (
            15.0 * mass * temperature / (8.0 * math.pi * friction * cutoff**2)
            + 4.0 * math.pi * friction * density**2 * cutoff**4 / 315.0
        )
    return (
        315.0 * mass * temperature / (128.0 * math.pi * friction * cutoff**3)
        + 512.0 * math.pi * friction * density**2 * cutoff**5 / 51975.0
    )


@pytest.mark.parametrize("dimension", [2, 3])
def test_equations_36_and_37(dimension):
    density, friction, temperature, cutoff, mass = 3.7, 2.9, 0.6, 1.3, 1.7
    fluid = {"density": density, "friction": friction, "temperature": temperature, "cutoff": cutoff}
    assert kinetic.diffusivity(dimension=dimension, exponent=0.5, **fluid) == pytest.approx(
        paper_diffusivity(dimension, density, friction, temperature, cutoff), rel=1e-12
    )
    assert kinetic.viscosity(dimension=dimension, exponent=0.5, mass=mass, **fluid) == pytest.approx(
        paper_viscosity(dimension, density, friction, temperature, cutoff, mass), rel=1e-12
    )


@pytest.mark.parametrize(
    ("temperature", "viscosity", "diffusivity"),
    [(1.0, 2.4023, 0.0870), (0.5, 4.5000, 0.0218), (0.25, 8.9238, 0.0054)],
)
def test_table_2(temperature, viscosity, diffusivity):
    fluid = {"density": 4.0, "friction": 9.0 / (2.0 * temperature), "temperature": temperature}
    assert kinetic.viscosity(dimension=3, exponent=0.5, **fluid) == pytest.approx(viscosity, abs=6e-5)
    assert kinetic.diffusivity(dimension=3, exponent=0.5, **fluid) == pytest.approx(diffusivity, abs=6e-5)


def test_groot_and_warren():
    """w_D = (1 - r)^2 in 3D: D = 45 kT/(2 pi gamma rho), nu = D/2 + 2 pi gamma rho/1575."""
    density, friction, temperature = 3.0, 4.5, 1.0
    fluid = {"density": density, "friction": friction, "temperature": temperature}
    diffusivity = 45.0 * temperature / (2.0 * math.pi * friction * density)
    kinematic = 0.5 * diffusivity + 2.0 * math.pi * friction * density / 1575.0
    assert kinetic.diffusivity(dimension=3, exponent=2.0, **fluid) == pytest.approx(diffusivity, rel=1e-12)
    assert kinetic.viscosity(dimension=3, exponent=2.0, **fluid) == pytest.approx(density * kinematic, rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("exponent", [0.25, 1.0, 3.3])
@pytest.mark.parametrize("power", [0, 2])
def test_weight_integral_against_quadrature(dimension, exponent, power):
    cutoff = 1.4
    surface = 2.0 * math.pi if dimension == 2 else 4.0 * math.pi
    expected, _ = quad(lambda r: surface * r ** (dimension - 1 + power) * (1.0 - r / cutoff) ** exponent, 0.0, cutoff)
    result = kinetic.weight_integral(dimension=dimension, exponent=exponent, cutoff=cutoff, power=power)
    assert result == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("dimension", [2, 3])
def test_drag_and_dissipative_stress_of_sampled_pairs(dimension):
    """The law itself, -gamma w_D (e.v) e, summed over 400 000 partners strewn around a particle.

    The drag against partners at rest gives D, the stress in affine shear the dissipative viscosity: signs,
    angular averages and the half for counting pairs once, none of which quadrature of [w] would see.
    """
    exponent, density, friction, rate, temperature = 0.5, 4.0, 4.5, 0.3, 1.0
    generator = np.random.default_rng(1)
    samples = 400_000
    place = generator.uniform(-1.0, 1.0, (samples, dimension))
    distance = np.linalg.norm(place, axis=1)
    place, distance = place[distance < 1.0], distance[distance < 1.0]
    each = density * 2.0**dimension / samples  # partners in the ball that one sample stands for
    direction = place / distance[:, None]
    weight = (1.0 - distance) ** exponent

    along_x = direction[:, 0]  # v_ij = (1, 0, 0)
    force = each * np.sum(-friction * weight * along_x**2)
    diffusivity = kinetic.diffusivity(
        density=density, friction=friction, temperature=temperature, dimension=dimension, exponent=exponent
    )
    assert -temperature / force == pytest.approx(diffusivity, rel=0.01)

    approach = direction[:, 0] * rate * place[:, 1]  # e_ij . v_ij with v_ij = (rate y_ij, 0, 0)
    force_x = -friction * weight * approach * direction[:, 0]
    stress_xy = -0.5 * density * each * np.sum(place[:, 1] * force_x)  # -(1/V) sum over pairs of y F_x
    cold = 1e-12  # no kinetic part
    viscosity = kinetic.viscosity(
        density=density, friction=friction, temperature=cold, dimension=dimension, exponent=exponent
    )
    assert stress_xy / rate == pytest.approx(viscosity, rel=0.01)


@pytest.mark.parametrize("dimension", [2, 3])
def test_kinetic_viscosity_of_particles_under_drag(dimension):
    """The kinetic part: V' = -(zeta/m) V - rate V_y e_x + noise makes <V_x V_y> = -rate kT/(2 zeta).

    Solved exactly as a Lyapunov equation: A C + C A^T + 2 (zeta kT/m^2) 1 = 0, A the drift matrix.
    """
    density, friction, temperature, mass, rate = 4.0, 4.5, 1.0, 1.5, 1e-4
    fluid = {"density": density, "friction": friction, "dimension": dimension, "exponent": 0.5}
    drag = temperature / kinetic.diffusivity(temperature=temperature, **fluid)
    drift = -drag / mass * np.eye(2)
    drift[0, 1] = -rate
    identity = np.eye(2)
    system = np.kron(drift, identity) + np.kron(identity, drift)
    covariance = np.linalg.solve(system, -2.0 * drag * temperature / mass**2 * identity.ravel()).reshape(2, 2)
    stress_xy = -density * mass * covariance[0, 1]
    warm = kinetic.viscosity(temperature=temperature, mass=mass, **fluid)
    cold = kinetic.viscosity(temperature=1e-12, mass=mass, **fluid)
    assert stress_xy / rate == pytest.approx(warm - cold, rel=1e-6)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("exponent", [0.25, 0.5, 2.0, 3.3])
def test_closed_forms_of_the_documentation(dimension, exponent):
    """docs/theory/fluid.md: products of s + 1, s + 2, ... in place of the beta function."""
    density, friction, temperature, cutoff, mass = 3.7, 2.9, 0.6, 1.3, 1.7
    s = exponent
    if dimension == 2:
        spreading = temperature * (s + 1) * (s + 2) / (math.pi * density * friction * cutoff**2)
        dissipative = 0.75 * math.pi * friction * density**2 * cutoff**4 / math.prod(s + k for k in range(1, 5))
    else:
        spreading = 3 * temperature * (s + 1) * (s + 2) * (s + 3) / (8 * math.pi * density * friction * cutoff**3)
        dissipative = 3.2 * math.pi * friction * density**2 * cutoff**5 / math.prod(s + k for k in range(1, 6))
    fluid = {"density": density, "friction": friction, "temperature": temperature, "cutoff": cutoff}
    assert kinetic.diffusivity(dimension=dimension, exponent=s, **fluid) == pytest.approx(spreading, rel=1e-12)
    assert kinetic.viscosity(dimension=dimension, exponent=s, mass=mass, **fluid) == pytest.approx(
        0.5 * mass * density * spreading + dissipative, rel=1e-12
    )


def test_arrays_go_through():
    """Each element as if alone; numbers give numbers."""
    temperatures, exponents = np.array([[1.0], [0.5]]), np.array([0.5, 1.0, 2.0])
    fluid = {"density": 4.0, "friction": 9.0 / (2.0 * temperatures), "temperature": temperatures, "dimension": 3}
    for formula in (kinetic.viscosity, kinetic.diffusivity):
        many = formula(exponent=exponents, **fluid)
        assert many.shape == (2, 3)
        one = formula(density=4.0, friction=9.0, temperature=0.5, dimension=3, exponent=2.0)
        assert isinstance(one, float)
        assert many[1, 2] == pytest.approx(one, rel=1e-14)


def test_size_of_a_solvent_particle_saturates():
    """Table 2's a_eff = kT/(6 pi eta D): as kT falls at fixed noise it tends to (1/6 pi)(165/8 n), not to infinity."""
    cold = {"density": 4.0, "friction": 9.0 / 2e-4, "temperature": 1e-4, "dimension": 3, "exponent": 0.5}
    radius = 1e-4 / (6.0 * math.pi * kinetic.viscosity(**cold) * kinetic.diffusivity(**cold))
    assert radius == pytest.approx(165.0 / (6.0 * math.pi * 8.0 * 4.0), rel=1e-4)
