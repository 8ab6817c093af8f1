"""Pair noise: the generator's known answers, what is drawn from its words, and the statistics of the draws.

One function screens a source of noise; the same function must turn down three bad hashes of the same inputs, and the
sums of particles' words that are not stirred.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import stats
from scipy.special import ndtr, ndtri

from tether import _core

Draw = Callable[[int, int, NDArray[np.uint32], NDArray[np.uint32]], NDArray[np.float64]]

word = st.integers(0, 2**32 - 1)
long_word = st.integers(0, 2**64 - 1)
mask = 2**32 - 1


def ids(*values: int) -> NDArray[np.uint32]:
    return np.array(values, dtype=np.uint32)


# The generator


@pytest.mark.parametrize(
    ("counter", "key", "answer"),
    [  # Random123, tests/kat_vectors, "philox2x32 10"
        ("00000000 00000000", "00000000", "ff1dae59 6cd10df2"),
        ("ffffffff ffffffff", "ffffffff", "2c3f628b ab4fd7ad"),
        ("243f6a88 85a308d3", "13198a2e", "dd7ce038 f62a4c12"),
    ],
)
def test_known_answers_of_philox_2x32(counter, key, answer):
    got = _core.philox2x32([int(c, 16) for c in counter.split()], int(key, 16))
    assert [f"{w:08x}" for w in got] == answer.split()


@pytest.mark.parametrize(
    ("counter", "key", "answer"),
    [  # Random123, tests/kat_vectors, "philox4x32 10"
        ("00000000 00000000 00000000 00000000", "00000000 00000000", "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
        ("ffffffff ffffffff ffffffff ffffffff", "ffffffff ffffffff", "408f276d 41c83b0e a20bc7c6 6d5451fd"),
        ("243f6a88 85a308d3 13198a2e 03707344", "a4093822 299f31d0", "d16cfe09 94fdcceb 5001e420 24126ea1"),
    ],
)
def test_known_answers_of_philox_4x32(counter, key, answer):
    got = _core.philox4x32([int(c, 16) for c in counter.split()], [int(k, 16) for k in key.split()])
    assert [f"{w:08x}" for w in got] == answer.split()


def philox_2x32(left: int, right: int, key: int) -> tuple[int, int]:
    """Written from the paper (doi 10.1145/2063384.2063405), in Python's integers."""
    for _ in range(10):
        product = 0xD256D193 * left
        left, right = (product >> 32) ^ key ^ right, product & mask
        key = (key + 0x9E3779B9) & mask
    return left, right


def philox_4x32(counter: list[int], key: list[int]) -> list[int]:
    c, k = list(counter), list(key)
    for _ in range(10):
        a, b = 0xD2511F53 * c[0], 0xCD9E8D57 * c[2]
        c = [(b >> 32) ^ c[1] ^ k[0], b & mask, (a >> 32) ^ c[3] ^ k[1], a & mask]
        k = [(k[0] + 0x9E3779B9) & mask, (k[1] + 0xBB67AE85) & mask]
    return c


def stirred(x: int) -> int:
    """Written from its author's page (nullprogram.com/blog/2018/07/31), in Python's integers."""
    for shift, multiplier in ((16, 0x21F0AAAD), (15, 0xD35A2D97)):
        x = ((x ^ (x >> shift)) * multiplier) & mask
    return x ^ (x >> 15)


@given(seed=long_word, step=long_word, i=word, j=word)
def test_words_are_stirred_sums_of_philox_under_the_key_of_the_step(seed, step, i, j):
    """All 64 bits of seed and step count: seed in the key, step in the counter. The first word of each particle's
    Philox under that key; their sum, stirred; and that stirred once more, a golden ratio further.
    """
    key = philox_4x32([step & mask, step >> 32, 0, 0], [seed & mask, seed >> 32])
    total = sum(philox_2x32(one ^ key[2], key[3], key[0])[0] for one in (i, j)) & mask
    first = stirred(total)
    wanted = (first, stirred((first + 0x9E3779B9) & mask))
    assert tuple(_core.noise_words(seed, step, ids(i), ids(j))[0]) == wanted


