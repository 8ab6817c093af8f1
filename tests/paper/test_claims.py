"""Verdicts by rules: what holds, what does not, what is undecided, and how often chance decides wrongly."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tether.estimate import Estimate
from tether.paper import Claim, Comparison, Verdict, consistent, exact, judged, near, z_of


def measured(value: float, error: float) -> Estimate:
    return Estimate(value, error, 100, 1.0, converged=math.isfinite(error))


@pytest.mark.parametrize(
    ("value", "error", "verdict"),
    [
        (1.0, 0.01, Verdict.HOLDS),
        (1.06, 0.01, Verdict.HOLDS),
        (1.09, 0.01, Verdict.UNDECIDED),
        (1.11, 0.01, Verdict.UNDECIDED),
        (1.13, 0.01, Verdict.FAILS),
        (0.87, 0.01, Verdict.FAILS),
        (1.0, 0.1, Verdict.UNDECIDED),
        (1.0, math.nan, Verdict.UNDECIDED),
        (math.nan, math.nan, Verdict.UNDECIDED),
    ],
)
def test_a_number_is_inside_outside_or_undecided(value: float, error: float, verdict: Verdict) -> None:
    assert near(measured(value, error), 1.0, 0.1).verdict(1.96) is verdict


def test_a_sign_is_an_interval_with_one_end() -> None:
    assert Comparison(measured(0.1, 0.02), low=0.0).verdict(1.96) is Verdict.HOLDS
    assert Comparison(measured(-0.1, 0.02), low=0.0).verdict(1.96) is Verdict.FAILS
    assert Comparison(measured(0.03, 0.02), low=0.0).verdict(1.96) is Verdict.UNDECIDED


def test_one_failure_fails_the_claim_and_one_doubt_leaves_it_open() -> None:
    good, doubt, bad = (near(measured(value, 0.01), 1.0, 0.1) for value in (1.0, 1.1, 1.5))
    assert judged("", "", "", [good, good]).verdict is Verdict.HOLDS
    assert judged("", "", "", [good, doubt]).verdict is Verdict.UNDECIDED
    assert judged("", "", "", [good, doubt, bad]).verdict is Verdict.FAILS
    assert judged("", "", "", []).verdict is Verdict.UNDECIDED


def test_an_undecided_claim_tells_the_computing_that_would_decide_it() -> None:
    claim = judged("", "", "", [near(measured(1.05, 0.05), 1.0, 0.1)], core_hours=2.0)
    # The nearer bound is 0.05 away: the error has to be 0.05/1.96, so the runs 1.96^2 times as long.
    assert claim.core_hours == pytest.approx(2.0 * z_of(1) ** 2, rel=1e-9)
    assert judged("", "", "", [near(measured(1.1, 0.05), 1.0, 0.1)], core_hours=2.0).core_hours is None
    assert judged("", "", "", [near(measured(1.0, math.nan), 1.0, 0.1)], core_hours=2.0).core_hours is None


def test_a_remark_qualifies_only_what_holds() -> None:
    holds, fails = (judged("", "", "", [near(measured(value, 0.01), 1.0, 0.1)]) for value in (1.0, 2.0))
    assert holds.with_remark("but").verdict is Verdict.REMARK
    assert fails.with_remark("but").verdict is Verdict.FAILS


def test_claims_go_through_json() -> None:
    claim = judged("text", "fig. 1", "rule", [near(measured(1.05, 0.05), 1.0, 0.1)], core_hours=2.0).with_remark("so")
    assert Claim.from_dict(claim.as_dict()) == claim


def test_exact_and_consistent() -> None:
    assert exact("", "", 6.4641, 6.46, 0.005).verdict is Verdict.HOLDS
    assert exact("", "", 6.4641, 6.47, 0.005).verdict is Verdict.FAILS
    assert consistent("", "", "", 10.0, 10).verdict is Verdict.HOLDS
    assert consistent("", "", "", 40.0, 10).verdict is Verdict.FAILS
    assert consistent("", "", "", 0.0, 0).verdict is Verdict.UNDECIDED


@pytest.mark.parametrize("comparisons", [1, 10])
def test_chance_decides_wrongly_as_seldom_as_is_said(comparisons: int) -> None:
    """True values 1e-9 inside their bounds never fail by more than the family-wise 5 %.

    Of 2000 claims half of 5 % should fail, as only one bound is near: 50 +- 7; beyond 85 with probability 1e-6.
    The control, z for a single number used for ten, is beyond it.
    """
    random = np.random.default_rng(5)
    values = 1.0 - 1e-9 + random.normal(size=(2000, comparisons))
    failures = sum(
        judged("", "", "", [Comparison(measured(v, 1.0), high=1.0) for v in row]).verdict is Verdict.FAILS
        for row in values
    )
    assert failures < 85
    if comparisons == 10:
        single = sum(
            any(Comparison(measured(v, 1.0), high=1.0).verdict(z_of(1)) is Verdict.FAILS for v in row) for row in values
        )
        assert single > 85
