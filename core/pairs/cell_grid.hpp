// Particles sorted by cell, and every pair of them within the cutoff exactly once.
//
// The box is cut into cells at least one cutoff wide; cells along x make a row.  Particles are copied in the order
// (cell, id), so a row is contiguous in memory.  A row meets itself and half of its neighbor rows (2D: the one above;
// 3D: the one above and the three behind); the images of the neighbor row, sheared or not, are reached by shifting
// it, so the inner loop knows no box.
//
// Rows of one color write to no common particle.  Colors are walked in order, the rows of a color in parallel: the
// order of summation on each particle depends on the positions alone, never on the number of threads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "box.hpp"
#include "state.hpp"
#include "threads.hpp"

namespace tether {

// A partner j of some particle i within the cutoff, by place in the sorted arrays, seen as the image of j that is
// near i.
template <int D>
struct Neighbor {
    std::size_t j;
    Vector<D> separation;   // r_i - r_image
    double square;          // |r_i - r_image|^2
    double image_velocity;  // what the image moves faster than particle j itself, along x
};

template <int D>
class CellGrid {
  private:
    // Particles [begin, end) of one row seen at position + shift, moving faster by image_velocity along x.
    struct Range {
        std::size_t begin, end;
        Vector<D> shift;
        double image_velocity;
    };
    struct Ranges {  // of one cell: at most three of each of five rows, and the cell itself
        Range part[16];
        std::size_t count = 0;
    };
    struct Hit {
        std::uint32_t j, range;
    };

  public:
    CellGrid(Box<D> const& box, double cutoff, std::size_t particles) : cutoff_(cutoff) {
        Vector<D> most;  // cells of one cutoff
        double all = 1.0;
        for (std::size_t k = 0; k < D; ++k) {
            most[k] = std::max(3.0, std::floor(box.length()[k] / cutoff));
            // A side of exactly n cutoffs may round to a width below the cutoff; one cell less is always right.
            if (box.length()[k] / most[k] < cutoff && most[k] > 3.0) most[k] -= 1.0;
            all *= most[k];
        }
        // A sparse box gets wider cells: empty ones cost time and memory too.
        double const enough = std::max(27.0, 4.0 * static_cast<double>(particles));
        double const widening = all > enough ? std::pow(all / enough, 1.0 / D) : 1.0;
        for (std::size_t k = 0; k < D; ++k) {
            cells_[k] = static_cast<long>(std::clamp(std::floor(most[k] / widening), 3.0, std::max(3.0, enough)));
            width_[k] = box.length()[k] / static_cast<double>(cells_[k]);
        }
        color_rows();
        start_.resize(static_cast<std::size_t>(cells_[0]) * rows() + 1);
    }

    std::size_t rows() const { return static_cast<std::size_t>(cells_[1] * (D == 3 ? cells_[D - 1] : 1)); }
    std::vector<std::vector<std::size_t>> const& colors() const { return colors_; }
    std::vector<std::uint32_t> const& ids() const { return id_; }  // id of the particle at each place

