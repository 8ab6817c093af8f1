"""What a run says against its own means."""

from __future__ import annotations

import tether as tt


def warnings(*, base: str = "massless", rate: float = 0.5, steps: int = 6000, timestep: float = 0.01) -> list[str]:
    simulation = tt.Simulation(
        box=tt.Box(6, 6), fluid=tt.Fluid(temperature=1.0), bodies=[tt.Bodies("square", count=9, base=base)],
        flow=tt.Couette(shear_rate=rate), timestep=timestep, seed=5,
    )  # fmt: skip
    return simulation.run(equilibration=1000, steps=steps).warnings


def test_a_good_run_says_nothing() -> None:
    assert warnings() == []


def test_a_newton_euler_base_is_told_by_its_temperatures() -> None:
    said = [each for each in warnings(base="newton-euler") if "a Newton-Euler base heats its constituents" in each]
    assert [each.split(" is ")[0] for each in said] == [
        "the temperature of all",
        "the temperature of constituents",
        "the temperature of body rotation",
    ]


def test_a_shear_too_fast_for_the_thermostat_is_told() -> None:
    said = " ".join(warnings(rate=30.0, timestep=0.002))
    assert "the temperature of solvent is" in said
    assert "the shear too fast for the thermostat" in said


def test_little_strain_is_told() -> None:
    assert any(each.startswith("the total strain is 3,") for each in warnings(steps=600))


def test_a_run_that_drifts_as_a_whole_is_told() -> None:
    """Nothing holds the temperature of a sheared fluid without friction."""
    simulation = tt.Simulation(
        box=tt.Box(6, 6), fluid=tt.Fluid(temperature=1.0, noise=0.0), flow=tt.Couette(shear_rate=0.5),
        timestep=0.005, seed=5,
    )  # fmt: skip
    said = " ".join(simulation.run(steps=4000).warnings)
    assert "temperature of all" in said
    assert "drift" in said
    assert "without friction nothing holds it" in said
