// DPD forces of all pairs, one pair after the other in double precision: the plain engine that the fast one is held
// against.
#pragma once

#include <variant>
#include <vector>

#include "laws/dpd.hpp"
#include "pairs/cell_grid.hpp"
#include "pairs/pair_forces.hpp"

namespace tether {

template <int D>
class ReferencePairs final : public PairForces<D> {
  public:
    ReferencePairs(Box<D> const& box, LawNumbers const& numbers, LawKind kind, std::size_t particles)
        : law_(law_of(kind, numbers.half_exponent)),
          parameters_{numbers.repulsion, numbers.friction, numbers.noise_amplitude, 1.0 / numbers.cutoff},
          noise_kind_(numbers.noise_kind),
          grid_(box, numbers.cutoff, particles),
          virials_(grid_.rows()),
          word_(particles),
          predicted_(particles) {}

    void note(Columns<D> const& particles, Box<D> const&, StepKey const& key, double prediction, std::size_t begin,
              std::size_t end) override {
        for (std::size_t p = begin; p < end; ++p) {
            word_[p] = particle_word(key, particles.id[p]);
            double const per_force = prediction * particles.inverse_mass[p];
            for (std::size_t k = 0; k < D; ++k)
                predicted_[p][k] = particles.velocity[k][p] + per_force * particles.force[k][p];
        }
    }

    PairVirial<D> compute(bool stress, State<D>& state, Box<D> const& box, Team& team, Stopwatch& watch) override {
        grid_.sort(state.position, box, team);
        watch.lap(Phase::sort);
        force_.assign(state.size(), {});
        std::visit(
            [&](auto const& law) {
                if (noise_kind_ == NoiseKind::uniform)
                    rows<UniformNoise>(law, stress, team);
                else
                    rows<GaussianNoise>(law, stress, team);
            },
            law_);
        watch.lap(Phase::pairs);
        std::vector<std::uint32_t> const& place = grid_.ids();
        for (std::size_t s = 0; s < place.size(); ++s) state.force.set(place[s], force_[s]);
        watch.lap(Phase::forces);
        PairVirial<D> sum;
        if (stress)
            for (PairVirial<D> const& part : virials_) sum += part;
        return sum;
    }

    Array<std::uint32_t> const& order() const override { return no_order_; }

  private:
    using AnyLaw = std::variant<Dpd<HalfPower>, Dpd<SquarePower>, Dpd<AnyPower>>;

    static AnyLaw law_of(LawKind kind, double half_exponent) {
        if (kind == LawKind::half_power) return Dpd<HalfPower>{};
        if (kind == LawKind::square_power) return Dpd<SquarePower>{};
        return Dpd<AnyPower>{{half_exponent}};
    }

    template <class Noise, class Law>
    void rows(Law const& law, bool stress, Team& team) {
        for (std::vector<std::size_t> const& color : grid_.colors())
            team.each(color.size(),
                      [&](std::size_t unit) { virials_[color[unit]] = row<Noise>(color[unit], law, stress); });
    }

    template <class Noise, class Law>
    PairVirial<D> row(std::size_t row, Law const& law, bool stress) {
        PairVirial<D> virial;
        std::vector<std::uint32_t> const& place = grid_.ids();
        grid_.for_each_pair(row, [&](std::size_t i, auto const& partners) {
            for (std::size_t k = 0; k < partners.size(); ++k) {
                Neighbor<D> const n = partners[k];
                double const distance = std::sqrt(n.square);
                double const inverse =
                    distance > 0.0 ? 1.0 / distance : 0.0;  // two particles on one point push nowhere
                Vector<D> relative = predicted_[place[i]] - predicted_[place[n.j]];
                relative[0] -= n.image_velocity;
                double const noise = Noise::template draw<double>(pair_bits(word_[place[i]] + word_[place[n.j]]));
                Pair<double> const pair{distance, dot(n.separation, relative) * inverse, noise};
                PairForce<double> const magnitude = law(pair, parameters_);
                Vector<D> const pull = (magnitude.total() * inverse) * n.separation;
                force_[i] += pull;
                force_[n.j] -= pull;
                if (stress)
                    virial.add(n.separation, magnitude.conservative * inverse, magnitude.dissipative * inverse,
                               magnitude.random * inverse);
            }
        });
        return virial;
    }

    AnyLaw law_;
    DpdParameters<double> parameters_;
    NoiseKind noise_kind_;
    CellGrid<D> grid_;
    std::vector<PairVirial<D>> virials_;  // of each row, so that their sum is taken in one order
    std::vector<std::uint32_t> word_;     // of noise, by place
    std::vector<Vector<D>> predicted_;    // velocity, by place
    std::vector<Vector<D>> force_;        // in the order of the cells
    Array<std::uint32_t> no_order_;
};

}  // namespace tether
