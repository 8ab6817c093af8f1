// DPD forces of all pairs on one CPU: the loop, and what is kept in the order of the cells to make it fast.
#pragma once

#include <vector>

#include "laws/dpd.hpp"
#include "noise.hpp"
#include "observe/sample.hpp"
#include "pairs/cell_grid.hpp"

namespace tether {

template <int D>
class PairForces {
  public:
    PairForces(Box<D> const& box, double cutoff, std::size_t particles)
        : grid_(box, cutoff, particles), virials_(grid_.rows()) {}

    // Set state.force to the DPD forces at (position, velocity) and return their virials (all zero unless `Stress`).
    template <bool Stress, class Noise, class Law>
    PairVirial<D> compute(Law const& law, DpdParameters<double> const& parameters, StepKey const& key, State<D>& state,
                          std::vector<Vector<D>> const& velocity, Box<D> const& box, Team& team) {
        grid_.sort(state.position, box, team);
        std::vector<std::uint32_t> const& id = grid_.ids();
        velocity_.resize(id.size());
        force_.resize(id.size());
        constexpr std::size_t block = CellGrid<D>::block;
        team.ranges(id.size(), block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t place = begin; place < end; ++place) {
                velocity_[place] = velocity[id[place]];
                force_[place] = {};
            }
        });
        for (std::vector<std::size_t> const& color : grid_.colors())
            team.each(color.size(), [&](std::size_t unit) {
                virials_[color[unit]] = row<Stress, Noise>(color[unit], law, parameters, key);
            });
        team.ranges(id.size(), block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t place = begin; place < end; ++place) state.force[id[place]] = force_[place];
        });
        PairVirial<D> sum;
        if constexpr (Stress)
            for (PairVirial<D> const& part : virials_) sum += part;
        return sum;
    }

  private:
    template <bool Stress, class Noise, class Law>
    PairVirial<D> row(std::size_t row, Law const& law, DpdParameters<double> const& parameters, StepKey const& key) {
        PairVirial<D> virial;
        std::vector<std::uint32_t> const& id = grid_.ids();
        grid_.for_each_pair(row, [&](std::size_t i, auto const& partners) {
            Vector<D> const velocity = velocity_[i];
            Vector<D> force = force_[i];
            for (std::size_t k = 0; k < partners.size(); ++k) {
                Neighbor<D> const n = partners[k];
                double const distance = std::sqrt(n.square);
                double const inverse =
                    distance > 0.0 ? 1.0 / distance : 0.0;  // two particles on one point push nowhere
                Vector<D> relative = velocity - velocity_[n.j];
                relative[0] -= n.image_velocity;
                std::uint32_t const lower = std::min(id[i], id[n.j]), higher = std::max(id[i], id[n.j]);
                double const noise = Noise::template draw<double>(pair_bits(key, lower, higher));
                Pair<double> const pair{distance, dot(n.separation, relative) * inverse, noise};
                PairForce<double> const magnitude = law(pair, parameters);
                Vector<D> const pull = (magnitude.total() * inverse) * n.separation;
                force += pull;
                force_[n.j] -= pull;
                if constexpr (Stress)
                    virial.add(n.separation, magnitude.conservative * inverse, magnitude.dissipative * inverse,
                               magnitude.random * inverse);
            }
            force_[i] = force;
        });
        return virial;
    }

    CellGrid<D> grid_;
    std::vector<PairVirial<D>> virials_;  // of each row, so that their sum is taken in one order
    std::vector<Vector<D>> velocity_, force_;
};

}  // namespace tether
