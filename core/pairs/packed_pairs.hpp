// DPD forces of all pairs on packs of particles, by the loops of kernels/: sorting into rows of bins, sharing the rows
// among threads, and turning integer forces into real ones.
//
// The box is cut into rows along x, at least one cutoff wide, and each row into bins of a quarter of a cutoff.  Particles
// are put into the order of (row, bin) in every step, so what is near a particle is contiguous in memory, row by row.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "laws/species_law.hpp"
#include "memory.hpp"
#include "pairs/pair_forces.hpp"

namespace tether {

template <int D>
Rows<D> rows_of(Box<D> const& box, double cutoff, std::size_t particles) {
    constexpr double bins_in_reach = 4.0;
    // Rows narrower than a cutoff would miss pairs; a side of exactly n cutoffs may round to a width below the cutoff.
    auto const most = [&](std::size_t axis) {
        double const cells = std::max(3.0, std::floor(box.length()[axis] / cutoff));
        return box.length()[axis] / cells < cutoff && cells > 3.0 ? cells - 1.0 : cells;
    };
    // A sparse box gets wider rows and bins: empty ones cost time and memory too.
    double all = 1.0;
    for (std::size_t k = 0; k < D; ++k) all *= most(k);
    double const enough = std::max(27.0, 2.0 * static_cast<double>(particles));
    double const widening = all > enough ? std::pow(all / enough, 1.0 / D) : 1.0;
    Rows<D> rows{};
    auto const count = [&](std::size_t axis) {
        return static_cast<std::int32_t>(std::clamp(std::floor(most(axis) / widening), 3.0, std::max(3.0, enough)));
    };
    rows.count[0] = count(1);
    rows.count[1] = D == 3 ? count(D - 1) : 1;
    // Twelve bins leave room for what the cutoff reaches to both sides, in a box of three cutoffs.
    double const bins = std::floor(box.length()[0] * bins_in_reach / (cutoff * widening));
    rows.bins = static_cast<std::int32_t>(std::clamp(bins, 12.0, 4.0 * enough));
    rows.per_length[0] = rows.bins / box.length()[0];
    for (std::size_t k = 1; k < D; ++k) rows.per_length[k] = rows.count[k - 1] / box.length()[k];
    rows.reach = static_cast<std::int32_t>(std::ceil(cutoff * rows.per_length[0] * (1.0 - 1e-12)));
    return rows;
}

template <int D, class Real>
class PackedPairs final : public PairForces<D> {
  public:
    // `species`: by id.
    PackedPairs(Box<D> const& box, LawNumbers const& law, double quantum, Kernels<D> const& kernels,
                std::vector<std::uint8_t> const& species)
        : kernels_(kernels),
          law_{law.table[0], nullptr, static_cast<std::uint32_t>(law.species), law.half_exponent, law.noise_kind},
          kind_(law.kind),
          quantum_(quantum),
          width_(static_cast<float>(box.length()[0])),
          rows_(rows_of(box, law.largest_cutoff(), species.size())) {
        std::size_t const particles = species.size();
        law_.uniform.cutoff = law.largest_cutoff();
        if (!law.is_plain()) {
            for (PairNumbers const& of_pair : law.table) table_.push_back(steep_parameters<Real>(of_pair));
            law_.table = table_.data();
            species_ = law.known(species);
        }
        for (std::size_t k = 0; k < D; ++k)
            unit_[k] = sizeof(Real) == 4 ? static_cast<float>(box.length()[k] / 4294967296.0) : 1.0f;
        for (double side : box.length())
            if (side < 3.0 * law_.uniform.cutoff * (1.0 - 1e-12))
                throw std::invalid_argument("a side of the box is below three cutoffs");
        if (particles >= std::size_t{1} << 27) throw std::invalid_argument("more than 2^27 particles");
        row_count_ = static_cast<std::size_t>(rows_.count[0]) * static_cast<std::size_t>(rows_.count[1]);
        row_start_.resize(row_count_ + 1);
        bin_start_.resize(row_count_ * rows_.bin_starts());
        records_.resize(particles);
        row_.resize(particles);
        bin_.resize(particles);
        bucket_.resize(particles);
        order_.resize(particles);
        sorted_.resize(particles + padding);
        sorted_bin_.resize(particles);
        forces_.resize(particles + padding);
        for (Array<float>& column : near_) column.resize(2 * particles + padding);
        other_.resize(2 * particles + padding);
        virials_.resize(row_count_ * virial_values<D>);
        chunk_ = std::max<std::size_t>(4096, (particles + 15) / 16);
        counts_.resize((particles + chunk_ - 1) / chunk_ * row_count_);
        share_rows();
    }

