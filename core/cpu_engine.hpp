// The CPU engine: a suspension and its step.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bodies/tethered.hpp"
#include "kernels/instruction_set.hpp"
#include "observe/sample.hpp"
#include "pairs/pair_forces.hpp"
#include "schemes/velocity_verlet.hpp"
#include "stopwatch.hpp"

namespace tether {

struct FluidParameters {
    double repulsion, friction, noise;  // a (force), gamma (force time/length), sigma (force sqrt time)
    double cutoff, exponent;            // r_c (length), s
    NoiseKind noise_kind;
};

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
    CpuEngine(Box<D> const& box_, FluidParameters const& fluid, double timestep, double lambda, std::uint64_t seed,
              std::vector<double> species_mass, std::vector<std::uint8_t> species, PairEngine const& pairs,
              int threads);

    void add_bodies(TetheredBodies<D> kind) { bodies.push_back(std::move(kind)); }

    // Steps at rest in which no particle moves further than `displacement` a step, so that overlaps of a random start
    // are pushed apart and blow nothing up; bases stand massless.  Neither box nor step counter moves.
    // The steps are `first` + 1 to `first` + `steps`, so that they can be taken in portions.
    void start_gently(std::uint64_t first, std::uint64_t steps, double displacement);
    // Stand the bases on their constituents and compute the forces that the first step begins with.
    void place();
    // Advance by `steps`.  With interval > 0 every step is measured and the means over each `interval` steps (a
    // divisor of `steps`) are returned, Sample<D>::values numbers each.  Stops at once when a particle runs away; see
    // `fault`.
    std::vector<double> run(std::uint64_t steps, std::uint64_t interval);

    Box<D> box;
    State<D> state;
    std::vector<TetheredBodies<D>> bodies;
    std::optional<Fault> fault;
    Stopwatch watch;
    int threads() { return team_.size(); }
    Team& team() { return team_; }
    std::string const& instruction_set() const { return instruction_set_; }

  private:
    void step(Sample<D>* sample);
    void settle();
    void look_out();  // set `fault` if a particle runs away
    void forces(bool massless, Sample<D>* sample);
    void note_all(StepKey const& key);
    void put_in_order(std::uint64_t number);

    VelocityVerlet<D> scheme_;
    std::uint64_t seed_;
    bool owes_kick_ = false;
    std::size_t solvent_;
    std::string instruction_set_;  // of the pair loop; empty for the reference
    Kernels<D> kernels_;
    std::unique_ptr<PairForces<D>> pairs_;
    Team team_;
};

}  // namespace tether
