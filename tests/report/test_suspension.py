"""Frames for the 3D view: the particles of the trajectory, to the precision of their bytes, and bodies in one piece."""

from __future__ import annotations

import base64
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from small_runs import frames

from tether.record import Record
from tether.report.suspension import FEWEST_FRAMES, MOST_FRAMES, suspension

MUCH = 10**8


def described(folder: Path, most_bytes: int = MUCH):
    """A description, with arrays for text: positions (frames, particles, d), kinds, bodies, shades."""
    found = suspension(Record.open(folder), most_bytes)
    assert found is not None
    text = found.description
    count = len(array(text["kind"], "u1"))
    d, size = text["dimension"], np.array(text["size"])[: text["dimension"]]
    along = (array(text["place"], "<u2").reshape(len(text["times"]), count, d) / 65535 - 0.5) * 2
    position = along * size
    position[..., 0] += np.array(text["tilts"])[:, None] * position[..., 1]
    return found, position, size


def array(text: str, kind: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), kind)


@pytest.mark.parametrize("name", ["flat", "solid"])
def test_particles_are_those_of_the_trajectory(run_of: Callable[[str], Path], name: str) -> None:
    found, position, size = described(run_of(name))
    for own, frame, tilt in zip(position, frames(run_of(name)), found.description["tilts"], strict=True):
        away = own - frame.particles.position[:, : len(size)]
        rows = np.rint(away[:, 1] / size[1])
        away[:, 0] -= rows * tilt * size[1]
        away[:, 1] -= rows * size[1]
        away -= np.rint(away / size) * size  # images along x and z
        assert np.abs(away).max() < 2.0 * size.max() / 65535
    assert found.left_out == ""
    assert found.is_sheared
    assert found.has_bodies


@pytest.mark.parametrize(("name", "diameter"), [("flat", 0.25 * 2**0.5), ("solid", 0.25 * 3**0.5)])
def test_bodies_are_in_one_piece_with_their_middle_in_the_box(
    run_of: Callable[[str], Path], name: str, diameter: float
) -> None:
    found, position, size = described(run_of(name))
    body = array(found.description["body"], "<i4")
    torn = 0
    for own, frame in zip(position, frames(run_of(name)), strict=True):
        for number in range(3):
            sites = own[body == number]
            assert np.ptp(sites, axis=0).max() < 2.0 * diameter
            assert np.abs(sites[:, 1].mean()) <= 0.5 * size[1] * (1 + 1e-4)
            torn += bool((np.ptp(frame.particles.position[body == number], axis=0)[: len(size)] > 2.0 * diameter).any())
    assert torn > 0, "some body lies across a face, else this shows nothing"


def test_velocities_are_against_the_imposed_profile(run_of: Callable[[str], Path]) -> None:
    found, _, size = described(run_of("flat"))
    shade = found.description["shades"]["speed"]
    speed = array(shade["value"], "u1").reshape(len(found.description["times"]), -1) / 255 * shade["high"]
    frame = frames(run_of("flat"))[-1]
    velocity = frame.particles.velocity[:, :2].astype(float)
    velocity[:, 0] -= 0.5 * frame.particles.position[:, 1]  # the rate of the file; y about the middle
    expected = np.minimum(np.linalg.norm(velocity, axis=1), shade["high"])
    assert np.allclose(speed[-1], expected, atol=0.51 / 255 * shade["high"])
    assert "imposed profile" in shade["words"]
    assert size[0] == 4.0


def test_what_is_too_much_is_left_out_and_said(run_of: Callable[[str], Path]) -> None:
    whole, *_ = described(run_of("flat"))
    there = len(whole.description["times"])
    assert there <= MOST_FRAMES
    each = 6  # bytes of a particle in two dimensions
    few, position, _ = described(run_of("flat"), each * there * 30)
    kind = array(few.description["kind"], "u1")
    assert (kind > 0).sum() == 12, "bodies stay"
    assert position.shape[:2] == (there, 30)
    assert few.left_out == "To keep the page small the view shows 18 of 64 solvent particles."
    fewer, position, _ = described(run_of("flat"), each * FEWEST_FRAMES * 9)
    assert np.unique(array(fewer.description["body"], "<i4")).tolist() == [-1, 0, 1], "whole bodies only"
    assert len(position) == FEWEST_FRAMES < there
    assert fewer.left_out.endswith(f"{FEWEST_FRAMES} of {there} frames, 1 of 64 solvent particles, 2 of 3 bodies.")


def test_a_run_without_frames_has_no_view(run_of: Callable[[str], Path], tmp_path: Path) -> None:
    (tmp_path / "config.toml").write_bytes((run_of("flat") / "config.toml").read_bytes())
    assert suspension(Record.open(tmp_path), MUCH) is None
