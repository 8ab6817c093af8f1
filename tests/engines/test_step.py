"""One engine against the whole step written plainly: scheme, masses, shear, bodies, and what is measured on the way."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from suspensions import (
    Fluid,
    Kind,
    crooked,
    crooked_flat,
    gathered,
    kabsch,
    measured,
    pair_forces,
    spring_forces,
    suspension,
)

from tether import _core


@dataclass
class PlainBase:
    """A Newton-Euler base as the equations have it; its center may leave the box."""

    center: np.ndarray
    turned: np.ndarray  # rotation matrix
    velocity: np.ndarray
    angular_momentum: np.ndarray  # a number in 2D
    force: np.ndarray = field(default_factory=lambda: np.zeros(0))
    torque: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def kick(self, time, mass):
        self.velocity = self.velocity + time * self.force / mass
        self.angular_momentum = self.angular_momentum + time * self.torque

    def drift(self, time, moments):
        """Turns about the own axes in the order half 1, half 2, all of 3, half 2, half 1."""
        self.center = self.center + time * self.velocity
        if len(self.center) == 2:
            angle = time * self.angular_momentum / moments
            c, s = np.cos(angle), np.sin(angle)
            self.turned = np.array([[c, -s], [s, c]]) @ self.turned
            return
        for axis, share in ((0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)):
            own = self.turned.T @ self.angular_momentum
            angle = np.zeros(3)
            angle[axis] = share * time * own[axis] / moments[axis]
            self.turned = self.turned @ Rotation.from_rotvec(angle).as_matrix()


class PlainSuspension:
    """A second writing of the step, one body kind; a body's mass is that of its constituents."""

    def __init__(self, made, fluid, kind, size, *, timestep, verlet_lambda, seed, shear_rate, species_mass):
        self.fluid, self.kind, self.size = fluid, kind, np.array(size)
        self.timestep, self.verlet_lambda, self.seed, self.shear_rate = timestep, verlet_lambda, seed, shear_rate
        self.position, self.velocity = made.position, made.velocity
        self.offset, self.step = made.offset, made.step
        self.mass = np.asarray(species_mass)[made.species][:, None]
        self.site_mass = species_mass[1]
        self.first = int(np.count_nonzero(made.species == 0))
        squares = kind.sites**2
        self.moments = self.site_mass * (
            np.sum(squares) if len(size) == 2 else np.sum(squares) - np.sum(squares, axis=0)
        )
        self.bases = []
        if kind.base != "massless":
            for ids in self.bodies():
                body = gathered(self.position[ids], self.size, self.offset)
                moving = self.near_velocity(ids, body)
                center = body.mean(axis=0)
                arms = body - center
                rotating = moving - moving.mean(axis=0)
                momentum = self.site_mass * np.sum(cross(arms, rotating), axis=0)
                self.bases.append(PlainBase(center, kabsch(kind.sites, arms), moving.mean(axis=0), momentum))
        self.force = self.forces(self.velocity)

    def bodies(self):
        p = len(self.kind.sites)
        return [np.arange(p) + self.first + k * p for k in range(self.kind.count)]

    def near_velocity(self, ids, body):
        """Of the images of a body's constituents that are near its first."""
        rows = np.round((body[:, 1] - self.position[ids, 1]) / self.size[1])
        velocity = self.velocity[ids].copy()
        velocity[:, 0] += rows * self.shear_rate * self.size[1]
        return velocity

    def forces(self, velocity):
        force, self.pair_stress = pair_forces(
            self.fluid,
            self.position,
            velocity,
            self.size,
            timestep=self.timestep,
            seed=self.seed,
            step=self.step,
            shear_rate=self.shear_rate,
            offset=self.offset,
        )
        moment = np.zeros((len(self.size),) * 2)
        for k, ids in enumerate(self.bodies()):
            body = gathered(self.position[ids], self.size, self.offset)
            if not self.bases:
                spring, part = spring_forces(self.kind.sites, body, self.kind.stiffness)
            else:
                base = self.bases[k]
                arms = gathered(np.vstack([base.center, body]), self.size, self.offset)[1:] - base.center
                sites = self.kind.sites @ base.turned.T
                spring = -self.kind.stiffness * (arms - sites)
                part = arms.T @ spring
                base.force = force[ids].sum(axis=0)
                levers = sites if self.kind.torque_arms == "sites" else arms
                base.torque = np.sum(cross(levers, force[ids]), axis=0)
            force[ids] += spring
            moment += part
        self.body_stress = -moment / np.prod(self.size)
        return force

    def run(self, steps):
        dt, box = self.timestep, _core.Box2 if len(self.size) == 2 else _core.Box3
        body_mass = self.site_mass * len(self.kind.sites)
        for _ in range(steps):
            self.step += 1
            half = self.velocity + 0.5 * dt * self.force / self.mass
            predicted = half + (self.verlet_lambda - 0.5) * dt * self.force / self.mass
            self.position = self.position + dt * half
            for base in self.bases:
                base.kick(0.5 * dt, body_mass)
                base.drift(dt, self.moments)
                if self.kind.base == "newton-euler-lagged":
                    base.kick(0.5 * dt, body_mass)
            self.offset = np.mod(self.offset + self.shear_rate * self.size[1] * dt, self.size[0])
            sheared = box(list(self.size), self.shear_rate, self.offset)
            self.position, moved = sheared.wrap(self.position, half)
            self.force = self.forces(predicted + (moved - half))
            self.velocity = moved + 0.5 * dt * self.force / self.mass
            if self.kind.base == "newton-euler":
                for base in self.bases:
                    base.kick(0.5 * dt, body_mass)


