"""A run that starts from a frame of another flow: every velocity gets the difference of the two profiles at once."""

from __future__ import annotations

from pathlib import Path

import gsd.hoomd
import numpy as np
import pytest

import tether as tt


def simulation(flow: tt.Rest | tt.Couette, start: tt.Start | None = None) -> tt.Simulation:
    return tt.Simulation(
        box=tt.Box(8, 8), fluid=tt.Fluid(temperature=1.0), bodies=[tt.Bodies("square", count=4)], flow=flow,
        timestep=0.01, seed=3, start=start,
    )  # fmt: skip


def slope(of: tt.Simulation) -> float:
    """d(v_x)/dy by least squares; its error is sqrt(kT/(m N var(y))) = 0.025 here."""
    return float(np.polyfit(of.positions[:, 1], of.velocities[:, 0], 1)[0])


@pytest.mark.parametrize(("before", "after"), [(0.0, 1.0), (1.0, 0.0), (1.0, -2.0)])
def test_the_profile_is_that_of_the_new_flow(tmp_path: Path, before: float, after: float) -> None:
    """Five standard errors: a false alarm in 2 million."""
    flows = [tt.Couette(shear_rate=rate) if rate else tt.Rest() for rate in (before, after)]
    simulation(flows[0]).run(steps=200, out=tmp_path / "before")
    started = simulation(flows[1], tt.Start(file=str(tmp_path / "before" / "trajectory.gsd")))
    assert slope(started) == pytest.approx(after, abs=0.13)
    assert started.kinetic_temperature() == pytest.approx(1.0, abs=0.3)
    peculiar = started.velocities
    peculiar[:, 0] -= after * (started.positions[:, 1] - 4)
    assert np.abs(peculiar.mean(axis=0)).max() < 1e-12


def test_a_frame_that_does_not_tell_its_flow_gives_positions_only(tmp_path: Path) -> None:
    simulation(tt.Couette(shear_rate=5.0)).run(steps=50, out=tmp_path / "before")
    with gsd.hoomd.open(str(tmp_path / "before" / "trajectory.gsd")) as frames:
        frame = frames[-1]
    frame.log = {}
    with gsd.hoomd.open(str(tmp_path / "foreign.gsd"), "w") as frames:
        frames.append(frame)
    started = simulation(tt.Rest(), tt.Start(file=str(tmp_path / "foreign.gsd")))
    assert slope(started) == pytest.approx(0.0, abs=0.13)


def test_a_box_of_another_kind_is_refused(tmp_path: Path) -> None:
    simulation(tt.Rest()).run(steps=20, out=tmp_path / "before")
    with gsd.hoomd.open(str(tmp_path / "before" / "trajectory.gsd")) as frames:
        frame = frames[-1]
    frame.configuration.box = [8, 8, 0, 0, 0.1, 0]
    with gsd.hoomd.open(str(tmp_path / "foreign.gsd"), "w") as frames:
        frames.append(frame)
    with pytest.raises(tt.InputError, match="a box of another kind"):
        simulation(tt.Rest(), tt.Start(file=str(tmp_path / "foreign.gsd"))).place()