    // Sort by (cell, id).  Positions: whatever has size() and gives a Vector<D> for an id.
    template <class Positions>
    void sort(Positions const& position, Box<D> const& box, Team& team) {
        box_ = &box;
        std::size_t const n = position.size();
        cell_.resize(n);
        id_.resize(n);
        for (std::vector<double>& axis : coordinate_) axis.resize(n);
        team.ranges(n, block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i) cell_[i] = static_cast<std::uint32_t>(cell_of(position[i]));
        });
        std::fill(start_.begin(), start_.end(), 0u);
        for (std::size_t i = 0; i < n; ++i) ++start_[cell_[i] + 1];
        for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
        cursor_.assign(start_.begin(), start_.end() - 1);
        for (std::size_t i = 0; i < n; ++i) id_[cursor_[cell_[i]]++] = static_cast<std::uint32_t>(i);
        team.ranges(n, block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t place = begin; place < end; ++place)
                for (std::size_t k = 0; k < D; ++k) coordinate_[k][place] = position[id_[place]][k];
        });
    }

    // The partners of one particle: partners[k], k < partners.size(), is a Neighbor.
    class Partners {
      public:
        Partners(CellGrid const& grid, std::size_t i, Range const* ranges, Hit const* hits, std::size_t size)
            : grid_(grid), i_(i), ranges_(ranges), hits_(hits), size_(size) {}
        std::size_t size() const { return size_; }
        Neighbor<D> operator[](std::size_t k) const {
            Range const& range = ranges_[hits_[k].range];
            Neighbor<D> neighbor{hits_[k].j, {}, 0.0, range.image_velocity};
            for (std::size_t axis = 0; axis < D; ++axis) {
                std::vector<double> const& coordinate = grid_.coordinate_[axis];
                double const d = (coordinate[i_] - range.shift[axis]) - coordinate[neighbor.j];
                neighbor.separation[axis] = d;
                neighbor.square += d * d;
            }
            return neighbor;
        }

      private:
        CellGrid const& grid_;
        std::size_t i_;
        Range const* ranges_;
        Hit const* hits_;
        std::size_t size_;
    };

    // Call visit(i, partners) for every particle i of the row (by place) with its partners in this row and in the
    // neighbor rows that this row is charged with.
    template <class Visit>
    void for_each_pair(std::size_t row, Visit&& visit) const {
        thread_local std::vector<Hit> hits;
        Ranges ranges;
        for (long x = 0; x < cells_[0]; ++x) {
            std::size_t const home = cell_at(x, row);
            std::size_t const begin = start_[home], end = start_[home + 1];
            if (begin == end) continue;
            neighbor_ranges(ranges, x, row);
            std::size_t most = end - begin;
            for (std::size_t k = 0; k < ranges.count; ++k) most += ranges.part[k].end - ranges.part[k].begin;
            if (hits.size() < most) hits.resize(most);
            Range& own = ranges.part[ranges.count];
            for (std::size_t i = begin; i < end; ++i) {
                own = {i + 1, end, {}, 0.0};
                std::size_t count = 0;
                for (std::size_t k = 0; k <= ranges.count; ++k)
                    count = sift(i, ranges.part[k], static_cast<std::uint32_t>(k), hits.data(), count);
                visit(i, Partners(*this, i, ranges.part, hits.data(), count));
            }
        }
    }

    static constexpr std::size_t block = 1024;  // items of one unit of work in loops over particles

  private:
    std::size_t cell_of(Vector<D> const& r) const {
        std::size_t cell = 0;
        for (std::size_t k = D; k-- > 0;) {
            long const c = std::clamp(static_cast<long>(r[k] / width_[k]), 0l, cells_[k] - 1);
            cell = cell * static_cast<std::size_t>(cells_[k]) + static_cast<std::size_t>(c);
        }
        return cell;
    }
    std::size_t cell_at(long x, std::size_t row) const {
        return row * static_cast<std::size_t>(cells_[0]) + static_cast<std::size_t>(x);
    }

    // Append to `hits` the particles of a range within the cutoff of particle i; without a branch, because whether a
    // candidate is near is a coin toss that no predictor learns.
    std::size_t sift(std::size_t i, Range const& range, std::uint32_t which, Hit* hits, std::size_t count) const {
        Vector<D> at;
        for (std::size_t k = 0; k < D; ++k) at[k] = coordinate_[k][i] - range.shift[k];
        double const square_cutoff = cutoff_ * cutoff_;
        for (std::size_t j = range.begin; j < range.end; ++j) {
            double square = 0.0;
            for (std::size_t k = 0; k < D; ++k) {
                double const d = at[k] - coordinate_[k][j];
                square += d * d;
            }
            hits[count] = {static_cast<std::uint32_t>(j), which};
            count += square < square_cutoff;
        }
        return count;
    }

    // The cells lowest..highest (any integers) of a row along x, as contiguous ranges with the periods of x taken
    // into their shift.
    void cover(Ranges& ranges, std::size_t row, long lowest, long highest, Vector<D> const& shift,
               double image_velocity) const {
        while (lowest <= highest) {
            long const period = lowest >= 0 ? lowest / cells_[0] : -((cells_[0] - 1 - lowest) / cells_[0]);
            long const last = std::min(highest, (period + 1) * cells_[0] - 1);
            Range& part = ranges.part[ranges.count++];
            part.begin = start_[cell_at(lowest - period * cells_[0], row)];
            part.end = start_[cell_at(last - period * cells_[0], row) + 1];
            part.shift = shift;
            part.shift[0] += static_cast<double>(period) * box_->length()[0];
            part.image_velocity = image_velocity;
            lowest = last + 1;
        }
    }

    // What the cell x of a row meets besides itself.
    void neighbor_ranges(Ranges& ranges, long x, std::size_t row) const {
        long const y = static_cast<long>(row) % cells_[1], z = static_cast<long>(row) / cells_[1];
        ranges.count = 0;
        cover(ranges, row, x + 1, x + 1, {}, 0.0);
        add_row(ranges, x, y + 1, z);
        if constexpr (D == 3)
            for (long up = -1; up <= 1; ++up) add_row(ranges, x, y + up, z + 1);
    }

    void add_row(Ranges& ranges, long x, long y, long z) const {
        Vector<D> shift{};
        double image_velocity = 0.0;
        long lowest = x - 1, highest = x + 1;
        if (y < 0 || y >= cells_[1]) {  // through the sheared boundary: the neighbors stand at the box's offset
            double const up = y < 0 ? -1.0 : 1.0;
            y -= static_cast<long>(up) * cells_[1];
            shift[0] = up * box_->offset();
            shift[1] = up * box_->length()[1];
            image_velocity = up * box_->velocity_difference();
            double const left = static_cast<double>(x) * width_[0] - shift[0];
            lowest = static_cast<long>(std::floor((left - cutoff_) / width_[0]));
            highest = static_cast<long>(std::floor((left + width_[0] + cutoff_) / width_[0]));
        }
        if constexpr (D == 3)
            if (z == cells_[2]) {
                z = 0;
                shift[2] = box_->length()[2];
            }
        cover(ranges, static_cast<std::size_t>(y + cells_[1] * z), lowest, highest, shift, image_velocity);
    }

    // Rows of one color stand at least three apart in y or two in z, around the box too.
    void color_rows() {
        auto const color = [](long place, long cells, long apart) {
            long const regular = apart * (cells / apart);
            return place < regular ? place % apart : apart + place - regular;
        };
        colors_.assign(15, {});
        for (std::size_t row = 0; row < rows(); ++row) {
            long const y = static_cast<long>(row) % cells_[1], z = static_cast<long>(row) / cells_[1];
            long const of_z = D == 3 ? color(z, cells_[D - 1], 2) : 0;
            colors_[static_cast<std::size_t>(color(y, cells_[1], 3) + 5 * of_z)].push_back(row);
        }
        std::erase_if(colors_, [](std::vector<std::size_t> const& rows) { return rows.empty(); });
    }

    double cutoff_;
    std::array<long, D> cells_;
    Vector<D> width_;
    Box<D> const* box_ = nullptr;
    std::vector<std::vector<std::size_t>> colors_;
    std::vector<std::uint32_t> start_, cursor_, cell_, id_;
    std::array<std::vector<double>, D> coordinate_;
};

}  // namespace tether