def cross(a, b):
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] if a.shape[1] == 2 else np.cross(a, b)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("verlet_lambda", [0.5, 0.65])
@pytest.mark.parametrize("shear_rate", [0.0, 1.5, -1.5])
@pytest.mark.parametrize(
    ("base", "torque_arms"),
    [
        ("massless", "constituents"),
        ("newton-euler", "constituents"),
        ("newton-euler", "sites"),
        ("newton-euler-lagged", "constituents"),
    ],
)
def test_steps_are_the_plain_ones(dimension, verlet_lambda, shear_rate, base, torque_arms):
    """Ten steps of solvent and crooked bodies of another mass; state and every measured quantity agree to rounding."""
    size = [3.7, 3.4, 3.9][:dimension]
    kind = Kind(crooked_flat if dimension == 2 else crooked, 2, base, 500.0, torque_arms)
    fluid = Fluid(friction=3.0, temperature=0.6, exponent=0.5, random="gaussian")
    shared = {"timestep": 0.008, "verlet_lambda": verlet_lambda, "seed": 6, "shear_rate": shear_rate}
    masses = (1.0, 2.5)
    made = suspension(
        size, kinds=(kind,), density=4.0 if dimension == 2 else 1.5, species_mass=masses, **shared, **fluid.options
    )
    made.run(40)
    made.place()
    plain = PlainSuspension(made, fluid, kind, size, species_mass=masses, **shared)
    assert made.force == pytest.approx(plain.force, abs=1e-9)
    named = measured(made, made.run(10, 1))
    plain.run(10)
    assert made.step == plain.step == 50
    assert made.offset == pytest.approx(plain.offset, abs=1e-13)
    assert made.position == pytest.approx(plain.position, abs=1e-10)
    assert made.velocity == pytest.approx(plain.velocity, abs=1e-8)
    assert made.force == pytest.approx(plain.force, abs=1e-6)

    # What the last step measured
    for term, stress in zip(("conservative", "dissipative", "random"), plain.pair_stress, strict=True):
        assert named[f"stress_{term}"][-1] == pytest.approx(stress, abs=1e-6)
    assert named["stress_body"][-1] == pytest.approx(plain.body_stress, abs=1e-6)
    peculiar = plain.velocity.copy()
    peculiar[:, 0] -= shear_rate * (plain.position[:, 1] - 0.5 * size[1])
    energy = plain.mass * peculiar**2
    flux = (plain.mass * peculiar).T @ peculiar
    assert named["stress_kinetic"][-1] == pytest.approx(-flux / np.prod(size), abs=1e-6)
    assert named["thermal_solvent"][-1] == pytest.approx(energy[: plain.first].sum(), abs=1e-6)
    assert named["thermal_constituents"][-1] == pytest.approx(energy[plain.first :].sum(), abs=1e-6)
    assert named["momentum"][-1] == pytest.approx((plain.mass * peculiar).sum(axis=0), abs=1e-8)
    translation, rotation, spins, momenta = 0.0, 0.0, 0.0, 0.0
    for ids in plain.bodies():
        body = gathered(plain.position[ids], size, plain.offset)
        moving = plain.near_velocity(ids, body)
        center, velocity = body.mean(axis=0), moving.mean(axis=0)
        arms, rotating = body - center, moving - velocity
        drifting = velocity.copy()
        drifting[0] -= shear_rate * (center[1] - 0.5 * size[1])
        translation += masses[1] * len(ids) * drifting @ drifting
        momentum = masses[1] * np.sum(cross(arms, rotating), axis=0)
        inertia = masses[1] * (np.sum(arms**2) * np.eye(dimension) - arms.T @ arms)
        spin = momentum / (masses[1] * np.sum(arms**2)) if dimension == 2 else np.linalg.solve(inertia, momentum)
        rotation += np.dot(momentum, spin)
        spins, momenta = spins + spin, momenta + momentum
    assert named["thermal_translation"][-1] == pytest.approx(translation, abs=1e-6)
    assert named["spin_energy"][-1] == pytest.approx(rotation, abs=1e-6)
    assert named["spin"][-1] == pytest.approx(spins, abs=1e-6)
    assert named["angular_momentum"][-1] == pytest.approx(momenta, abs=1e-6)


def test_an_interval_holds_the_mean_of_its_steps():
    one, other = (suspension([4.0, 4.0], kinds=(Kind(crooked_flat, 2),), shear_rate=0.5, seed=3) for _ in range(2))
    each, means = one.run(60, 1), other.run(60, 20)
    assert means == pytest.approx(each.reshape(3, 20, -1).mean(axis=1), rel=1e-12, abs=1e-12)
