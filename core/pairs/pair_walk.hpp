// Every pair, one after the other, in double precision: what the reference engine computes forces by, and what measures
// more of a pair than the fast loop does.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

#include "box.hpp"
#include "laws/species_law.hpp"
#include "noise.hpp"
#include "pairs/cell_grid.hpp"
#include "state.hpp"
#include "threads.hpp"

namespace tether {

// A pair as the walk shows it.  i and j are places in the order of the walk's cells; `place` tells them in memory.
template <int D>
struct WalkedPair {
    std::size_t i, j;
    std::uint32_t place_i, place_j;
    Vector<D> separation;               // r_i - r_j, nearest images
    double distance, inverse_distance;  // the latter 0 for two particles on one point, which push nowhere
    PairForce<double> force;            // along the separation
};

template <int D>
class PairWalk {
  public:
    // `species`: by id.
    PairWalk(Box<D> const& box, LawNumbers const& law, std::vector<std::uint8_t> species)
        : law_(species_law(law)),
          noise_kind_(law.noise_kind),
          species_(law.known(std::move(species))),
          grid_(box, law.largest_cutoff(), species_.size()),
          word_(species_.size()),
          predicted_(species_.size()) {}

    // As PairForces::note.
    void note(Columns<D> const& particles, StepKey const& key, double prediction, std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            word_[p] = particle_word(key, particles.id[p]);
            double const per_force = prediction * particles.inverse_mass[p];
            for (std::size_t k = 0; k < D; ++k)
                predicted_[p][k] = particles.velocity[k][p] + per_force * particles.force[k][p];
        }
    }

    void sort(State<D> const& state, Box<D> const& box, Team& team) {
        grid_.sort(state.position, box, team);
        of_place_.resize(state.size());
        for (std::size_t p = 0; p < state.size(); ++p) of_place_[p] = species_[state.id[p]];
    }

    std::size_t rows() const { return grid_.rows(); }
    std::vector<std::uint32_t> const& places() const { return grid_.ids(); }

    // Call visit(row, pair, law) for every pair within its cutoff; `law` is the SpeciesLaw.  Rows of one color, which
    // have no particle in common, are walked in parallel.
    template <class Visit>
    void each(Team& team, Visit&& visit) {
        std::visit(
            [&](auto const& law) {
                if (noise_kind_ == NoiseKind::uniform)
                    colors<UniformNoise>(law, team, visit);
                else
                    colors<GaussianNoise>(law, team, visit);
            },
            law_);
    }

    std::uint8_t species_at(std::uint32_t place) const { return of_place_[place]; }

  private:
    template <class Noise, class Law, class Visit>
    void colors(Law const& law, Team& team, Visit&& visit) {
        for (std::vector<std::size_t> const& color : grid_.colors())
            team.each(color.size(), [&](std::size_t unit) { walk<Noise>(color[unit], law, visit); });
    }

    template <class Noise, class Law, class Visit>
    void walk(std::size_t row, Law const& law, Visit&& visit) {
        std::vector<std::uint32_t> const& place = grid_.ids();
        grid_.for_each_pair(row, [&](std::size_t i, auto const& partners) {
            for (std::size_t k = 0; k < partners.size(); ++k) {
                Neighbor<D> const n = partners[k];
                WalkedPair<D> pair{i, n.j, place[i], place[n.j], n.separation, std::sqrt(n.square), 0.0, {}};
                std::size_t const species_i = of_place_[pair.place_i], species_j = of_place_[pair.place_j];
                if (!(pair.distance < law.cutoff(species_i, species_j))) continue;
                pair.inverse_distance = pair.distance > 0.0 ? 1.0 / pair.distance : 0.0;
                Vector<D> relative = predicted_[pair.place_i] - predicted_[pair.place_j];
                relative[0] -= n.image_velocity;
                double const noise = Noise::template draw<double>(pair_bits(word_[pair.place_i] + word_[pair.place_j]));
                pair.force =
                    law(Pair<double>{pair.distance, dot(n.separation, relative) * pair.inverse_distance, noise},
                        species_i, species_j);
                visit(row, pair, law);
            }
        });
    }

    AnySpeciesLaw law_;
    NoiseKind noise_kind_;
    std::vector<std::uint8_t> species_;   // by id
    std::vector<std::uint8_t> of_place_;  // by place
    CellGrid<D> grid_;
    std::vector<std::uint32_t> word_;   // of noise, by place
    std::vector<Vector<D>> predicted_;  // velocity, by place
};

}  // namespace tether