def test_stirring_is_one_to_one():
    """Each of its steps can be undone: shifts by more than half a word at once, the shift by 15 in three, odd
    multipliers by their inverses.
    """
    generator = np.random.default_rng(3)
    for x in map(int, generator.integers(0, 2**32, 1000)):
        back = stirred(x)
        for shift, multiplier in ((15, 0xD35A2D97), (15, 0x21F0AAAD), (16, 1)):
            back ^= (back >> shift) ^ (back >> 2 * shift)
            back = back * pow(multiplier, -1, 2**32) & mask
        assert back == x


# What is drawn from the words


@given(seed=long_word, step=long_word, i=word, j=word, kind=st.sampled_from(["uniform", "gaussian"]))
def test_order_of_a_pair_does_not_matter(seed, step, i, j, kind):
    assert _core.pair_noise(seed, step, ids(i), ids(j), kind) == _core.pair_noise(seed, step, ids(j), ids(i), kind)


def test_draws_follow_from_the_words():
    i = np.arange(10_000, dtype=np.uint32)
    high, low = _core.noise_words(1, 2, i, i + 1).T
    uniform = _core.pair_noise(1, 2, i, i + 1, "uniform")
    assert uniform == pytest.approx((high.view(np.int32) + 0.5) / 2.0**31 * math.sqrt(3.0), rel=1e-15)
    assert np.abs(uniform).max() < math.sqrt(3.0)
    radius = np.sqrt(-2.0 * np.log((high + 0.5) / 2.0**32))
    gaussian = _core.pair_noise(1, 2, i, i + 1, "gaussian")
    assert gaussian == pytest.approx(radius * np.cos(2.0 * math.pi * (low + 0.5) / 2.0**32), rel=1e-12, abs=1e-12)


# The statistics of the draws

count = 100_000  # draws of one comparison
false_alarm = 1e-4  # of one call of `screen` on ideal noise


def moment(kind: str, order: int) -> float:
    """Of the distribution that is meant: mean 0, variance 1."""
    if order % 2:
        return 0.0
    if kind == "uniform":
        return 3.0 ** (order / 2) / (order + 1)
    return float(math.prod(range(1, order, 2)))


