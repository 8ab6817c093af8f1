"""Radial distribution functions: 1 for random points, peaks of lattices, freud's, and sizes that are known.

Every random test has a fixed seed, so it either always passes or never does; a false-alarm rate is the chance that a
seed chosen blindly would have failed a correct program.
"""

from __future__ import annotations

import math

import freud
import numpy as np
import pytest
import xarray as xr
from scipy.stats import chi2

from tether.observe.counts import CountBlocks, Ratio
from tether.observe.moment import Moment
from tether.observe.radial_distribution import RadialDistribution

false_alarm = 1e-4  # of each chi-square test here


def moment(size, solvent, center, kind=None, *, offset=0.0):
    """A step with these positions of solvent and bodies and nothing else in it."""
    d = len(size)
    solvent, center = (np.asarray(rows, dtype=float).reshape(-1, d) for rows in (solvent, center))
    return Moment(
        step=0, time=0.0, size=tuple(size), offset=offset, shear_rate=0.0, strain=0.0, position=solvent,
        velocity=np.zeros_like(solvent), mass=np.ones(len(solvent)), solvent=len(solvent), center=center,
        center_velocity=np.zeros_like(center), rotation=np.broadcast_to(np.eye(d), (len(center), d, d)),
        kind=np.zeros(len(center), np.intp) if kind is None else np.asarray(kind, np.intp),
        driving_force=np.zeros(len(solvent)),
    )  # fmt: skip


def random_moment(generator, size, solvent, bodies, kind=None, offset=0.0):
    return moment(
        size, generator.random((solvent, len(size))) * size, generator.random((bodies, len(size))) * size, kind,
        offset=offset,
    )  # fmt: skip


def sampled(moments, **options):
    observer = RadialDistribution(10, **options)
    for each in moments:
        observer.sample(each)
    return observer.dataset()


def shell(found, along, dimension):
    """Volumes of the shells of a dataset."""
    r = found[along].values
    low, high = r - 0.5 * (r[1] - r[0]), r + 0.5 * (r[1] - r[0])
    return math.pi * (high**2 - low**2) if dimension == 2 else 4.0 / 3.0 * math.pi * (high**3 - low**3)


def is_one(g, expected):
    """Whether g = 1 by a chi-square test with this many counts expected in each bin. Bins of less than 10 are left out.

    Of points placed independently and uniformly in a periodic box the separations of two pairs are independent, even if
    they share a point, so the variance of a count is what is expected, less a share that a bin has of all.
    """
    enough = expected > 10
    assert enough.any()
    deviation = float(((g - 1.0) ** 2 * expected)[enough].sum())
    low, high = chi2.ppf([0.5 * false_alarm, 1.0 - 0.5 * false_alarm], np.count_nonzero(enough))
    return low < deviation < high


cases = [((7.0, 8.0), 0.0), ((7.0, 8.0), 2.9), ((7.0, 6.5, 8.0), 0.0), ((7.0, 6.5, 8.0), 4.1)]


@pytest.mark.parametrize(("size", "offset"), cases)
def test_random_points_give_one(size, offset):
    """All pairs of three groups. The control: solvent with no pair closer than 0.3."""
    generator = np.random.default_rng(11)
    d, samples, solvent, first, second = len(size), 60, 150, 12, 5
    kind = np.repeat([0, 1], [first, second])
    moments = [random_moment(generator, size, solvent, first + second, kind, offset) for _ in range(samples)]
    found = sampled(moments, kinds=("disc", "rod"), bin_width=0.05)
    pairs = {
        "solvent_solvent": solvent * (solvent - 1) / 2, "disc_solvent": solvent * first,
        "rod_solvent": solvent * second, "disc_disc": first * (first - 1) / 2, "disc_rod": first * second,
        "rod_rod": second * (second - 1) / 2,
    }  # fmt: skip
    measured = {name for name in found if name.startswith("g_") and not name.endswith("_error")}
    assert measured == {f"g_{name}" for name in pairs} | {"g_bodies_plane"}
    for name, count in pairs.items():
        volume = shell(found, "r" if name.endswith("solvent") else "r_bodies", d)
        assert is_one(found[f"g_{name}"].values, samples * count * volume / math.prod(size)), name
    expected = samples * pairs["solvent_solvent"] * shell(found, "r", d) / math.prod(size)
    g = np.where(found["r"].values < 0.3, 0.0, found["g_solvent_solvent"].values)
    assert not is_one(g, expected)


