"""Stokes-Einstein against the paper's Table 2; periodic images against sums over the waves of the box."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import j0

from tether.theory import diffusion


@pytest.mark.parametrize(
    ("temperature", "viscosity", "diffusivity", "radius"),
    [
        (1.0, 2.5106, 0.12, 0.1761),
        (0.5, 4.5917, 0.031, 0.1864),
        (0.25, 9.9830, 0.0071, 0.1871),
        (1.0, 2.5106, 0.046, 0.4594),
        (0.5, 4.5917, 0.011, 0.5252),
        (0.25, 9.9830, 0.00225, 0.5905),
    ],
)
def test_table_2(temperature, viscosity, diffusivity, radius):
    fluid = {"temperature": temperature, "viscosity": viscosity}
    assert diffusion.stokes_einstein_radius(diffusivity=diffusivity, **fluid) == pytest.approx(radius, abs=6e-5)
    assert diffusion.stokes_einstein_diffusivity(radius=radius, **fluid) == pytest.approx(diffusivity, rel=3e-4)


@pytest.mark.parametrize(("slip", "coefficient"), [(False, 6.0), (True, 4.0)])
def test_drag_of_stokes_flow(slip, coefficient):
    """The drag behind it: 4 pi eta a times (1 + c) for the flow u = U c'(...) that the surface condition selects.

    Outside, u = A (1 + rr)/r U + B (1 - 3 rr)/r^3 U (rr: the dyad of directions); far off the force is
    8 pi eta A. At r = a the normal component is U; stick: so is the tangential; slip: no tangential traction,
    d(u_t/r)/dr + u_n'/r = 0.
    """
    a = 0.7
    normal = [2.0 / a, -2.0 / a**3]  # of u along the axis
    if slip:
        # u_theta = -(A/r + B/r^3) sin; r d(u_theta/r)/dr + (1/r) d u_r/d theta = 0, u_r = (2A/r - 2B/r^3) cos
        other = [2.0 / a**2 - 2.0 / a**2, 4.0 / a**4 + 2.0 / a**4]
        right = [1.0, 0.0]
    else:
        other = [1.0 / a, 1.0 / a**3]
        right = [1.0, 1.0]
    strength = np.linalg.solve([normal, other], right)[0]
    mobility = diffusion.stokes_einstein_diffusivity(temperature=1.0, viscosity=1.0, radius=a, slip=slip)
    assert 1.0 / mobility == pytest.approx(8.0 * math.pi * strength)
    assert 1.0 / mobility == pytest.approx(coefficient * math.pi * a)


def waves(dimension, most):
    """Squares of the numbers of all waves of a periodic box but the even one, up to a greatest length."""
    axis = np.arange(-most, most + 1.0) ** 2
    square = sum(np.meshgrid(*[axis] * dimension, sparse=True)).ravel()
    return square[(square > 0.0) & (square <= most**2)]


@pytest.mark.parametrize("radius", [0.06, 0.1])
def test_images_of_a_sphere(radius):
    """A shell of even force, exact for a sphere: mobility = sum of (2/3) sinc^2(k a)/(eta k^2 V), k = 2 pi n/L.

    Waves beyond the greatest are an integral, with sin^2 at its mean. The next order is (4 pi/3)(a/L)^3.
    """
    most = 60
    k = 2.0 * math.pi * np.sqrt(waves(3, most))
    mobility = np.sum(2.0 / 3.0 * (np.sin(k * radius) / (k * radius)) ** 2 / k**2)
    greatest = 2.0 * math.pi * most
    mobility += 2.0 / 3.0 * 0.5 / (radius**2 * greatest) / (2.0 * math.pi**2)
    free = diffusion.stokes_einstein_diffusivity(temperature=1.0, viscosity=1.0, radius=radius)
    periodic = diffusion.periodic_diffusivity(free, temperature=1.0, viscosity=1.0, box_length=1.0)
    assert periodic + free * 4.0 * math.pi / 3.0 * radius**3 == pytest.approx(mobility, rel=5e-4)
    assert abs(free / mobility - 1.0) > 0.15  # control: without the images


@pytest.mark.parametrize("radius", [0.02, 0.05, 0.1])
def test_images_of_a_disc(radius):
    """The same in 2D with a ring: mobility = sum of J_0(k a)^2/(2 eta k^2 V); J_0^2 beyond the last at 1/(pi k a)."""
    most = 600
    k = 2.0 * math.pi * np.sqrt(waves(2, most))
    mobility = np.sum(j0(k * radius) ** 2 / (2.0 * k**2))
    mobility += 1.0 / (2.0 * math.pi * radius * 2.0 * math.pi * most) / (2.0 * math.pi)
    value = diffusion.periodic_disc_diffusivity(temperature=1.0, viscosity=1.0, radius=radius, box_length=1.0)
    assert value == pytest.approx(mobility, rel=1e-3)


def test_constant_of_the_square():
    """Hasimoto's -1.3105 for ln(L/a); by area fraction c, with ln c^(-1/2), Sangani and Acrivos's -0.738."""
    constant = diffusion.PERIODIC_SQUARE
    assert constant == pytest.approx(1.3105, abs=5e-5)
    assert 0.5 * math.log(math.pi) - constant == pytest.approx(-0.738, abs=5e-4)


def test_box_corrections():
    """3D, kT = 1 of the paper's fluid: 0.116 in a box of 10 is 0.122 in a large one; there and back again."""
    fluid = {"temperature": 1.0, "viscosity": 2.51, "box_length": np.array([10.0, 20.0])}
    large = diffusion.unbounded_diffusivity(0.116, **fluid)
    np.testing.assert_allclose(large, [0.1220, 0.1190], atol=5e-5)
    np.testing.assert_allclose(diffusion.periodic_diffusivity(large, **fluid), 0.116, rtol=1e-12)


def test_two_dimensions_have_no_stokes_einstein_law():
    with pytest.raises(ValueError, match=r"no Stokes-Einstein law in 2D .* use periodic_disc_diffusivity"):
        diffusion.stokes_einstein_diffusivity(temperature=1.0, viscosity=3.0, radius=0.4, dimension=2)
    with pytest.raises(ValueError, match="2D"):
        diffusion.stokes_einstein_radius(temperature=1.0, viscosity=3.0, diffusivity=0.04, dimension=2, slip=True)
    fluid = {"temperature": 1.0, "viscosity": 3.0, "radius": 0.4}
    small, large = diffusion.periodic_disc_diffusivity(box_length=np.array([1e3, 1e6]), **fluid)
    assert large - small == pytest.approx(math.log(1e3) / (4.0 * math.pi * 3.0), rel=1e-5)  # it never settles
    for radius in (0.0, 0.5, math.nan):
        with pytest.raises(ValueError, match="smaller than its box"):
            diffusion.periodic_disc_diffusivity(temperature=1.0, viscosity=1.0, radius=radius, box_length=1.0)


def test_other_dimensions():
    with pytest.raises(ValueError, match="4 dimensions"):
        diffusion.stokes_einstein_diffusivity(temperature=1.0, viscosity=3.0, radius=0.4, dimension=4)


def test_numbers_give_numbers_and_arrays_arrays():
    assert isinstance(diffusion.stokes_einstein_radius(temperature=1.0, viscosity=1.0, diffusivity=1.0), float)
    temperature = np.array([[0.5], [1.0]])
    many = diffusion.stokes_einstein_diffusivity(temperature=temperature, viscosity=np.ones(3), radius=0.5)
    assert many.shape == (2, 3)