    void note(Columns<D> const& particles, Box<D> const& box, StepKey const& key, double prediction, std::size_t begin,
              std::size_t end) override {
        kernels_.record[precision](
            {particles, box.numbers(), rows_, key, prediction, species_.empty() ? nullptr : species_.data(),
             records_.data(), row_.data(), bin_.data()},
            begin, end);
    }

    PairVirial<D> compute(bool stress, State<D>& state, Box<D> const& box, Team& team, Stopwatch& watch) override {
        sort(team);
        watch.lap(Phase::sort);
        PairArguments<D> arguments{};
        arguments.box = box.numbers();
        arguments.rows = rows_;
        arguments.law = law_;
        arguments.quantum = quantum_;
        arguments.particles = static_cast<std::uint32_t>(state.size());
        arguments.records = sorted_.data();
        arguments.forces = forces_.data();
        arguments.bin = sorted_bin_.data();
        arguments.row_start = row_start_.data();
        for (std::size_t k = 0; k < D; ++k) arguments.near[k] = near_[k].data();
        arguments.other = other_.data();
        arguments.bin_start = bin_start_.data();
        auto const loop = kernels_.pairs[precision][!table_.empty()][static_cast<int>(kind_)][stress];
        auto const work = [&](Stretch const& rows) {
            loop(arguments, rows.begin, rows.end, virials_.data() + rows.begin * virial_values<D>);
        };
        if (team.size() == 1)
            work({0, row_count_});
        else
            for (std::vector<Share> const& color : colors_)
                team.each(color.size(), [&](std::size_t unit) {
                    for (Stretch const& rows : color[unit]) work(rows);
                });
        watch.lap(Phase::pairs);
        take_forces(state, team);
        watch.lap(Phase::forces);
        PairVirial<D> sum;
        if (stress)
            for (std::size_t r = 0; r < row_count_; ++r) sum += PairVirial<D>(virials_.data() + r * virial_values<D>);
        return sum;
    }

    Array<std::uint32_t> const& order() const override { return order_; }  // (row, bin)

  private:
    static constexpr int precision = static_cast<int>(sizeof(Real) == 4 ? Precision::mixed : Precision::full);
    struct Stretch {
        std::size_t begin, end;  // rows
    };
    using Share = std::vector<Stretch>;

