#include "cpu_engine.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/motion.hpp"
#include "pairs/packed_pairs.hpp"
#include "pairs/reference_pairs.hpp"

namespace tether {

namespace {

// A particle that crosses half a cutoff in one step has left the reach of any time step in use (a thermal one goes a
// hundredth).
constexpr double runaway_displacement = 0.5;

// Particles are put in memory as they stand in space at every step that this divides: often enough that those of a row
// stand together, seldom enough that moving them costs little.
constexpr std::uint64_t steps_in_order = 16;

LawKind law_kind(double exponent) {
    if (exponent == 0.5) return LawKind::half_power;
    if (exponent == 2.0) return LawKind::square_power;
    return LawKind::any_power;
}

// The quantum of force: a power of two, so small that rounding to it is at the level of the pair arithmetic's own
// rounding, so large that the forces of all partners fit in an integer.  No two particles below the runaway speed have
// a larger force than `most` between them; in a crowd that pushes one way, thousands push with the repulsion.
double force_quantum(FluidParameters const& fluid, double timestep, Precision precision) {
    double const fastest = 2.0 * runaway_displacement * fluid.cutoff / timestep;
    double const loudest = fluid.noise_kind == NoiseKind::uniform ? 1.7320508075688772 : 6.7;
    double const pair = fluid.repulsion + fluid.friction * fastest + loudest * fluid.noise / std::sqrt(timestep);
    if (precision == Precision::full) {  // rounding to an integer works below 2^51, and there is room for thousands
        return pair > 0.0 ? std::exp2(std::ceil(std::log2(pair / std::ldexp(1.0, 50)))) : 1.0;
    }
    // 32 bits: a sign and room for 64 times the largest, so for 3200 partners that push one way.
    double const most = std::max(pair, 50.0 * fluid.repulsion), largest = std::ldexp(1.0, 31 - 6);
    return most > 0.0 ? std::exp2(std::ceil(std::log2(most / largest))) : 1.0;
}

template <int D>
std::unique_ptr<PairForces<D>> pair_forces(PairEngine const& engine, Kernels<D> const& kernels, Box<D> const& box,
                                           FluidParameters const& fluid, double timestep, std::size_t particles) {
    LawNumbers const law{fluid.repulsion, fluid.friction,       fluid.noise / std::sqrt(timestep),
                         fluid.cutoff,    0.5 * fluid.exponent, fluid.noise_kind};
    LawKind const kind = law_kind(fluid.exponent);
    if (engine.is_reference) return std::make_unique<ReferencePairs<D>>(box, law, kind, particles);
    double const quantum = force_quantum(fluid, timestep, engine.precision);
    if (engine.precision == Precision::mixed)
        return std::make_unique<PackedPairs<D, float>>(box, law, kind, quantum, kernels, particles);
    return std::make_unique<PackedPairs<D, double>>(box, law, kind, quantum, kernels, particles);
}

template <int D>
Tensor<D> scaled(Tensor<D> tensor, double factor) {
    for (auto& row : tensor)
        for (double& entry : row) entry *= factor;
    return tensor;
}

}  // namespace

template <int D>
CpuEngine<D>::CpuEngine(Box<D> const& box_, FluidParameters const& fluid, double timestep, double lambda,
                        std::uint64_t seed, std::vector<double> species_mass, std::vector<std::uint8_t> species,
                        PairEngine const& pairs, int threads)
    : box(box_),
      state(std::move(species), std::move(species_mass)),
      scheme_{timestep, lambda, runaway_displacement * fluid.cutoff / timestep},
      seed_(seed),
      solvent_(static_cast<std::size_t>(std::count(state.species.begin(), state.species.end(), std::uint8_t{0}))),
      instruction_set_(pairs.is_reference ? "" : tether::instruction_set(pairs.instruction_set).name),
      kernels_(pairs.is_reference ? Kernels<D>{kick<D>, drift<D>, wrap<D>, runaway<D>, motion<D>, {}, {}}
                                  : kernels_of<D>(tether::instruction_set(pairs.instruction_set))),
      pairs_(pair_forces<D>(pairs, kernels_, box_, fluid, timestep, state.size())),
      team_(threads) {}

template <int D>
void CpuEngine<D>::start_gently(std::uint64_t first, std::uint64_t steps, double displacement) {
    double const shear_rate = box.shear_rate();
    box.set_shear_rate(0.0);
    if (first == 0) {
        note_all(step_key(seed_, 0, Stream::gentle_start));
        forces(true, nullptr);
        put_in_order(0);
    }
    for (std::uint64_t number = first + 1; number <= first + steps; ++number) {
        Columns<D> const particles = state.columns();
        StepKey const key = step_key(seed_, number, Stream::gentle_start);
        team_.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
            kernels_.kick(particles, 0.5 * scheme_.timestep, begin, end);
            limit(state, displacement / scheme_.timestep, begin, end);
            kernels_.drift(particles, scheme_.timestep, begin, end);
            kernels_.wrap(particles, box.numbers(), begin, end);
            pairs_->note(particles, box, key, 0.0, begin, end);
        });
        forces(true, nullptr);
        scheme_.after_forces(state, kernels_, team_);
        put_in_order(number);
    }
    box.set_shear_rate(shear_rate);
}

