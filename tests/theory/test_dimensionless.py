"""Peclet, Reynolds and Mach numbers against the paper's own, and where their ingredients come from."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from tether.bodies import Bodies
from tether.box import Box
from tether.config import Configuration, Reference, Run
from tether.flows import Couette, Rest
from tether.fluid import Fluid
from tether.theory.dimensionless import dimensionless, peclet


def configuration(dimension=3, temperature=1.0, rate=0.1, bodies=None, fluid=None, reference=None):
    if bodies is None:
        bodies = [Bodies(shape="cube" if dimension == 3 else "square", count=5)]
    return Configuration(
        seed=1,
        box=Box(20, 12, 10) if dimension == 3 else Box(20, 12),
        fluid=fluid or Fluid(temperature=temperature),
        bodies=bodies,
        flow=Couette(shear_rate=rate) if rate else Rest(),
        run=Run(timestep=0.005, steps=1000),
        reference=reference or Reference(),
    )


@pytest.mark.parametrize(
    ("dimension", "temperature", "rate", "printed"),
    [(2, 1.0, 0.05, 0.18), (2, 0.5, 0.01, 0.13), (3, 0.5, 0.0075, 0.27)],
)
def test_peclet_of_the_captions(dimension, temperature, rate, printed):
    """Captions of figures 10 and 11. (In 2D they are the source of D_0. 3D, kT = 1 has 0.07, not 0.08.)"""
    result = dimensionless(configuration(dimension, temperature, rate))
    assert result.peclet == pytest.approx(printed, rel=0.04)


def test_peclet_of_numbers():
    """Eq. 18 with Tables 1 and 2: 3D at kT = 0.5 and 1, figure 11's rates. The sign of the rate is left out."""
    pe = peclet(np.array([-0.0075, 0.01]), np.array([0.64, 0.605]), np.array([0.011, 0.046]))
    np.testing.assert_allclose(pe, [0.279, 0.0796], atol=5e-4)
    assert isinstance(peclet(0.1, 0.5, 0.02), float)
    assert peclet(0.1, 0.5, 0.02) == pytest.approx(1.25)


@pytest.mark.parametrize(("dimension", "temperature", "printed"), [(2, 1.0, 1.02), (3, 1.0, 2.91), (3, 0.5, 1.78)])
def test_reynolds_of_section_4_6_is_half_of_the_particles(dimension, temperature, printed):
    """The ranges' upper ends, at rate 10: they are not rho v L/eta with L the channel's width."""
    result = dimensionless(configuration(dimension, temperature, 10.0))
    assert result.particle_reynolds / 2.0 == pytest.approx(printed, rel=0.015)
    assert result.reynolds / result.particle_reynolds == pytest.approx(12.0 / result.radius.value)


@pytest.mark.parametrize(("dimension", "temperature", "printed"), [(2, 1.0, 0.87), (2, 0.5, 0.98), (3, 0.5, 1.58)])
def test_mach_of_section_4_6(dimension, temperature, printed):
    """Upper ends of the ranges, at rate 10. (3D, kT = 1 has 1.35: a sound faster than in the others.)"""
    assert dimensionless(configuration(dimension, temperature, 10.0)).mach == pytest.approx(printed, rel=0.03)


def test_by_hand():
    reference = Reference(radius=0.5, diffusivity=0.02, viscosity=2.0, sound_speed=5.0)
    result = dimensionless(configuration(rate=-0.3, reference=reference), pressure=33.0)
    assert result.peclet == pytest.approx(0.3 * 0.5**2 / 0.02)
    assert result.reynolds == pytest.approx(4.0 * 0.3 * 0.5 * 12.0 / 2.0)
    assert result.particle_reynolds == pytest.approx(4.0 * 0.3 * 0.5**2 / 2.0)
    assert result.mach == pytest.approx(0.3 * 0.5 / 5.0)
    for quantity in (result.radius, result.diffusivity, result.viscosity, result.sound_speed):
        assert "given as reference." in quantity.source