    // By row first, chunks of particles in parallel; then by bin, rows in parallel.  Both keep the order of places, so
    // the outcome depends on the state alone.
    void sort(Team& team) {
        std::size_t const n = records_.size(), chunks = (n + chunk_ - 1) / chunk_;
        team.ranges(n, chunk_, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
            std::uint32_t* const count = counts_.data() + chunk * row_count_;
            std::fill(count, count + row_count_, 0u);
            for (std::size_t i = begin; i < end; ++i) ++count[row_[i]];
        });
        std::uint32_t sum = 0;
        for (std::size_t row = 0; row < row_count_; ++row) {
            row_start_[row] = sum;
            for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
                std::uint32_t& count = counts_[chunk * row_count_ + row];
                std::uint32_t const here = count;
                count = sum;
                sum += here;
            }
        }
        row_start_[row_count_] = sum;
        team.ranges(n, chunk_, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
            std::uint32_t* const next = counts_.data() + chunk * row_count_;
            for (std::size_t i = begin; i < end; ++i)
                bucket_[next[row_[i]]++] = {static_cast<std::uint32_t>(i), bin_[i]};
        });
        team.ranges(row_count_, rows_at_once, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t row = begin; row < end; ++row) sort_row(row);
        });
    }

    void sort_row(std::size_t row) {
        auto const bins = static_cast<std::size_t>(rows_.bins), copied = static_cast<std::size_t>(rows_.copied_bins());
        std::uint32_t const first = row_start_[row], last = row_start_[row + 1];
        // How many are in each bin; then where the next one of each goes
        thread_local std::vector<std::uint32_t> next;
        next.assign(bins, 0u);
        for (std::uint32_t s = first; s < last; ++s) ++next[bucket_[s].bin];
        std::uint32_t* const start = bin_start_.data() + row * rows_.bin_starts();
        std::uint32_t sum = first;
        for (std::size_t b = 0; b < bins; ++b) {
            start[b] = first + sum;  // entries of a row begin at twice its first place
            std::uint32_t const here = next[b];
            next[b] = sum;
            sum += here;
        }
        for (std::size_t b = 0; b <= copied; ++b) start[bins + b] = start[b] + (last - first);
        for (std::uint32_t s = first; s < last; ++s) {
            if (s + far_ahead < last) __builtin_prefetch(&records_[bucket_[s + far_ahead].place]);
            Bucketed const from = bucket_[s];
            std::uint32_t const to = next[from.bin]++;
            Record<Real> const& record = records_[from.place];
            order_[to] = from.place;
            sorted_[to] = record;
            sorted_bin_[to] = from.bin;
            for (std::size_t k = 0; k < D; ++k)
                near_[k][first + to] = static_cast<float>(record.position[k]) * unit_[k];
        }
        for (std::uint32_t s = first; s < last; ++s)
            other_[first + s] = s * static_cast<std::uint32_t>(sizeof(Quanta<Real>));
        // The first bins once more, one period further
        std::uint32_t const begin = 2 * first, end = start[copied], shift = last - first;
        for (std::size_t k = 0; k < D; ++k) {
            float const period = k == 0 ? width_ : 0.0f;
            for (std::uint32_t e = begin; e < end; ++e) near_[k][e + shift] = near_[k][e] + period;
        }
        for (std::uint32_t e = begin; e < end; ++e) other_[e + shift] = other_[e];
    }

    void take_forces(State<D>& state, Team& team) {
        team.ranges(state.size(), particles_at_once, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t s = begin; s < end; ++s) {
                Quanta<Real> const quanta =
                    std::exchange(forces_[s], {});  // zero for the next step, while it is at hand
                for (std::size_t k = 0; k < D; ++k)
                    state.force.axis[k][order_[s]] = quantum_ * static_cast<double>(quanta.axis[k]);
            }
        });
    }

    // Shares of neighboring rows such that no two of one color add to the force of a common particle: a row meets the
    // next along y, and those above and beside it along z.  Shares are cut along both into an even number of parts, so
    // that two colors along each will do around the box too; those along y hold two rows at least.
    void share_rows() {
        auto const rows_y = static_cast<std::size_t>(rows_.count[0]), rows_z = static_cast<std::size_t>(rows_.count[1]);
        std::size_t const parts_y = rows_y < 4 ? 1 : 2 * std::max<std::size_t>(1, (rows_y + 4) / 8);
        std::size_t const parts_z = rows_z == 1 ? 1 : rows_z / 2 * 2;
        colors_.assign(4, {});
        for (std::size_t part_z = 0; part_z < parts_z; ++part_z)
            for (std::size_t part_y = 0; part_y < parts_y; ++part_y) {
                Share share;
                for (std::size_t z = part_z * rows_z / parts_z; z < (part_z + 1) * rows_z / parts_z; ++z)
                    share.push_back(
                        {z * rows_y + part_y * rows_y / parts_y, z * rows_y + (part_y + 1) * rows_y / parts_y});
                colors_[2 * (part_z % 2) + part_y % 2].push_back(std::move(share));
            }
        std::erase_if(colors_, [](std::vector<Share> const& shares) { return shares.empty(); });
    }

    static constexpr std::size_t rows_at_once = 8, particles_at_once = 2048;
    static constexpr std::uint32_t far_ahead = 16;  // particles to fetch before they are needed

    Kernels<D> kernels_;
    std::vector<SteepParameters<Real>> table_;  // of laws and species, if there is more than one
    std::vector<std::uint8_t> species_;         // by id
    LawArguments law_;
    LawKind kind_;
    double quantum_;
    float width_;
    std::array<float, D> unit_;  // of a record's position
    Rows<D> rows_;
    std::size_t row_count_, chunk_;
    std::vector<std::vector<Share>> colors_;
    Array<Record<Real>> records_, sorted_;
    Array<Quanta<Real>> forces_;
    std::array<Array<float>, D> near_;
    Array<std::uint32_t> row_, bin_;  // by place
    struct Bucketed {
        std::uint32_t place, bin;
    };
    Array<Bucketed> bucket_;           // by row
    Array<std::uint32_t> order_;       // places, by row and bin
    Array<std::uint32_t> sorted_bin_;  // by row and bin
    Array<std::uint32_t> row_start_, bin_start_;
    Array<std::uint32_t> other_;
    std::vector<std::uint32_t> counts_;  // of each chunk's particles in each row; then where its next one goes
    std::vector<double> virials_;        // of each row
};

}  // namespace tether
