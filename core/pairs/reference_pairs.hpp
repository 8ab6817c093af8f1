// DPD forces of all pairs, one pair after the other in double precision: the plain engine that the fast one is held
// against.
#pragma once

#include <vector>

#include "pairs/pair_forces.hpp"
#include "pairs/pair_walk.hpp"

namespace tether {

template <int D>
class ReferencePairs final : public PairForces<D> {
  public:
    // `species`: by id.
    ReferencePairs(Box<D> const& box, LawNumbers const& law, std::vector<std::uint8_t> const& species)
        : walk_(box, law, species), virials_(walk_.rows()) {}

    void note(Columns<D> const& particles, Box<D> const&, StepKey const& key, double prediction, std::size_t begin,
              std::size_t end) override {
        walk_.note(particles, key, prediction, begin, end);
    }

    PairVirial<D> compute(bool stress, State<D>& state, Box<D> const& box, Team& team, Stopwatch& watch) override {
        walk_.sort(state, box, team);
        watch.lap(Phase::sort);
        force_.assign(state.size(), {});
        virials_.assign(virials_.size(), {});
        walk_.each(team, [&](std::size_t row, WalkedPair<D> const& pair, auto const&) {
            Vector<D> const pull = (pair.force.total() * pair.inverse_distance) * pair.separation;
            force_[pair.i] += pull;
            force_[pair.j] -= pull;
            if (stress)
                virials_[row].add(pair.separation, pair.force.conservative * pair.inverse_distance,
                                  pair.force.dissipative * pair.inverse_distance,
                                  pair.force.random * pair.inverse_distance);
        });
        watch.lap(Phase::pairs);
        std::vector<std::uint32_t> const& place = walk_.places();
        for (std::size_t s = 0; s < place.size(); ++s) state.force.set(place[s], force_[s]);
        watch.lap(Phase::forces);
        PairVirial<D> sum;
        if (stress)
            for (PairVirial<D> const& part : virials_) sum += part;
        return sum;
    }

    Array<std::uint32_t> const& order() const override { return no_order_; }

  private:
    PairWalk<D> walk_;
    std::vector<PairVirial<D>> virials_;  // of each row, so that their sum is taken in one order
    std::vector<Vector<D>> force_;        // in the order of the cells
    Array<std::uint32_t> no_order_;
};

}  // namespace tether
