"""The trajectory as gsd, freud and a next run read it."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import freud
import gsd.hoomd
import numpy as np
import pytest

import tether as tt
from tether import _core
from tether.files.trajectory import cut, velocity_profile


def last_frame(folder: Path) -> Any:
    """The last frame of a run."""
    with gsd.hoomd.open(str(folder / "trajectory.gsd")) as frames:
        return frames[-1]


def test_frames_hold_what_was_asked_for(sheared: Any) -> None:
    simulation, d = sheared.simulation, sheared.simulation.configuration.dimension
    with gsd.hoomd.open(str(sheared.folder / "trajectory.gsd")) as frames:
        assert [frame.configuration.step for frame in frames] == [0, *range(30, 101, 10)]
    frame = last_frame(sheared.folder)
    assert frame.configuration.dimensions == d
    size = simulation.configuration.box.size
    assert frame.configuration.box[: len(size)] == pytest.approx(size)
    assert frame.configuration.box[2] == (0.0 if d == 2 else 4.0)
    assert list(frame.configuration.box[4:]) == [0.0, 0.0]
    shapes = ["square", "triangle"] if d == 2 else ["cube", "octahedron"]
    assert frame.particles.types == ["solvent", *shapes]
    assert np.array_equal(frame.particles.typeid, simulation.species)
    assert np.array_equal(frame.particles.mass, simulation.masses)
    assert set(frame.particles.mass) == {1.0, 2.0}
    assert np.array_equal(frame.particles.body, simulation.body_index)
    assert frame.particles.velocity[:, :d] == pytest.approx(simulation.velocities, rel=1e-6, abs=1e-6)
    if d == 2:
        assert not frame.particles.position[:, 2].any()
        assert not frame.particles.velocity[:, 2].any()


def test_the_tilt_is_the_offset_within_half_a_box(sheared: Any) -> None:
    """Total strain 0.5 of a box 5 high: the image above has moved by 2.5 of 6."""
    frame = last_frame(sheared.folder)
    assert frame.configuration.box[3] * 5 == pytest.approx(2.5, abs=1e-6)
    with gsd.hoomd.open(str(sheared.folder / "trajectory.gsd")) as frames:
        for each in frames:
            assert each.configuration.box[3] == pytest.approx(each.configuration.step * 0.005, abs=1e-6)


def test_the_tilt_turns_over_at_half_a_box() -> None:
    from tether.files.trajectory import _frame

    simulation = tt.Simulation(
        box=tt.Box(4, 4), fluid=tt.Fluid(temperature=1.0), flow=tt.Couette(shear_rate=-1.0), timestep=0.01
    )
    simulation.run(steps=60)
    assert _frame(simulation).configuration.box[3] * 4 == pytest.approx(-2.4 + 4)
    assert -0.5 <= _frame(simulation).configuration.box[3] <= 0.5


def test_particles_are_inside_the_tilted_box(sheared: Any) -> None:
    with gsd.hoomd.open(str(sheared.folder / "trajectory.gsd")) as frames:
        for frame in frames:
            lx, ly, lz, tilt = (float(side) for side in frame.configuration.box[:4])
            at = frame.particles.position.astype(np.float64)
            fraction = np.column_stack([(at[:, 0] - tilt * at[:, 1]) / lx, at[:, 1] / ly, at[:, 2] / (lz or 1.0)])
            assert np.abs(fraction).max() <= 0.5 + 1e-6


def test_freud_finds_the_pairs_that_the_engine_finds(sheared: Any) -> None:
    """Distances in the tilted box are those in the sheared one."""
    simulation, frame = sheared.simulation, last_frame(sheared.folder)
    box = freud.box.Box.from_box(frame.configuration.box)
    d = simulation.configuration.dimension
    assert box.is2D == (d == 2)
    cutoff = 1.0
    query = freud.locality.AABBQuery(box, frame.particles.position)
    found = query.query(frame.particles.position, {"r_max": cutoff, "exclude_ii": True}).toNeighborList()
    theirs = {(int(i), int(j)): float(r) for (i, j), r in zip(found[:], found.distances, strict=True) if i < j}
    ids, separation, _ = _core.neighbor_pairs(
        simulation.positions, list(simulation.configuration.box.size), 1.0, simulation.engine.offset, cutoff
    )
    distance = np.linalg.norm(separation, axis=1)
    ours = {(int(min(pair)), int(max(pair))): float(r) for pair, r in zip(ids, distance, strict=True)}
    assert len(ours) > 500
    edge = 1e-5  # positions are rounded to single precision: a pair that close to the cutoff may fall either way
    for pair in ours.keys() ^ theirs.keys():
        assert abs((ours.get(pair) or theirs[pair]) - cutoff) < edge
    shared = ours.keys() & theirs.keys()
    assert max(abs(ours[pair] - theirs[pair]) for pair in shared) < edge


def test_without_velocities_there_is_no_profile_and_no_picture_of_one(tmp_path: Path) -> None:
    simulation = tt.Simulation(
        box=tt.Box(4, 4),
        fluid=tt.Fluid(temperature=1.0),
        flow=tt.Couette(shear_rate=0.5),
        timestep=0.005,
        output=tt.Output(fields=()),
    )
    simulation.run(steps=20, out=tmp_path / "out")
    frame = last_frame(tmp_path / "out")
    assert not frame.particles.velocity.any()
    assert velocity_profile(tmp_path / "out" / "trajectory.gsd", simulation.configuration, 0) is None


def test_the_profile_of_particles_that_follow_the_flow(sheared: Any, tmp_path: Path) -> None:
    """All on the linear profile, and faster by 0.25 in the second of two frames: the mean is exact in every bin."""
    frame = last_frame(sheared.folder)
    with gsd.hoomd.open(str(tmp_path / "made.gsd"), "w") as frames:
        for slip in (0.0, 0.25):
            frame.particles.velocity = frame.particles.position[:, [1, 0, 2]] * np.array([1, 0, 0]) + [slip, 0, 0]
            frames.append(frame)
    profile = velocity_profile(tmp_path / "made.gsd", sheared.simulation.configuration, 20)
    assert profile is not None
    y, velocity, error = profile
    assert y == pytest.approx((np.arange(10) + 0.5) / 10 * 5)
    assert velocity == pytest.approx(y - 2.5 + 0.125, abs=1e-6)
    assert (error > 0.1).all()


def test_cut_drops_what_came_after_a_step_and_nothing_else(sheared: Any, tmp_path: Path) -> None:
    path = tmp_path / "trajectory.gsd"
    shutil.copy(sheared.folder / "trajectory.gsd", path)
    with gsd.hoomd.open(str(path)) as frames:
        before = [(each.configuration.step, each.particles.position.tobytes()) for each in frames]
    cut(path, 100)
    with gsd.hoomd.open(str(path)) as frames:
        assert len(frames) == 9
    cut(path, 50)
    with gsd.hoomd.open(str(path)) as frames:
        after = [(each.configuration.step, each.particles.position.tobytes()) for each in frames]
        assert frames[-1].particles.types == last_frame(sheared.folder).particles.types
    assert after == before[:4]
    cut(path, -1)
    with gsd.hoomd.open(str(path)) as frames:
        assert len(frames) == 0
    cut(tmp_path / "none.gsd", 0)
    assert [each.name for each in tmp_path.iterdir()] == ["trajectory.gsd"]


# A run that starts from a frame


def again(sheared: Any, start: tt.Start, **changes: Any) -> tt.Simulation:
    """The same suspension, from a frame."""
    c = sheared.simulation.configuration
    keys = {"box": c.box, "fluid": c.fluid, "bodies": c.bodies, "flow": c.flow, "timestep": 0.005, "seed": 5}
    return tt.Simulation(start=start, **(keys | changes))


def test_a_run_starts_where_a_frame_stands(sheared: Any) -> None:
    simulation = again(sheared, tt.Start(file=str(sheared.folder / "trajectory.gsd")))
    separation = simulation.positions - sheared.simulation.positions
    size = np.array(simulation.configuration.box.size)
    separation -= size * np.round(separation / size)
    assert np.abs(separation).max() < 1e-5
    assert np.abs(simulation.velocities - sheared.simulation.velocities).max() < 1e-5
    assert simulation.engine.offset == pytest.approx(2.5, abs=1e-5)
    assert np.abs(simulation.engine.force - sheared.simulation.engine.force).max() < 1e4, "overlaps would be wilder"
    result = simulation.run(steps=40)
    assert 0.7 < result.temperature["all"].value < 1.3


def test_a_first_frame_can_be_named(sheared: Any) -> None:
    simulation = again(sheared, tt.Start(file=str(sheared.folder / "trajectory.gsd"), frame=0))
    assert simulation.positions.shape == sheared.simulation.positions.shape
    assert simulation.engine.offset == 0.0


def spoil(change: Callable[[Any], None]) -> Callable[[Path, Path], None]:
    """Something that writes a changed copy of the last frame."""

    def write(source: Path, target: Path) -> None:
        with gsd.hoomd.open(str(source)) as frames:
            frame = frames[-1]
        change(frame)
        with gsd.hoomd.open(str(target), "w") as frames:
            frames.append(frame)

    return write


def _other_box(frame: Any) -> None:
    frame.configuration.box = [7.0, *frame.configuration.box[1:]]


def _other_species(frame: Any) -> None:
    frame.particles.typeid = frame.particles.typeid[::-1].copy()


def _not_a_number(frame: Any) -> None:
    frame.particles.position = np.where(frame.particles.position > 2, np.nan, frame.particles.position)


def _infinite_speed(frame: Any) -> None:
    frame.particles.velocity = np.full_like(frame.particles.velocity, np.inf)


def _truncated(source: Path, target: Path) -> None:
    target.write_bytes(source.read_bytes()[:5000])


@pytest.mark.parametrize(
    ("write", "problem"),
    [
        (spoil(_other_box), "has a box of 7 x 5"),
        (spoil(_other_species), "holds other particles"),
        (spoil(_not_a_number), "position that is not finite"),
        (spoil(_infinite_speed), "velocity that is not finite"),
        (lambda _, target: target.write_text("text"), "is no readable GSD file"),
        (lambda _, target: target.mkdir(), "is no readable GSD file"),
        (lambda _, __: None, "does not exist"),
        (_truncated, "is no readable GSD file"),
    ],
)
def test_a_frame_of_something_else_is_refused(
    sheared: Any, tmp_path: Path, write: Callable[[Path, Path], None], problem: str
) -> None:
    write(sheared.folder / "trajectory.gsd", tmp_path / "start.gsd")
    with pytest.raises(tt.InputError, match=r"start\.file = .*start\.gsd ") as caught:
        again(sheared, tt.Start(file=str(tmp_path / "start.gsd"))).place()
    assert problem in str(caught.value)
    assert "\n" not in str(caught.value)


def test_other_counts_and_frames_that_are_not_there(sheared: Any) -> None:
    file = str(sheared.folder / "trajectory.gsd")
    with pytest.raises(tt.InputError, match=r"holds other particles \(this run needs"):
        again(sheared, tt.Start(file=file), bodies=()).place()
    for frame in (9, -10, 2**62):
        with pytest.raises(tt.InputError, match=rf"start\.frame has no frame {frame} \(it has 9\)"):
            again(sheared, tt.Start(file=file, frame=frame)).place()
