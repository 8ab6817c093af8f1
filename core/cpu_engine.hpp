// The CPU engine in double precision: a suspension and its step.
#pragma once

#include <optional>
#include <variant>

#include "bodies/tethered.hpp"
#include "observe/sample.hpp"
#include "pairs/pair_forces.hpp"
#include "schemes/velocity_verlet.hpp"

namespace tether {

enum class NoiseKind { uniform, gaussian };

struct FluidParameters {
    double repulsion, friction, noise;  // a (force), gamma (force time/length), sigma (force sqrt time)
    double cutoff, exponent;            // r_c (length), s
    NoiseKind noise_kind;
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
              std::vector<double> species_mass, std::vector<std::uint8_t> species, int threads);

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
    int threads() { return team_.size(); }

  private:
    using AnyLaw = std::variant<Dpd<HalfPower>, Dpd<SquarePower>, Dpd<AnyPower>>;

    void step(Sample<D>* sample);
    void watch();  // set `fault` if a particle runs away
    void forces(Stream stream, std::uint64_t number, bool massless, Sample<D>* sample);

    AnyLaw law_;
    DpdParameters<double> parameters_;
    NoiseKind noise_kind_;
    double timestep_, lambda_, runaway_speed_;
    std::uint64_t seed_;
    std::size_t solvent_;
    PairForces<D> pairs_;
    std::vector<Vector<D>> predicted_;
    Team team_;
};

}  // namespace tether