template <int D>
void CpuEngine<D>::place() {
    for (TetheredBodies<D>& kind : bodies) kind.place(state, box);
    note_all(step_key(seed_, state.step, Stream::run));
    forces(false, nullptr);
}

template <int D>
std::vector<double> CpuEngine<D>::run(std::uint64_t steps, std::uint64_t interval) {
    std::vector<double> means;
    if (interval > 0) means.assign(steps / interval * Sample<D>::values, 0.0);
    for (std::uint64_t number = 0; number < steps && !fault; ++number) {
        if (interval == 0) {
            step(nullptr);
            continue;
        }
        Sample<D> sample;
        step(&sample);
        if (!fault) sample.add_to(&means[number / interval * Sample<D>::values], 1.0 / static_cast<double>(interval));
    }
    settle();
    if (!fault) look_out();  // nothing of a state that is already lost is handed out
    return means;
}

template <int D>
void CpuEngine<D>::look_out() {
    std::size_t const runaway = find_runaway(state, box, scheme_.runaway_speed);
    if (runaway == state.size()) return;
    Vector<D> const velocity = state.velocity[state.place[runaway]];
    fault = Fault{state.step, runaway, std::sqrt(dot(velocity, velocity))};
}

template <int D>
void CpuEngine<D>::step(Sample<D>* sample) {
    watch.start();
    ++state.step;
    double const timestep = scheme_.timestep;
    Box<D> const box_before = box;
    box.advance(timestep);
    StepKey const key = step_key(seed_, state.step, Stream::run);
    bool const owes_kick = std::exchange(owes_kick_, false);
    if (!scheme_.before_forces(owes_kick, state, box_before, box, key, kernels_, *pairs_, team_)) {
        look_out();
        return;
    }
    watch.lap(Phase::motion);
    for (TetheredBodies<D>& kind : bodies) {
        kind.kick(0.5 * timestep, team_);
        kind.drift(timestep, team_);
        if (kind.lagged()) kind.kick(0.5 * timestep, team_);
        kind.wrap(box);
    }
    watch.lap(Phase::bodies);
    forces(false, sample);
    owes_kick_ = true;
    for (TetheredBodies<D>& kind : bodies)
        if (!kind.lagged()) kind.kick(0.5 * timestep, team_);
    watch.lap(Phase::bodies);
    if (sample) {
        settle();
        watch.lap(Phase::motion);
        sample_motion(*sample, kernels_, state, box, bodies, solvent_, team_);
        watch.lap(Phase::measurement);
    }
    put_in_order(state.step);
    watch.lap(Phase::order);
}

// The second half of the last step's kick, which waits for the first half of the next step's: memory is passed over once.
template <int D>
void CpuEngine<D>::settle() {
    if (std::exchange(owes_kick_, false)) scheme_.after_forces(state, kernels_, team_);
}

template <int D>
void CpuEngine<D>::note_all(StepKey const& key) {
    Columns<D> const particles = state.columns();
    team_.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        pairs_->note(particles, box, key, 0.0, begin, end);
    });
}

// The order is part of the state, and changes at steps of given numbers: results do not depend on how often a run was
// stopped on its way.
template <int D>
void CpuEngine<D>::put_in_order(std::uint64_t number) {
    if (number % steps_in_order == 0 && !pairs_->order().empty()) state.reorder(pairs_->order(), team_);
}

template <int D>
void CpuEngine<D>::forces(bool massless, Sample<D>* sample) {
    PairVirial<D> const virial = pairs_->compute(sample != nullptr, state, box, team_, watch);
    Tensor<D> moment{};
    for (TetheredBodies<D>& kind : bodies) {
        Tensor<D> const part = kind.tether(state, box, team_, massless);
        for (std::size_t k = 0; k < D; ++k)
            for (std::size_t l = 0; l < D; ++l) moment[k][l] += part[k][l];
    }
    if (!sample) return;
    double const per_volume = -1.0 / box.volume();
    sample->conservative = scaled<D>(virial.tensor(0), per_volume);
    sample->dissipative = scaled<D>(virial.tensor(1), per_volume);
    sample->random = scaled<D>(virial.tensor(2), per_volume);
    sample->body = scaled<D>(moment, per_volume);
}

template class CpuEngine<2>;
template class CpuEngine<3>;

}  // namespace tether