def test_other_fluids_are_estimated_and_say_so():
    fluid = Fluid(density=3.0, repulsion=25.0, friction=4.5, temperature=1.0, exponent=2.0)
    result = dimensionless(configuration(fluid=fluid))
    assert result.radius.value == pytest.approx((3.0 * 8.0 / 3.0 / (4.0 * math.pi)) ** (1.0 / 3.0))
    assert result.viscosity.value == pytest.approx(45.0 / (4.0 * math.pi * 4.5) + 2.0 * math.pi * 4.5 * 9.0 / 1575.0)
    assert result.diffusivity.value == pytest.approx(
        1.0 / (6.0 * math.pi * result.viscosity.value * result.radius.value)
    )
    assert result.sound_speed.value == pytest.approx(math.sqrt(1.0 + 2.0 * 0.101 * 25.0 * 3.0))
    for quantity in (result.radius, result.diffusivity, result.viscosity, result.sound_speed):
        assert quantity.source.startswith("estimate")


def test_other_bodies_in_the_paper_s_fluid():
    result = dimensionless(configuration(bodies=[Bodies(shape="octahedron", count=3)]))
    assert result.viscosity.value == 2.5106
    assert result.radius.source.startswith("estimate")
    assert result.diffusivity.source.startswith("estimate")


@pytest.mark.parametrize(
    ("keys", "radius"),
    [({"shape": "sphere", "radius": 1.0}, 1.0), ({"shape": "cube", "effective_radius": 0.8}, 0.8)],
)
def test_bodies_that_state_their_size(keys, radius):
    result = dimensionless(configuration(bodies=[Bodies(count=3, **keys)]), pressure=33.0)
    assert result.radius.value == pytest.approx(radius)
    assert "effective radius" in result.radius.source
    assert result.mach is not None


def test_largest_of_several_shapes():
    both = [Bodies(shape="octahedron", count=3), Bodies(shape="cube", spacing=0.3, count=3)]
    alone = dimensionless(configuration(bodies=both[1:]))
    assert dimensionless(configuration(bodies=both)).radius == alone.radius
    assert dimensionless(configuration(bodies=both[::-1])).peclet == alone.peclet


def test_no_diffusivity_in_two_dimensions():
    result = dimensionless(configuration(dimension=2, temperature=0.25))
    assert result.peclet is None
    assert "Stokes-Einstein" in result.diffusivity.source
    assert result.mach is not None


def test_measured_pressure():
    """Of the plain fluid, 32.68, its sound speed; with bodies all particles count, with their mean mass."""
    plain = dimensionless(configuration(bodies=[]), pressure=32.68)
    assert plain.sound_speed.value == pytest.approx(math.sqrt(15.34))
    heavy = dimensionless(configuration(bodies=[Bodies(shape="cube", count=100, mass=3.0)]), pressure=40.0)
    density = (9600 + 800) / 2400.0
    mass = (9600 + 3.0 * 800) / (9600 + 800)
    expected = math.sqrt((1.0 + 2.0 * (40.0 - density) / density) / mass)
    assert heavy.sound_speed.value == pytest.approx(expected)
    assert "measured" in heavy.sound_speed.source


def test_senseless_pressure_is_not_used():
    for pressure in (math.nan, -100.0):
        assert dimensionless(configuration(), pressure=pressure) == dimensionless(configuration())


def test_without_friction():
    result = dimensionless(configuration(fluid=Fluid(friction=0.0, temperature=1.0)))
    assert (result.viscosity.value, result.peclet, result.reynolds) == (None, None, None)
    assert result.mach is not None


@pytest.mark.parametrize("case", [{"rate": 0.0}, {"bodies": []}])
def test_null_at_rest_and_without_bodies(case):
    result = dimensionless(configuration(**case))
    assert (result.peclet, result.reynolds, result.particle_reynolds, result.mach) == (None,) * 4
    assert result.viscosity.value == 2.5106


def test_dictionary_is_json():
    written = json.loads(json.dumps(dimensionless(configuration()).as_dict()))
    numbers, quantities = list(written)[:4], list(written)[4:]
    assert numbers == ["peclet", "reynolds", "particle_reynolds", "mach"]
    assert quantities == ["radius", "diffusivity", "viscosity", "sound_speed"]
    assert all(set(written[name]) == {"value", "source"} for name in quantities)
    assert written["radius"]["value"] == 0.605