def cumulative(kind: str, x: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.clip(0.5 + x / math.sqrt(12.0), 0.0, 1.0) if kind == "uniform" else ndtr(x)


def screen(draw: Draw, kind: str, seed: int = 20) -> list[str]:
    """What is wrong with a source of noise, in words; a good one is accused with probability `false_alarm`.

    Each comparison is a mean over `count` draws against its exact value in exact standard deviations, or one
    Kolmogorov-Smirnov test; the bar is Bonferroni's.
    """
    n = np.arange(count, dtype=np.uint32)
    walks = {  # draws that differ in one input only
        "i": lambda s, t, d=0: draw(s, t, n + d, n + 10_000_000),
        "i alone": lambda s, t, d=0: draw(s, t, n + d, np.full_like(n, 900_000_000)),
        "j alone": lambda s, t, d=0: draw(s, t, np.full_like(n, 5), n + 10 + d),
        "neighbors": lambda s, t, d=0: draw(s, t, n + d, n + d + 1),
        "step": lambda s, t, d=0: np.array([draw(s, t + int(k), ids(3), ids(4 + d))[0] for k in n[: count // 10]]),
        "seed": lambda s, t, d=0: np.array([draw(s + int(k), t, ids(3), ids(4 + d))[0] for k in n[: count // 10]]),
    }
    scores: dict[str, float] = {}

    def compare(name: str, series: NDArray[np.float64], mean: float, variance: float) -> None:
        scores[name] = (float(series.mean()) - mean) / math.sqrt(variance / len(series))

    spread_of_square = moment(kind, 4) - 1.0

    def uncorrelated(name: str, a: NDArray[np.float64], b: NDArray[np.float64]) -> None:
        compare(f"covariance {name}", a * b, 0.0, 1.0)
        compare(f"covariance of squares {name}", (a**2 - 1.0) * (b**2 - 1.0), 0.0, spread_of_square**2)
        compare(f"covariance with square {name}", a * (b**2 - 1.0), 0.0, spread_of_square)

    for name, walk in walks.items():
        x = walk(seed, 7)
        for order in (1, 2, 3, 4):
            exact = moment(kind, order)
            compare(f"moment {order} along {name}", x**order, exact, moment(kind, 2 * order) - exact**2)
        p = float(stats.kstest(cumulative(kind, x), "uniform").pvalue)
        scores[f"distribution along {name}"] = float(stats.norm.isf(0.5 * p))
        for lag in (1, 2, 16):
            uncorrelated(f"at lag {lag} along {name}", x[:-lag], x[lag:])
        uncorrelated(f"with the next id along {name}", x, walk(seed, 7, 1))
        if name not in ("step", "seed"):
            uncorrelated(f"with the next step along {name}", x, walk(seed, 8))
            uncorrelated(f"with the next seed along {name}", x, walk(seed + 1, 7))
            uncorrelated(f"with seed and step exchanged along {name}", x, walk(7, seed))
    # pairs of three particles: two that share one, and the triangle
    i, j, k = n, n + 1_000_000, n[::-1] + 2_000_000
    a, b, c = draw(seed, 7, i, j), draw(seed, 7, i, k), draw(seed, 7, j, k)
    for name, (first, second) in {"ij, ik": (a, b), "ij, jk": (a, c), "ik, jk": (b, c)}.items():
        uncorrelated(f"of pairs {name}", first, second)
    # closed loops, whose sums of words are bound to each other: w_ij - w_jk + w_kl - w_li = 0 around four particles
    m = n[::-1] + 3_000_000
    compare("triangle", a * b * c, 0.0, 1.0)
    around = (a, c, draw(seed, 7, k, m), draw(seed, 7, m, i))
    compare("loop of four", math.prod(around), 0.0, 1.0)
    for name, loop in {"triangle": (a, b, c), "loop of four": around}.items():
        centered = [each**2 - 1.0 for each in loop]
        compare(f"squares around the {name}", math.prod(centered), 0.0, spread_of_square ** len(loop))
        for one in range(len(loop)):  # one noise with the squares of the others, and its square with the others
            others, squares = [*loop[:one], *loop[one + 1 :]], centered[:one] + centered[one + 1 :]
            variance = spread_of_square ** len(squares)
            compare(f"number {one} with squares around the {name}", loop[one] * math.prod(squares), 0.0, variance)
            compare(f"square {one} around the {name}", centered[one] * math.prod(others), 0.0, spread_of_square)
    turns = around[0] - around[1] + around[2] - around[3]
    compare("sum around the loop of four", turns**2, 4.0, 4.0 * moment(kind, 4) + 20.0)
    # the whole force on one particle: the sum over its partners must have their number as variance
    partners = np.arange(1, 33, dtype=np.uint32)
    sums = np.array([draw(seed, 7, np.full_like(partners, 100 * m), 100 * m + partners).sum() for m in range(3000)])
    fourth = 32 * moment(kind, 4) + 3 * 32 * 31
    compare("sum over partners", sums, 0.0, 32.0)
    compare("square of the sum over partners", sums**2, 32.0, fourth - 32.0**2)

    bar = float(stats.norm.isf(0.5 * false_alarm / len(scores)))
    return [f"{name}: {score:.1f}" for name, score in scores.items() if not abs(score) < bar]


def from_words(words: NDArray[np.uint64], kind: str) -> NDArray[np.float64]:
    """A hash's 32-bit words as noise of the kind asked for."""
    share = (np.asarray(words & np.uint64(mask), dtype=np.float64) + 0.5) / 2.0**32
    return math.sqrt(3.0) * (2.0 * share - 1.0) if kind == "uniform" else ndtri(share)


def congruential(seed: int, step: int, i: NDArray[np.uint32], j: NDArray[np.uint32]) -> NDArray[np.uint64]:
    """One turn of a linear congruential generator over the inputs folded together by exclusive or."""
    return np.uint64(1664525) * np.uint64(seed ^ step) ^ i.astype(np.uint64) ^ j.astype(np.uint64) * np.uint64(69069)


def sum_of_ids(seed: int, step: int, i: NDArray[np.uint32], j: NDArray[np.uint32]) -> NDArray[np.uint64]:
    """A sound generator that is fed i + j: pairs of one sum get one number."""
    total = i + j
    return _core.noise_words(seed, step, total, np.zeros_like(total))[:, 0].astype(np.uint64)


def sum_of_seed_and_step(seed: int, step: int, i: NDArray[np.uint32], j: NDArray[np.uint32]) -> NDArray[np.uint64]:
    """A sound generator that is fed seed + step: the next seed replays the next step."""
    return _core.noise_words(seed + step, 0, i, j)[:, 0].astype(np.uint64)


def plain_sum(seed: int, step: int, i: NDArray[np.uint32], j: NDArray[np.uint32]) -> NDArray[np.uint64]:
    """The sum of the particles' words as it is, without stirring: independent but around loops."""
    key = philox_4x32([step & mask, step >> 32, 0, 0], [seed & mask, seed >> 32])
    left, right = np.stack([i, j]).astype(np.uint64) ^ np.uint64(key[2]), np.uint64(key[3])
    for turn in range(10):
        product = np.uint64(0xD256D193) * left
        left = (product >> np.uint64(32)) ^ np.uint64((key[0] + turn * 0x9E3779B9) & mask) ^ right
        right = product & np.uint64(mask)
    return left.sum(axis=0) & np.uint64(mask)


@pytest.mark.parametrize("kind", ["uniform", "gaussian"])
@pytest.mark.parametrize("seed", [20, 2**40 + 20])
def test_noise_passes_the_screen(kind, seed):
    """False-alarm rate 1e-4 for each of the four."""
    assert screen(lambda s, t, i, j: _core.pair_noise(s, t, i, j, kind), kind, seed) == []


def test_the_plain_sum_is_what_gets_stirred():
    """The control below differs from the noise by the stirring alone."""
    i, j = ids(3, 70, 0, 2**32 - 1), ids(5, 6, 1, 9)
    words = _core.noise_words(20, 7, i, j)[:, 0]
    assert [stirred(int(total)) for total in plain_sum(20, 7, i, j)] == list(words)


@pytest.mark.parametrize("kind", ["uniform", "gaussian"])
@pytest.mark.parametrize("bad", [congruential, sum_of_ids, sum_of_seed_and_step])
def test_bad_hashes_fail_the_screen(bad, kind):
    assert screen(lambda s, t, i, j: from_words(bad(s, t, i, j), kind), kind)


@pytest.mark.parametrize("kind", ["uniform", "gaussian"])
def test_only_loops_tell_that_sums_are_not_stirred(kind):
    """The fourth bad hash, and what the comparisons around loops are for: all others take plain sums for good noise."""
    accusations = screen(lambda s, t, i, j: from_words(plain_sum(s, t, i, j), kind), kind)
    assert any("loop of four" in accusation for accusation in accusations)
    assert [accusation for accusation in accusations if "loop" not in accusation and "triangle" not in accusation] == []


def test_right_noise_of_the_wrong_kind_fails_the_screen():
    for kind, other in itertools.permutations(["uniform", "gaussian"]):
        accusations = screen(lambda s, t, i, j, kind=kind: _core.pair_noise(s, t, i, j, kind), other)
        assert any("distribution" in accusation for accusation in accusations)
