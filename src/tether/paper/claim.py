"""Claim: a statement of the paper, and a verdict on it by a rule on numbers and their errors.

All rules are one: a measured number with its error is compared with the interval in which it has to lie for the
statement to be true. With z = 1.96, or more where several numbers are compared at once (so that all of them together go
wrong by chance in 5 of 100 papers),

    holds          the interval value +- z error lies inside
    does not hold  it lies outside
    undecided      it reaches over a bound: the error that would decide, and the core-hours for that, are told
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from typing import Any

from scipy.special import chdtrc, ndtri

from tether.estimate import Estimate

FAMILY_WISE = 0.05
"""Probability that one or more of the numbers behind a verdict lies beyond its interval by chance."""


class Verdict(StrEnum):
    """What became of a claim."""

    HOLDS = "holds"
    REMARK = "holds with a remark"
    FAILS = "does not hold"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Claim:
    """A statement, the verdict, and what it stands on."""

    text: str
    """What the paper says, in a sentence."""
    source: str
    """Where: "fig. 10", "section 4.6"."""
    verdict: Verdict
    measured: str
    """What was measured, with its error, in words."""
    rule: str
    """What had to be so for the statement to hold."""
    remark: str = ""
    core_hours: float | None = None
    """Computing that would decide it, where it is undecided and that can be told."""

    def with_remark(self, remark: str) -> Claim:
        """The same claim with a remark; one that holds then holds with a remark."""
        verdict = Verdict.REMARK if self.verdict is Verdict.HOLDS else self.verdict
        return replace(self, verdict=verdict, remark=remark)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)

    @classmethod
    def from_dict(cls, entry: dict[str, Any]) -> Claim:
        """From JSON."""
        return cls(**{**entry, "verdict": Verdict(entry["verdict"])})


@dataclass(frozen=True)
class Comparison:
    """A measured number and the interval in which it has to lie."""

    measured: Estimate
    low: float = -math.inf
    high: float = math.inf
    name: str = ""

    def verdict(self, z: float) -> Verdict:
        """By the rule of this module."""
        value, error = self.measured.value, self.measured.error
        if not (math.isfinite(value) and math.isfinite(error)):
            return Verdict.UNDECIDED
        if self.low <= value - z * error and value + z * error <= self.high:
            return Verdict.HOLDS
        if value - z * error > self.high or value + z * error < self.low:
            return Verdict.FAILS
        return Verdict.UNDECIDED

    def deciding_error(self, z: float) -> float:
        """The error at which this value would decide; 0 where it lies on a bound."""
        return min(abs(self.measured.value - bound) for bound in (self.low, self.high)) / z

    def __str__(self) -> str:
        return f"{self.name} = {self.measured}" if self.name else str(self.measured)


def near(measured: Estimate, expected: float, tolerance: float, name: str = "") -> Comparison:
    """A number that has to be `expected` within a tolerance (of the same unit, not relative)."""
    return Comparison(measured, expected - tolerance, expected + tolerance, name)


def judged(text: str, source: str, rule: str, comparisons: Sequence[Comparison], core_hours: float = math.nan) -> Claim:
    """The verdict over all comparisons: it fails where one fails, is undecided where one is, and else holds.

    core_hours: what the runs behind the numbers have cost; errors fall with its square root.
    """
    z = z_of(len(comparisons))
    verdicts = [each.verdict(z) for each in comparisons]
    if Verdict.FAILS in verdicts:
        verdict = Verdict.FAILS
    else:
        verdict = Verdict.UNDECIDED if Verdict.UNDECIDED in verdicts or not verdicts else Verdict.HOLDS
    measured = _listed(comparisons, verdicts)
    needed = _needed(comparisons, verdicts, z, core_hours) if verdict is Verdict.UNDECIDED else None
    return Claim(text, source, verdict, measured, rule, core_hours=needed)


def z_of(comparisons: int) -> float:
    """Errors on either side of a value that hold the true one, of all comparisons together, in 95 of 100 cases."""
    each = 1.0 - (1.0 - FAMILY_WISE) ** (1.0 / max(1, comparisons))
    return float(-ndtri(each / 2.0))


def consistent(text: str, source: str, rule: str, chi_square: float, freedom: int) -> Claim:
    """A claim that numbers are all the same, or lie on a curve: chi-square at 5 %."""
    p = float(chdtrc(freedom, chi_square)) if freedom > 0 else math.nan
    verdict = Verdict.UNDECIDED if math.isnan(p) else Verdict.HOLDS if p >= FAMILY_WISE else Verdict.FAILS
    return Claim(
        text, source, verdict, f"chi-square {chi_square:.1f} for {freedom} degrees of freedom, p = {p:.2g}", rule
    )


def exact(text: str, source: str, computed: float, printed: float, tolerance: float) -> Claim:
    """A number of the paper that is computed, not measured, within the rounding of what is printed."""
    verdict = Verdict.HOLDS if abs(computed - printed) <= tolerance else Verdict.FAILS
    return Claim(text, source, verdict, f"{computed:.6g}", f"{printed:g} within {tolerance:g}, its rounding")


def _listed(comparisons: Sequence[Comparison], verdicts: Sequence[Verdict]) -> str:
    """All numbers, or those that decide where they are many."""
    if len(comparisons) <= 4:
        return "; ".join(str(each) for each in comparisons)
    worst = [each for each, verdict in zip(comparisons, verdicts, strict=True) if verdict is not Verdict.HOLDS]
    inside = sum(1 for verdict in verdicts if verdict is Verdict.HOLDS)
    shown = "; ".join(str(each) for each in worst[:4]) + ("; ..." if len(worst) > 4 else "")
    return f"{inside} of {len(comparisons)} inside" + (f"; else {shown}" if shown else "")


def _needed(
    comparisons: Iterable[Comparison], verdicts: Iterable[Verdict], z: float, core_hours: float
) -> float | None:
    factors = []
    for each, verdict in zip(comparisons, verdicts, strict=True):
        if verdict is Verdict.UNDECIDED:
            deciding = each.deciding_error(z)
            if not (deciding > 0 and math.isfinite(each.measured.error)):
                return None
            factors.append((each.measured.error / deciding) ** 2)
    hours = core_hours * max(factors, default=math.nan)
    return hours if math.isfinite(hours) else None
