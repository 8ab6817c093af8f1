"""Superposed repulsion: the slope of its energy, its symmetry, and what a body of very many sites would do."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from tether import shapes
from tether.theory.superposition import anisotropy, radial_repulsion, summed_repulsion

SHAPES = {
    "triangle": shapes.triangle(0.25),
    "square": shapes.square(0.25),
    "octahedron": shapes.octahedron(0.25),
    "cube": shapes.cube(0.25),
}


def sites_of(name):
    return np.asarray(SHAPES[name].sites)


def ring(count, radius):
    angle = 2.0 * math.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def energy(points, sites, repulsion, cutoff):
    """Sum of a r_c/2 (1 - r_i/r_c)^2, whose negative gradient is the conservative force."""
    distance = np.linalg.norm(points[:, None] - sites, axis=-1)
    return np.sum(0.5 * repulsion * cutoff * np.maximum(1.0 - distance / cutoff, 0.0) ** 2, axis=-1)


@pytest.mark.parametrize("name", SHAPES)
def test_radial_force_is_the_slope_of_the_energy(name):
    """Around a body that is not at the origin, inside and out, some sites beyond the cutoff."""
    generator = np.random.default_rng(2)
    center = generator.uniform(-1.0, 1.0, sites_of(name).shape[1])
    sites = sites_of(name) + center
    outward = generator.standard_normal((200, center.size))
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    radius = generator.uniform(0.05, 1.6, (200, 1))
    step = 1e-6
    beyond = energy(center + (radius + step) * outward, sites, 18.75, 1.2)
    before = energy(center + (radius - step) * outward, sites, 18.75, 1.2)
    force = radial_repulsion(center + radius * outward, sites, repulsion=18.75, cutoff=1.2)
    np.testing.assert_allclose(force, -(beyond - before) / (2.0 * step), atol=1e-4)


def test_one_site():
    """Both are the law itself: a (1 - r/r_c), outward; nothing at the cutoff and beyond."""
    points = np.array([[0.3, 0.0], [0.0, -0.6], [1.5, 0.0], [0.9, 1.2]])
    expected = 2.0 * np.array([0.8, 0.6, 0.0, 0.0])
    for field in (summed_repulsion, radial_repulsion):
        np.testing.assert_allclose(field(points, np.zeros((1, 2)), repulsion=2.0, cutoff=1.5), expected, atol=1e-12)


def test_by_hand():
    """Two sites at +-(0.3, 0): at (0, 0.4) each is 0.5 away, its direction 0.8 outward; at a site, the other alone."""
    sites = np.array([[0.3, 0.0], [-0.3, 0.0]])
    assert summed_repulsion(np.array([0.0, 0.4]), sites, repulsion=10.0) == pytest.approx(10.0)
    assert radial_repulsion(np.array([0.0, 0.4]), sites, repulsion=10.0) == pytest.approx(8.0)
    assert radial_repulsion(np.array([0.3, 0.0]), sites, repulsion=10.0) == pytest.approx(4.0)
    assert radial_repulsion(np.array([0.1, 0.0]), sites, repulsion=10.0) == pytest.approx(6.0 - 8.0)
    assert radial_repulsion(np.zeros(2), sites) == 0.0


@pytest.mark.parametrize(("name", "order"), [("triangle", 3), ("square", 4)])
def test_symmetry(name, order):
    """Turned by 1/p of a turn the fields are the same; by half as much (control) they are not."""
    points = ring(7, 0.35) + 0.02
    for field in (summed_repulsion, radial_repulsion):
        values = {}
        for parts in (order, 2 * order):
            angle = 2.0 * math.pi / parts
            turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
            values[parts] = field(points @ turn.T, sites_of(name))
        np.testing.assert_allclose(values[order], field(points, sites_of(name)), rtol=1e-12)
        assert np.max(np.abs(values[2 * order] - field(points, sites_of(name)))) > 1e-3


def test_many_sites_are_round():
    """A ring of 400 sites has no anisotropy, and the integral over a circle as its value."""
    sites = ring(400, 0.25)
    radius = np.array([0.0, 0.5, 0.7])
    np.testing.assert_allclose(anisotropy(radius, sites, field=summed_repulsion), 0.0, atol=1e-12)

    def distance(angle):
        return math.hypot(0.5 - 0.25 * math.cos(angle), 0.25 * math.sin(angle))

    def outward(angle):
        return (1.0 - distance(angle)) * (0.5 - 0.25 * math.cos(angle)) / distance(angle)

    for field, each in ((summed_repulsion, lambda angle: 1.0 - distance(angle)), (radial_repulsion, outward)):
        value = field(np.array([0.5, 0.0]), sites) / 400
        assert value == pytest.approx(quad(each, 0.0, math.pi)[0] / math.pi, rel=1e-9)


@pytest.mark.parametrize("name", SHAPES)
def test_the_paper_s_bodies_are_round_from_some_distance_on(name):
    """Section 4.1: at 0.4 from the center and beyond, the radial force varies by less than 4 % of its mean.

    Nearer it does not: at 0.2, between the sites and the first neighbors, it varies by 15 % or more.
    """
    sites = sites_of(name)
    far, near = anisotropy(np.array([0.4, 0.5, 0.6]), sites), anisotropy(0.2, sites)
    assert np.all(far < 0.04)
    assert near > 0.15
    shifted = sites + 0.7
    np.testing.assert_allclose(anisotropy(np.array([0.4, 0.5, 0.6]), shifted), far, rtol=1e-9)


def test_anisotropy_by_hand():
    """Two sites: greatest along the line across them, least along them, at r = 0.4: 2 x 0.5 and 0.9 + 0.3."""
    sites = np.array([[0.3, 0.0], [-0.3, 0.0]])
    spread = anisotropy(0.4, sites, field=summed_repulsion, directions=4)
    assert spread == pytest.approx((0.9 + 0.3 - 1.0) / 1.1)


def test_out_of_reach():
    assert math.isnan(anisotropy(2.0, sites_of("square")))
    assert summed_repulsion(np.array([2.0, 0.0]), sites_of("square")) == 0.0


def test_shapes_of_results():
    sites = sites_of("cube")
    assert isinstance(summed_repulsion(np.zeros(3), sites), float)
    assert radial_repulsion(np.zeros((4, 5, 3)), sites).shape == (4, 5)
    assert isinstance(anisotropy(0.4, sites), float)
    assert anisotropy(np.full((2, 2), 0.4), sites).shape == (2, 2)
