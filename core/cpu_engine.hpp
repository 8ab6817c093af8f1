// The CPU engine: a suspension and its step.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "bodies/bodies.hpp"
#include "flow.hpp"
#include "kernels/instruction_set.hpp"
#include "laws/species_law.hpp"
#include "observe/local_stress.hpp"
#include "observe/sample.hpp"
#include "pairs/pair_forces.hpp"
#include "schemes/velocity_verlet.hpp"
#include "stopwatch.hpp"

namespace tether {

// How pairs are computed.  The reference is one pair after the other in double precision, on any processor.
struct PairEngine {
    bool is_reference = false;
    Precision precision = Precision::mixed;
    std::string instruction_set;  // empty: the widest there is
};

// A particle that ran away: the step, the particle's id and its speed (not a number, perhaps).
struct Fault {
    std::uint64_t step;
    std::size_t particle;
    double speed;
};

template <int D>
class CpuEngine {
  public:
    // `law`: in which noise amplitudes are sigma/sqrt(dt).  The box shears as `shear` says.
    CpuEngine(Box<D> const& box_, LawNumbers const& law, Shear shear, Driving const& driving, double timestep,
              double lambda, std::uint64_t seed, std::vector<double> species_mass, std::vector<std::uint8_t> species,
              PairEngine const& pairs, int threads);

    void add_bodies(std::unique_ptr<Bodies<D>> kind) { bodies.push_back(std::move(kind)); }
    LawNumbers const& law() const { return law_; }
    // The rounding of forces, which are summed as its multiples.
    double force_quantum(Precision precision) const;
    // Look at the local stress in `bins` at the end of every step that `interval` divides; once all bodies are there.  No
    // longer with 0 bins.
    void observe_stress(std::size_t bins, std::uint64_t interval);
    // What has been seen since the last call, LocalStress::values() numbers for each step.
    std::vector<double> take_stress() { return std::exchange(seen_, {}); }
    std::size_t stress_values() const { return local_ ? local_->values() : 0; }

    // Steps at rest in which no particle moves further than `displacement` a step, so that overlaps of a random start
    // are pushed apart and blow nothing up; bases of springs stand massless.  Neither box nor step counter moves.
    // The steps are `first` + 1 to `first` + `steps`, so that they can be taken in portions.
    void start_gently(std::uint64_t first, std::uint64_t steps, double displacement);
    // Stand the bases on their constituents and compute the forces that the first step begins with.
    void place();
    // Stand at the end of a step that was reached elsewhere.
    void stand_at(std::uint64_t step) {
        state.step = step;
        box.set_shear_rate(shear_.rate(std::max<std::uint64_t>(step, 1), scheme_.timestep));
    }
    // Advance by `steps`.  With interval > 0 every step is measured and the means over each `interval` steps (a
    // divisor of `steps`) are returned, Sample<D>::values numbers each.  Stops at once when a particle runs away; see
    // `fault`.
    std::vector<double> run(std::uint64_t steps, std::uint64_t interval);

    Box<D> box;
    State<D> state;
    std::vector<std::unique_ptr<Bodies<D>>> bodies;
    std::optional<Fault> fault;
    Stopwatch watch;
    int threads() { return team_.size(); }
    Team& team() { return team_; }
    std::string const& instruction_set() const { return instruction_set_; }

  private:
    void step(Sample<D>* sample);
    void follow_shear();
    void settle();
    void look_out();  // set `fault` if a particle runs away
    void forces(Holding const& holding, Sample<D>* sample);
    void note_bodies(StepKey const& key);
    bool is_observed() const { return local_ && local_->is_due(state.step); }
    void note_all(StepKey const& key);
    void put_in_order(std::uint64_t number);

    LawNumbers law_;
    Shear shear_;
    Driving driving_;
    VelocityVerlet<D> scheme_;
    std::uint64_t seed_;
    bool owes_kick_ = false;
    std::size_t solvent_;
    std::string instruction_set_;  // of the pair loop; empty for the reference
    Kernels<D> kernels_;
    std::unique_ptr<PairForces<D>> pairs_;
    std::unique_ptr<LocalStress<D>> local_;
    std::vector<double> seen_;
    Team team_;
};

}  // namespace tether