@pytest.mark.parametrize(("size", "offset"), cases)
def test_likes_have_one_partner_less(size, offset):
    """Ten bodies and 3000 samples: the mean of g over all distances is 1 within its error, at 4 standard errors (false
    alarm 6e-5). The control: with N in place of N - 1 it is 0.9.
    """
    generator = np.random.default_rng(12)
    d, volume, samples, bodies = len(size), math.prod(size), 3000, 10
    moments = (random_moment(generator, size, 1, bodies, offset=offset) for _ in range(samples))
    found = sampled(moments, kinds=("disc",), bin_width=0.1, map_width=0.25)
    share = shell(found, "r_bodies", d) / volume
    expected = samples * bodies * (bodies - 1) / 2 * share.sum()
    mean = float((found["g_disc_disc"].values * share).sum() / share.sum())
    assert abs(mean - 1.0) < 4.0 / math.sqrt(expected)
    assert abs(0.9 * mean - 1.0) > 4.0 / math.sqrt(expected)
    assert is_one(found["g_disc_disc"].values, samples * bodies * (bodies - 1) / 2 * share)
    assert "g_solvent_solvent" not in found  # a single particle has no partner


@pytest.mark.parametrize(("size", "offset"), cases)
def test_map_of_random_points_is_one(size, offset):
    """Each pair is in the map twice, so half of it is tested. The control: pairs along x are missing."""
    generator = np.random.default_rng(13)
    samples, bodies = 300, 20
    moments = (random_moment(generator, size, 0, bodies, offset=offset) for _ in range(samples))
    found = sampled(moments, kinds=("disc",), map_width=0.25, thickness=0.7)
    g = found["g_bodies_plane"]
    assert g.dims == ("separation_y", "separation_x")
    assert np.array_equal(g.values, g.values[::-1, ::-1])
    upper = g.values[g.sizes["separation_y"] // 2 :]
    slab = 1.0 if len(size) == 2 else 2 * 0.7
    expected = np.full(upper.shape, samples * bodies * (bodies - 1) * 0.25**2 * slab / math.prod(size))
    assert is_one(upper, expected)
    upper = upper.copy()
    upper[0] = 0.0
    assert not is_one(upper, expected)
    half = g.sizes["separation_x"] // 2
    assert found["separation_x"].values[half:] == pytest.approx(0.25 * (np.arange(half) + 0.5))
    assert found["separation_x"].values[:half] == pytest.approx(-found["separation_x"].values[: half - 1 : -1])


@pytest.mark.parametrize(("size", "offset"), [((10.0, 8.0), 2.3), ((10.0, 8.0, 9.0), 8.9), ((10.0, 8.0, 9.0), 0.0)])
def test_freud_has_the_same_g(size, offset):
    """Solvent with solvent, N - 1 partners ("finite_size" of freud), and bodies with solvent, on three frames. freud
    computes in float32, so here and there it has a pair or two in the next bin, and g is equal in all other bins.
    """
    generator = np.random.default_rng(14)
    moments = [random_moment(generator, size, 1000, 30, offset=offset) for _ in range(3)]
    found = sampled(moments, kinds=("cube",))
    tilt = offset if offset <= 0.5 * size[0] else offset - size[0]
    box = freud.box.Box(size[0], size[1], size[2] if len(size) == 3 else 0.0, xy=tilt / size[1], is2D=len(size) == 2)

    def placed(points):
        flat = np.zeros((len(points), 3))
        flat[:, : len(size)] = points - 0.5 * np.array(size)
        return box.wrap(flat)

    bins, reach = len(found["r"]), len(found["r"]) * 0.01
    alike = freud.density.RDF(bins=bins, r_max=reach, normalization_mode="finite_size")
    unlike = freud.density.RDF(bins=bins, r_max=reach)
    for each in moments:
        alike.compute((box, placed(each.position)), reset=False)
        unlike.compute((box, placed(each.position)), query_points=placed(each.center), reset=False)
    assert found["r"].values == pytest.approx(alike.bin_centers, abs=1e-6)
    for name, rdf in (("g_solvent_solvent", alike), ("g_cube_solvent", unlike)):
        mine, his = found[name].values, rdf.rdf
        equal = np.abs(mine - his) <= 1e-4 * his  # the difference of two cubes in float32 is no better
        one = his / np.maximum(rdf.bin_counts, 1)  # g of one count
        assert equal.mean() > 0.75, name
        assert (np.abs(mine - his)[~equal] < 4.5 * one[~equal]).all(), name  # two pairs, each counted twice


def test_lattice_has_its_peaks():
    """Bodies on a 10 x 10 square lattice, displaced by 3 places at the sheared face: 4, 4, 4 and 8 neighbors at 1,
    sqrt 2, 2 and sqrt 5, so g = neighbors / ((N - 1)/A shell), and 0 between them. In the map g is 1/(0.99 w^2) at the
    places of neighbors.
    """
    x, y = np.meshgrid(np.arange(10.0), np.arange(10.0))
    lattice = np.stack([x.ravel(), y.ravel()], axis=1)
    found = sampled([moment((10.0, 10.0), [], lattice, offset=3.0)], kinds=("disc",), map_width=0.3, map_reach=2.2)
    g, volume = found["g_disc_disc"].values, shell(found, "r_bodies", 2)
    peaks = {100: 4, 141: 4, 200: 4, 223: 8}
    for k, neighbors in peaks.items():
        assert g[k] == pytest.approx(neighbors / (0.99 * volume[k]), rel=1e-12)
    assert np.count_nonzero(g[:282]) == len(peaks)
    assert len(g) == 500  # half of the side
    plane = found["g_bodies_plane"]
    assert np.count_nonzero(plane) == 24  # 5 x 5 places, less its own
    assert plane.values.max() == pytest.approx(1.0 / (0.99 * 0.3**2))
    assert (plane.sel(separation_x=[-1.05, 0.15, 1.95], separation_y=1.05, method="nearest") == plane.max()).all()
    assert "g_disc_solvent" not in found
    assert "r" not in found


def apart(generator, size, count, distance, others, other_distance):
    """Points at random, none closer to another than a distance, nor to one of the others than another distance."""
    placed = np.zeros((0, len(size)))

    def closest(point, points):
        separation = points - point
        separation -= np.round(separation / size) * size
        return np.linalg.norm(separation, axis=1).min(initial=math.inf)

    while len(placed) < count:
        point = generator.random(len(size)) * size
        if closest(point, placed) >= distance and closest(point, others) >= other_distance:
            placed = np.vstack([placed, point])
    return placed


def test_hard_discs_have_their_sizes():
    """Solvent discs of diameter 0.3 and bodies 0.5 from them: a_S = 0.15 and a_C = 0.35, to half a bin."""
    generator = np.random.default_rng(15)
    size = np.array([6.0, 6.0])
    moments = []
    for _ in range(60):
        center = generator.random((8, 2)) * size
        moments.append(moment((6.0, 6.0), apart(generator, size, 70, 0.3, center, 0.5), center))
    found = sampled(moments, kinds=("disc",))
    assert float(found["contact_distance_solvent"]) == pytest.approx(0.3, abs=0.0051)
    assert float(found["effective_radius_solvent"]) == pytest.approx(0.15, abs=0.0026)
    assert float(found["effective_radius_solvent_by_resolution"]) == pytest.approx(0.155)
    assert float(found["contact_distance_disc"]) == pytest.approx(0.5, abs=0.0051)
    assert float(found["effective_radius_disc"]) == pytest.approx(0.35, abs=0.0076)
    for name in ("effective_radius_solvent", "effective_radius_disc", "contact_distance_disc"):
        assert 0.0 <= float(found[f"{name}_error"]) < 0.01
        assert found[name].attrs["units"] == "length"
    few = sampled(moments[:5], kinds=("disc",))  # too few pairs expected at g = 0.01 to tell from an empty bin
    assert np.isnan(few["contact_distance_disc"])
    assert np.isnan(few["g_disc_solvent_error"]).all()


def test_points_without_a_core_have_no_size():
    """As the solvent at kT = 1: the paper's reading is the resolution, which then is the solvent's radius for bodies'.
    In 3D the first bins are small and empty, and would make a size of 0.02 or so: the Poisson test sees it.
    """
    generator = np.random.default_rng(16)
    found = sampled((random_moment(generator, (5.0, 5.0), 400, 1) for _ in range(30)), kinds=("disc",))
    assert np.isnan(found["effective_radius_solvent"])
    assert float(found["effective_radius_solvent_by_resolution"]) == pytest.approx(0.005)  # Table 1, 2D, kT = 1
    assert "g_disc_disc" not in found  # one body has no partner
    flat = sampled(random_moment(generator, (5.0, 5.0, 5.0), 300, 0) for _ in range(30))
    assert flat["g_solvent_solvent"].values[0] == 0.0
    assert np.isnan(flat["effective_radius_solvent"])
    center = np.array([[2.5, 2.5]])
    moments = []
    for _ in range(120):
        points = generator.random((500, 2)) * 5.0
        moments.append(moment((5.0, 5.0), points[np.linalg.norm(points - center, axis=1) > 0.6][:400], center))
    found = sampled(moments, kinds=("disc",))
    assert float(found["effective_radius_disc"]) == pytest.approx(0.6 - 0.005, abs=0.0051)
    assert "by_resolution" in found["effective_radius_disc"].attrs["long_name"]


def test_crossing_is_linear_between_middles():
    """g = 0, 0.004, 0.024 in the first bins reaches 0.01 three tenths from the second's middle to the third's."""
    generator = np.random.default_rng(17)
    observer = RadialDistribution(1, bin_width=0.1)
    observer.sample(random_moment(generator, (9.0, 9.0), 100, 0))
    state = observer.state()
    ideal = 100 * 99 / 2 * math.pi * np.diff((0.1 * np.arange(21)) ** 2) / 81.0
    wanted = np.array([0.0, 0.004, 0.024] + [1.0] * 17)
    state["counts_solvent"] = np.rint(1e9 * wanted * ideal).astype(np.int64)[None, None, :]
    state["samples"] = np.array([10**9])
    state["length"] = np.array(10**9)
    observer.restore(state)
    found = observer.dataset()
    assert found["g_solvent_solvent"].values == pytest.approx(wanted, abs=1e-8)
    assert float(found["contact_distance_solvent"]) == pytest.approx(0.15 + 0.3 * 0.1, abs=1e-6)


def test_restored_is_identical():
    """Over mergers of blocks too; and to the sum of the counts, whatever the threads."""
    generator = np.random.default_rng(18)
    moments = [random_moment(generator, (6.0, 6.5), 60, 6, [0, 0, 0, 1, 1, 1], offset=1.1) for _ in range(150)]
    options = {"kinds": ("disc", "rod"), "bin_width": 0.05}
    whole = RadialDistribution(10, **options)
    assert whole.dataset() is None
    assert whole.state() == {}
    for cut in (0, 1, 64, 65, 97):
        first, second = RadialDistribution(10, **options), RadialDistribution(10, **options, threads=2)
        for each in moments[:cut]:
            first.sample(each)
        second.sample(moments[5])  # is forgotten
        second.restore({name: array.copy() for name, array in first.state().items()})
        for each in moments[cut:]:
            second.sample(each)
        if cut == 0:
            whole = second
        xr.testing.assert_identical(second.dataset(), whole.dataset())
        assert all(np.array_equal(second.state()[name], array) for name, array in whole.state().items())
    assert whole.dataset().attrs["samples"] == 150
    other = RadialDistribution(10, kinds=("disc", "rod"), bin_width=0.04)
    with pytest.raises(ValueError, match="use the bins that the run began with"):
        other.restore(whole.state())


def test_reach_is_bounded_by_the_box():
    """A third of the smallest side for solvent, half for bodies, whatever rounding does to it."""
    generator = np.random.default_rng(19)
    for smallest in (3.0, 4.2, 5.8, 11.6, 0.07 * 90):
        found = sampled([random_moment(generator, (smallest, 12.0), 20, 3)], kinds=("disc",))
        assert found.sizes["r"] == min(200, math.floor(100 * smallest / 3 + 1e-6))
        assert found.sizes["r_bodies"] == math.floor(50 * smallest + 1e-6)
    with pytest.raises(ValueError, match="name every kind"):
        sampled([random_moment(generator, (9.0, 9.0), 20, 3)])
    with pytest.raises(ValueError, match="name them differently"):
        RadialDistribution(1, kinds=("disc", "disc"))


class TestErrors:
    def ratio(self, counts, ideal):
        blocks = CountBlocks({"these": counts.shape[1:]})
        for sample in counts:
            blocks.add({"these": sample})
        return Ratio(*blocks.counts("these", ()), np.full(counts.shape[1:], ideal))

    @pytest.mark.parametrize("samples", [40, 64, 400])
    def test_of_independent_counts(self, samples):
        """Poisson counts of mean 50: error^2 = 1/(50 samples); the mean over 300 bins is known to 5 % (n >= 32 blocks,
        relative scatter of a variance sqrt(2/(n - 1)), 3 standard errors), and biased up by less.
        """
        counts = np.random.default_rng(20).poisson(50.0, (samples, 300))
        ratio = self.ratio(counts, 50.0)
        assert ratio.mean() == pytest.approx(counts.mean(axis=0) / 50.0)
        assert float((ratio.error() ** 2).mean()) * 50.0 * samples == pytest.approx(1.0, abs=0.06)

    def test_of_counts_that_last(self):
        """Every count twice: half as many independent ones, and a correlation of 1/2 between neighbors. Without it the
        variance would be half of the true one.
        """
        counts = np.repeat(np.random.default_rng(21).poisson(50.0, (24, 300)), 2, axis=0)
        variance = float((self.ratio(counts, 50.0).error() ** 2).mean()) * 50.0 * 24
        assert variance == pytest.approx(1.0, abs=0.1)

    def test_jackknife_of_a_mean_is_its_error(self):
        counts = np.random.default_rng(22).poisson(50.0, (40, 1))
        ratio = self.ratio(counts, 50.0)
        assert ratio.jackknife(lambda g: float(g[0])) == pytest.approx(float(ratio.error()[0]), rel=1e-12)

    def test_too_few_blocks(self):
        counts = np.random.default_rng(23).poisson(50.0, (15, 1))
        ratio = self.ratio(counts, 50.0)
        assert np.isnan(ratio.error()).all()
        assert math.isnan(ratio.jackknife(lambda g: float(g[0])))
