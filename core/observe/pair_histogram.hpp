// How many pairs of points stand at which distance, and at which separation in the plane of flow and gradient.
//
// Counts are integers, whose sum has no order: the result depends neither on the number of threads nor on the order of
// the points.  Up to a third of the smallest side pairs come from the cell grid; up to half of it from a look at every
// pair.  Farther they are not counted: two images of one point are at least the smallest side apart, whatever the
// offset, so within half of it a point has one image and the nearest image is that one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "box.hpp"
#include "pairs/cell_grid.hpp"
#include "threads.hpp"

namespace tether {

using Counts = std::vector<std::uint64_t>;

// The sum of `size` counts over units of work, work(first, step, counts): a unit does items first, first + step, ...
template <class Work>
Counts counted(std::size_t size, Team& team, Work&& work) {
    std::size_t const units = team.size() > 1 ? 4 * static_cast<std::size_t>(team.size()) : 1;
    std::vector<Counts> part(units, Counts(size, 0));
    team.each(units, [&](std::size_t unit) { work(unit, units, part[unit]); });
    Counts sum = std::move(part[0]);
    for (std::size_t unit = 1; unit < units; ++unit)
        for (std::size_t k = 0; k < size; ++k) sum[k] += part[unit][k];
    return sum;
}

template <int D>
double smallest_side(Box<D> const& box) {
    return *std::min_element(box.length().begin(), box.length().end());
}

// Call visit(i, j, separation r_i - r_j of the nearest images, counts) for every pair of points within the range, and
// for others too where the box is too small for cells.
template <int D, class Visit>
Counts count_pairs(std::vector<Vector<D>> const& position, Box<D> const& box, double range, std::size_t size,
                   Team& team, Visit&& visit) {
    if (3.0 * range > smallest_side(box))
        return counted(size, team, [&](std::size_t first, std::size_t step, Counts& counts) {
            for (std::size_t i = first; i < position.size(); i += step)
                for (std::size_t j = i + 1; j < position.size(); ++j) {
                    Vector<D> separation = position[i] - position[j], unused{};
                    box.nearest_image(separation, unused);
                    visit(i, j, separation, counts);
                }
        });
    CellGrid<D> grid(box, range, position.size());
    grid.sort(position, box, team);
    std::vector<std::uint32_t> const& id = grid.ids();
    return counted(size, team, [&](std::size_t first, std::size_t step, Counts& counts) {
        for (std::size_t row = first; row < grid.rows(); row += step)
            grid.for_each_pair(row, [&](std::size_t i, auto const& partners) {
                for (std::size_t k = 0; k < partners.size(); ++k) {
                    Neighbor<D> const n = partners[k];
                    visit(id[i], id[n.j], n.separation, counts);
                }
            });
    });
}

// Pairs by labels and distance: entry (a, b, k) of an array (labels, labels, bins) is the number of pairs of one point
// labelled a and one labelled b, every pair once, with k w <= distance < (k + 1) w and w = range/bins.  It is symmetric
// in a and b.  A distance within rounding of an edge may be on either side of it.  Points stand inside the box; the
// range is at most half of its smallest side.
template <int D>
Counts pair_histogram(std::vector<Vector<D>> const& position, std::span<std::uint8_t const> label, std::size_t labels,
                      Box<D> const& box, double range, std::size_t bins, Team& team) {
    double const per_length = static_cast<double>(bins) / range;
    auto const add = [&](std::size_t i, std::size_t j, Vector<D> const& r, Counts& counts) {
        double const square = dot(r, r);
        if (square >= range * range) return;
        auto const bin = std::min(static_cast<std::size_t>(std::sqrt(square) * per_length), bins - 1);
        std::size_t const a = label[i], b = label[j];
        ++counts[(std::min(a, b) * labels + std::max(a, b)) * bins + bin];
    };
    Counts counts = count_pairs<D>(position, box, range, labels * labels * bins, team, add);
    for (std::size_t a = 0; a < labels; ++a)
        for (std::size_t b = 0; b < a; ++b)
            for (std::size_t k = 0; k < bins; ++k)
                counts[(a * labels + b) * bins + k] = counts[(b * labels + a) * bins + k];
    return counts;
}

// Pairs by separation (x, y) in the plane of flow and gradient: entry (k, l) of an array (bins, bins) is the number of
// ordered pairs with y in [-range + k w, -range + (k + 1) w), x likewise in l, w = 2 range/bins, and in 3D |z| below
// `thickness`.  Ordered: a pair counts at r_ij and at r_ji, so the map looks the same turned by half a turn.  The range
// is at most half of the sides in x and y, the thickness half of that in z.
template <int D>
Counts pair_map(std::vector<Vector<D>> const& position, Box<D> const& box, double range, std::size_t bins,
                double thickness, Team& team) {
    double const per_length = static_cast<double>(bins) / (2.0 * range);
    auto const bin = [&](double s) { return std::min(static_cast<std::size_t>((s + range) * per_length), bins - 1); };
    auto const add = [&](std::size_t, std::size_t, Vector<D> const& r, Counts& counts) {
        if (D == 3 && !(std::abs(r[D - 1]) < thickness)) return;
        for (double sign : {1.0, -1.0}) {
            double const x = sign * r[0], y = sign * r[1];
            if (x >= -range && x < range && y >= -range && y < range) ++counts[bin(y) * bins + bin(x)];
        }
    };
    double const corner = std::hypot(range, range, D == 3 ? thickness : 0.0);
    return count_pairs<D>(position, box, corner, bins * bins, team, add);
}

}  // namespace tether
