"""The steep conservative force F = a (exp(-b r) - exp(-b)) / (1 - exp(-b)), r in units of the pair's cutoff (Pan,
Caswell & Karniadakis 2010, doi 10.1021/la902205x): values, limits, reach, in every engine.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from suspensions import Engine, engine, law_table

ENGINES = {
    "mixed": {"pairs": "packed", "precision": "mixed"},
    "double": {"pairs": "packed", "precision": "double"},
    "reference": {"pairs": "reference"},
}
ROUNDING = {"mixed": 1e-6, "double": 1e-14, "reference": 1e-14}  # of the force at no distance


def pair(
    which: str, distance: float, *, repulsion: float, steepness: float, friction: float = 0.0, cutoff: float = 1.0
) -> Engine:
    """Two particles in a box of side 8, whose pair of species has the law; they part along x at a speed of 2. The other
    pairs of species have none.
    """
    nothing = (0.0, 0.0, cutoff, 0.0)
    law = (repulsion, friction, cutoff, steepness)
    made = engine([8.0, 8.0], [0, 1], laws=law_table([[nothing, law], [law, nothing]]), **ENGINES[which])
    made.position = np.array([[2.0 + distance, 4.0], [2.0, 4.0]])
    made.velocity = np.array([[1.0, 0.0], [-1.0, 0.0]])
    made.place()
    return made


def force(which: str, distance: float, **law: float) -> float:
    """On the particle to the right, along x; the other one has the opposite."""
    found = pair(which, distance, **law).force
    assert found[0, 0] == -found[1, 0]
    assert not found[:, 1].any()
    return float(found[0, 0])


@pytest.mark.parametrize("which", ENGINES)
def test_values_at_special_points(which: str) -> None:
    """Halves: with b = 2 n ln 2, exp(-b/2) = 2^-n, so the force at half the cutoff is a / (2^n + 1)."""
    for n in (1, 2, 5):
        law = {"repulsion": 24.0, "steepness": 2 * n * math.log(2.0)}
        assert force(which, 0.5, **law) == pytest.approx(24.0 / (2**n + 1), abs=24.0 * ROUNDING[which])
        assert force(which, 1.0, cutoff=2.0, **law) == pytest.approx(24.0 / (2**n + 1), abs=24.0 * ROUNDING[which])


@pytest.mark.parametrize("which", ENGINES)
@pytest.mark.parametrize("steepness", [0.7, 20.0, 1000.0])
def test_ends_of_the_range(which: str, steepness: float) -> None:
    """a at the center, where no direction is: exactly there two particles push nowhere. Nothing at the cutoff, to which
    it falls continuously, nor beyond it.
    """
    law = {"repulsion": 30.0, "steepness": steepness}
    close = 2.0**-20  # of which 2 + r is a number in mixed precision too
    assert force(which, close, **law) == pytest.approx(30.0 * math.exp(-steepness * close), rel=2e-6, abs=1e-5)
    assert force(which, 0.0, **law) == 0.0
    assert abs(force(which, 1.0 - 2.0**-24, **law)) < 30.0 * (
        2e-6 + steepness * 2.0**-24 * math.exp(-min(steepness, 80))
    )
    for distance in (1.0, 1.0 + 2.0**-20, 1.5):
        assert force(which, distance, **law) == 0.0


@pytest.mark.parametrize("which", ENGINES)
@pytest.mark.parametrize("steepness", [0.3, 3.0, 20.0, 79.0, 81.0, 200.0, 1000.0])
@pytest.mark.parametrize("cutoff", [0.6, 1.0, 1.4])
def test_it_is_the_equation(which: str, steepness: float, cutoff: float) -> None:
    """At sixteen distances; cutoffs are those of the pair."""
    for share in (np.arange(16) + 0.5) / 16.0:
        found = force(which, share * cutoff, repulsion=18.75, steepness=steepness, cutoff=cutoff)
        exact = math.exp(-steepness * share) * math.expm1(-steepness * (1.0 - share)) / math.expm1(-steepness)
        # in mixed precision r is known to 2^-32 of the box
        assert found == pytest.approx(18.75 * exact, abs=18.75 * ROUNDING[which] * (1.0 + 0.1 * steepness))


def test_small_steepness_is_the_linear_law_to_first_order() -> None:
    """F = a w (1 - b r/2 + O(b^2)): the distance from the linear law halves with b, and is what that says."""
    for distance in (0.2, 0.5, 0.9):
        linear = force("reference", distance, repulsion=18.75, steepness=0.0)
        assert linear == pytest.approx(18.75 * (1.0 - distance), rel=1e-14)
        off = [force("reference", distance, repulsion=18.75, steepness=b) - linear for b in (0.04, 0.02, 0.01)]
        orders = np.diff(np.log(np.abs(off))) / math.log(0.5)
        assert orders == pytest.approx(1.0, abs=0.02)
        assert off[-1] == pytest.approx(-0.5 * 0.01 * distance * linear, rel=0.01)


@pytest.mark.parametrize("which", ENGINES)
@pytest.mark.parametrize("steepness", [1e-3, 1e-6, 1e-9, 1e-12, 1e-17, 1e-300])
def test_no_steepness_is_too_small(which: str, steepness: float) -> None:
    """A configuration may ask for any above 0: 1 - exp(-b) and exp(-b r) - exp(-b) must not lose their digits."""
    for distance in (0.25, 0.5, 0.75):
        found = force(which, distance, repulsion=18.75, steepness=steepness)
        exact = 18.75 * (1.0 - distance) * (1.0 - 0.5 * steepness * distance)
        assert found == pytest.approx(exact, abs=18.75 * (ROUNDING[which] + steepness**2))


@pytest.mark.parametrize("which", ENGINES)
def test_friction_and_noise_are_those_of_the_linear_law(which: str) -> None:
    """What a steep repulsion adds to the forces of friction and noise within its cutoff is the conservative force."""
    for distance in (0.1, 0.5, 0.9, 1.3, 1.5):
        damped = {"friction": 4.5, "cutoff": 1.4}
        bare = force(which, distance, repulsion=0.0, steepness=20.0, **damped)
        steep = force(which, distance, repulsion=30.0, steepness=20.0, **damped)
        alone = force(which, distance, repulsion=30.0, steepness=20.0, cutoff=1.4)
        assert steep == pytest.approx(bare + alone, abs=100.0 * ROUNDING[which])
        assert bool(bare) is (distance < 1.4)
