"""Suspension laws: Einstein's coefficient from the Stokes flow around a sphere, the others at limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tether.theory import suspension


def flow_around_sphere(place: np.ndarray, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and pressure around a rigid sphere (disc) of radius 1 in a strain flow, solvent viscosity 1.

    u = E.x (1 - r^-(d+2)) - (d+2)/2 x (x.E.x) (r^-(d+2) - r^-(d+4)), p = -(d+2) x.E.x / r^(d+2).
    """
    dimension = place.shape[-1]
    r = np.linalg.norm(place, axis=-1, keepdims=True)
    straining = place @ strain
    quadratic = np.sum(place * straining, axis=-1, keepdims=True)
    far, near = r ** -(dimension + 2.0), r ** -(dimension + 4.0)
    velocity = straining * (1.0 - far) - 0.5 * (dimension + 2.0) * place * quadratic * (far - near)
    return velocity, (-(dimension + 2.0) * quadratic * far)[..., 0]


def gradients(field, place: np.ndarray, step: float) -> np.ndarray:
    """d field / d x_j by central differences, a new last axis j."""
    columns = []
    for axis in range(place.shape[-1]):
        shift = step * np.eye(place.shape[-1])[axis]
        columns.append((field(place + shift) - field(place - shift)) / (2.0 * step))
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("dimension", [2, 3])
def test_einstein_from_stokes_flow(dimension):
    """[eta] from the forces on a sphere's surface; first the flow is shown to solve Stokes' equations."""
    generator = np.random.default_rng(1)
    strain = np.zeros((dimension, dimension))
    strain[0, 1] = strain[1, 0] = 0.5  # the strain of unit shear rate

    def velocity(place):
        return flow_around_sphere(place, strain)[0]

    def pressure(place):
        return flow_around_sphere(place, strain)[1]

    direction = generator.standard_normal((50, dimension))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    outside = direction * generator.uniform(1.2, 3.0, (50, 1))
    divergence = np.trace(gradients(velocity, outside, 1e-4), axis1=1, axis2=2)
    laplacian = sum(
        (velocity(outside + shift) - 2.0 * velocity(outside) + velocity(outside - shift)) / 1e-6
        for shift in 1e-3 * np.eye(dimension)
    )
    np.testing.assert_allclose(divergence, 0.0, atol=1e-6)
    np.testing.assert_allclose(laplacian, gradients(pressure, outside, 1e-4), atol=1e-4)
    np.testing.assert_allclose(velocity(direction), 0.0, atol=1e-12)

    # Points spread evenly over the surface: equal angles, or Gauss-Legendre in the cosine times equal angles.
    angle = 2.0 * np.pi * (np.arange(24) + 0.5) / 24
    if dimension == 2:
        normal = np.column_stack([np.cos(angle), np.sin(angle)])
        area, volume = np.full(24, 2.0 * np.pi / 24), np.pi
    else:
        cosine, share = np.polynomial.legendre.leggauss(12)
        sine = np.sqrt(1.0 - cosine**2)
        normal = np.stack(
            [np.outer(sine, np.cos(angle)), np.outer(sine, np.sin(angle)), np.outer(cosine, np.ones(24))],
            axis=-1,
        ).reshape(-1, 3)
        area, volume = np.repeat(share, 24) * 2.0 * np.pi / 24, 4.0 * np.pi / 3.0

    gradient = gradients(velocity, normal, 1e-5)
    stress = gradient + np.swapaxes(gradient, 1, 2) - pressure(normal)[:, None, None] * np.eye(dimension)
    traction = np.einsum("kij,kj->ki", stress, normal)
    stresslet = np.sum(area * normal[:, 1] * traction[:, 0])  # of the rigid body: its y moment of the x force
    coefficient = stresslet / volume  # over viscosity 1 and shear rate 1, for unit volume fraction
    assert coefficient == pytest.approx(suspension.intrinsic_viscosity(dimension), rel=1e-5)
    assert suspension.einstein(0.01, dimension) - 1.0 == pytest.approx(0.01 * coefficient, rel=1e-5)


def test_einstein_values():
    assert suspension.einstein(0.02, 3) == pytest.approx(1.05)
    assert suspension.einstein(0.02, 2) == pytest.approx(1.04)


@pytest.mark.parametrize("dimension", [2, 3])
def test_krieger_dougherty_is_einstein_when_dilute(dimension):
    phi = 1e-6
    rise = suspension.krieger_dougherty(phi, dimension) - 1.0
    assert rise / phi == pytest.approx(suspension.intrinsic_viscosity(dimension), rel=1e-4)


def test_krieger_dougherty_values():
    """2D, phi = 0.5, phi_m = 0.91: 4.27, the number that the paper's figure 10 is compared with."""
    assert suspension.krieger_dougherty(0.5, 2) == pytest.approx(4.27, abs=0.005)
    assert suspension.krieger_dougherty(0.5, 2) == suspension.krieger_dougherty(0.5, 2, 0.91)
    assert suspension.krieger_dougherty(0.325, 3) == pytest.approx(2.0 ** (2.5 * 0.65))


def test_quemada_is_krieger_dougherty_with_power_two():
    packing = 0.8  # [eta] phi_m = 2 in 3D
    phi = np.linspace(0.0, 0.75, 20)
    np.testing.assert_allclose(suspension.quemada(phi, packing), suspension.krieger_dougherty(phi, 3, packing))


@pytest.mark.parametrize(("case", "coefficient"), [("brownian", 6.2), ("hydrodynamic", 5.2), ("extension", 7.6)])
def test_batchelor(case, coefficient):
    """Einstein's slope, then the stated second order; arrays too."""
    assert suspension.batchelor(0.1, case) == pytest.approx(1.25 + 0.01 * coefficient)
    phi = np.array([0.0, 1e-4, 1e-3])
    second = suspension.batchelor(phi, case) - suspension.einstein(phi, 3)
    np.testing.assert_allclose(second, coefficient * phi**2, atol=1e-15)


def test_batchelor_s_cases():
    """At rest unless told; no others. Brownian stress and the lack of Brownian motion both add to the viscosity."""
    assert suspension.batchelor(0.05) == suspension.batchelor(0.05, "brownian")
    assert (
        suspension.batchelor(0.05, "hydrodynamic")
        < suspension.batchelor(0.05)
        < suspension.batchelor(0.05, "extension")
    )
    with pytest.raises(ValueError, match="choose one of brownian, hydrodynamic, extension"):
        suspension.batchelor(0.05, "shear")


def test_jammed():
    curve = suspension.krieger_dougherty(np.array([0.6, 0.65, 0.7]), 3)
    assert math.isfinite(curve[0])
    assert curve[1] == curve[2] == math.inf
    assert suspension.quemada(0.9, 0.9) == math.inf


def test_numbers_give_numbers_and_arrays_arrays():
    assert isinstance(suspension.einstein(0.1, 2), float)
    assert isinstance(suspension.quemada(0.1, 0.7), float)
    assert suspension.krieger_dougherty(np.zeros((2, 3)), 3).shape == (2, 3)


@pytest.mark.parametrize("phi", [-0.1, 20.0, math.nan])
def test_no_volume_fraction(phi):
    with pytest.raises(ValueError, match="from 0 to 1"):
        suspension.einstein(phi, 3)
