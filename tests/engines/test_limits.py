"""Extremes of box and time step."""

from __future__ import annotations

import math

import numpy as np
import pytest

import tether as tt


def test_a_sparse_box_is_not_filled_with_cells() -> None:
    """A thousand particles in 10^12 cells of one cutoff: memory would not do."""
    simulation = tt.Simulation(
        box=tt.Box(1e4, 1e4, 1e4), fluid=tt.Fluid(temperature=1.0, density=1e-9), timestep=0.01, seed=1
    )
    simulation.run(steps=20)
    assert np.isfinite(simulation.positions).all()


def test_a_sparse_box_finds_its_pairs() -> None:
    """Two particles in reach of each other, across a far corner, repel."""
    simulation = tt.Simulation(
        box=tt.Box(50, 50, 50), fluid=tt.Fluid(temperature=1e-6, density=2 / 50**3, noise=0.0), timestep=0.01, seed=1
    )
    simulation.place()
    engine = simulation.engine
    engine.position = np.array([[0.1, 0.1, 0.1], [49.8, 49.9, 0.0]])
    engine.velocity = np.zeros((2, 3))
    engine.place()
    assert engine.force[0] @ engine.force[0] > 0
    assert (engine.force[0] > 0).all()
    assert engine.force[0] == pytest.approx(-engine.force[1], abs=0)


def test_a_runaway_in_the_last_step_is_seen() -> None:
    """A particle of which the last step's forces make a runaway is reported then, not by whoever goes on from there."""
    simulation = tt.Simulation(box=tt.Box(5, 5), fluid=tt.Fluid(temperature=1.0), flow=tt.Rest(), timestep=0.01, seed=1)
    simulation.place()
    engine = simulation.engine
    force = engine.force
    engine.run(1)
    assert engine.fault is None
    velocity = engine.velocity
    velocity[3, 0] = math.nan  # as if the last half kick had done it
    engine.velocity = velocity
    engine.force = np.zeros_like(force)
    engine.run(0)
    assert engine.fault is not None
    assert engine.fault[1] == 3


@pytest.mark.parametrize("cutoff", [0.1, 0.3, 0.7])
def test_a_side_of_three_cutoffs_however_it_rounds(cutoff: float) -> None:
    side = 3 * cutoff
    for size in (side, float(f"{side:.12g}")):
        tt.Simulation(
            box=tt.Box(size, size), fluid=tt.Fluid(temperature=1.0, cutoff=cutoff, density=20 / side**2), timestep=0.001
        ).run(steps=5)


def test_fewer_than_two_particles_and_more_than_255_kinds_are_refused() -> None:
    with pytest.raises(tt.InputError, match="makes 1 particle"):
        tt.Simulation(box=tt.Box(3, 3, 3), fluid=tt.Fluid(temperature=1.0, density=0.037), timestep=0.01)
    with pytest.raises(tt.InputError, match="at most 255 kinds"):
        tt.Simulation(
            box=tt.Box(30, 30),
            fluid=tt.Fluid(temperature=1.0),
            timestep=0.01,
            bodies=[tt.Bodies("square", count=1)] * 256,
        )
