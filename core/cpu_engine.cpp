#include "cpu_engine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kernels/motion.hpp"
#include "pairs/packed_pairs.hpp"
#include "pairs/reference_pairs.hpp"

namespace tether {

namespace {

// A particle that crosses half a cutoff in one step has left the reach of any time step in use (a thermal one goes a
// hundredth).
constexpr double runaway_displacement = 0.5;
constexpr double unlimited = std::numeric_limits<double>::infinity();

// Particles are put in memory as they stand in space at every step that this divides: often enough that those of a row
// stand together, seldom enough that moving them costs little.
constexpr std::uint64_t steps_in_order = 16;

// The quantum of force: a power of two, so small that rounding to it is at the level of the pair arithmetic's own
// rounding, so large that the forces of all partners fit in an integer.  No two particles below the runaway speed have
// a larger force than `most` between them; in a crowd that pushes one way, thousands push with the repulsion.
double force_quantum(LawNumbers const& law, double timestep, Precision precision) {
    double const fastest = 2.0 * runaway_displacement * law.largest_cutoff() / timestep;
    double const loudest = law.noise_kind == NoiseKind::uniform ? 1.7320508075688772 : 6.7;
    double pair = 0.0, repulsion = 0.0;
    for (PairNumbers const& of : law.table) {
        pair = std::max(pair, of.repulsion + of.friction * fastest + loudest * of.noise_amplitude);
        repulsion = std::max(repulsion, of.repulsion);
    }
    if (precision == Precision::full) {  // rounding to an integer works below 2^51, and there is room for thousands
        return pair > 0.0 ? std::exp2(std::ceil(std::log2(pair / std::ldexp(1.0, 50)))) : 1.0;
    }
    // 32 bits: a sign and room for 64 times the largest, so for 3200 partners that push one way.
    double const most = std::max(pair, 50.0 * repulsion), largest = std::ldexp(1.0, 31 - 6);
    return most > 0.0 ? std::exp2(std::ceil(std::log2(most / largest))) : 1.0;
}

template <int D>
std::unique_ptr<PairForces<D>> pair_forces(PairEngine const& engine, Kernels<D> const& kernels, Box<D> const& box,
                                           LawNumbers const& law, double timestep,
                                           std::vector<std::uint8_t> const& species) {
    if (engine.is_reference) return std::make_unique<ReferencePairs<D>>(box, law, species);
    double const quantum = force_quantum(law, timestep, engine.precision);
    if (engine.precision == Precision::mixed)
        return std::make_unique<PackedPairs<D, float>>(box, law, quantum, kernels, species);
    return std::make_unique<PackedPairs<D, double>>(box, law, quantum, kernels, species);
}

template <int D>
Tensor<D> scaled(Tensor<D> tensor, double factor) {
    for (auto& row : tensor)
        for (double& entry : row) entry *= factor;
    return tensor;
}

template <int D>
Tensor<D> difference(Tensor<D> a, Tensor<D> const& b) {
    for (std::size_t k = 0; k < D; ++k)
        for (std::size_t l = 0; l < D; ++l) a[k][l] -= b[k][l];
    return a;
}

}  // namespace

template <int D>
CpuEngine<D>::CpuEngine(Box<D> const& box_, LawNumbers const& law, Shear shear, Driving const& driving, double timestep,
                        double lambda, std::uint64_t seed, std::vector<double> species_mass,
                        std::vector<std::uint8_t> species, PairEngine const& pairs, int threads)
    : box(box_),
      state(std::move(species), std::move(species_mass)),
      law_(law),
      shear_(std::move(shear)),
      driving_(driving),
      scheme_{timestep, lambda, runaway_displacement * law.largest_cutoff() / timestep},
      seed_(seed),
      solvent_(static_cast<std::size_t>(std::count(state.species.begin(), state.species.end(), std::uint8_t{0}))),
      instruction_set_(pairs.is_reference ? "" : tether::instruction_set(pairs.instruction_set).name),
      kernels_(pairs.is_reference ? motion_table<D>() : kernels_of<D>(tether::instruction_set(pairs.instruction_set))),
      pairs_(pair_forces<D>(pairs, kernels_, box_, law, timestep, state.species)),
      team_(threads) {
    box.set_shear_rate(shear_.rate(1, timestep));
}

template <int D>
double CpuEngine<D>::force_quantum(Precision precision) const {
    return tether::force_quantum(law_, scheme_.timestep, precision);
}

template <int D>
void CpuEngine<D>::observe_stress(std::size_t bins, std::uint64_t interval) {
    seen_.clear();
    local_.reset();
    if (bins == 0) return;
    std::vector<std::int32_t> body_of_id(state.size(), -1);
    std::int32_t number = 0;
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) {
        if (!kind->is_rigid()) continue;
        for (std::size_t id = kind->first_id(0); id < kind->end_id(); ++id)
            body_of_id[id] = number + static_cast<std::int32_t>((id - kind->first_id(0)) / kind->sites_per_body());
        number += static_cast<std::int32_t>(kind->count());
    }
    local_ = std::make_unique<LocalStress<D>>(box, law_, state.species, std::move(body_of_id), scheme_.timestep, bins,
                                              interval);
}

template <int D>
void CpuEngine<D>::start_gently(std::uint64_t first, std::uint64_t steps, double displacement) {
    double const shear_rate = box.shear_rate();
    box.set_shear_rate(0.0);
    if (first == 0) {
        StepKey const key = step_key(seed_, 0, Stream::gentle_start);
        for (std::unique_ptr<Bodies<D>> const& kind : bodies) kind->place(state, box, team_);
        note_all(key);
        forces({key, 0.0, true, false, false}, nullptr);
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
        for (std::unique_ptr<Bodies<D>> const& kind : bodies)
            if (kind->is_rigid())
                kind->before_forces(scheme_.timestep, displacement / scheme_.timestep, state, box, team_);
        note_bodies(key);
        forces({key, 0.5 * scheme_.timestep, true, false, false}, nullptr);
        scheme_.after_forces(state, kernels_, team_);
        for (std::unique_ptr<Bodies<D>> const& kind : bodies)
            if (kind->is_rigid()) kind->after_forces(scheme_.timestep, team_);
        put_in_order(number);
    }
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) kind->settle(state, box, team_);
    box.set_shear_rate(shear_rate);
}

template <int D>
void CpuEngine<D>::place() {
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) kind->place(state, box, team_);
    StepKey const key = step_key(seed_, state.step, Stream::run);
    note_all(key);
    forces({key, 0.0, false, false, false}, nullptr);
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
    follow_shear();
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
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) kind->before_forces(timestep, unlimited, state, box, team_);
    note_bodies(key);
    watch.lap(Phase::bodies);
    bool const is_observed = this->is_observed();
    if (is_observed) local_->note(state.columns(), key, scheme_.prediction(), 0, state.size());
    watch.lap(Phase::measurement);
    forces({key, 0.5 * timestep, false, sample != nullptr || is_observed, is_observed}, sample);
    watch.lap(Phase::bodies);
    if (is_observed) local_->take_forces(state, box, bodies, solvent_, team_);
    watch.lap(Phase::measurement);
    owes_kick_ = true;
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) kind->after_forces(timestep, team_);
    watch.lap(Phase::bodies);
    if (sample || is_observed) {
        settle();
        watch.lap(Phase::motion);
    }
    if (sample) sample_motion(*sample, kernels_, state, box, bodies, solvent_, team_);
    if (is_observed) {
        std::vector<double> const sums = local_->take_motion(state, box);
        seen_.insert(seen_.end(), sums.begin(), sums.end());
    }
    watch.lap(Phase::measurement);
    put_in_order(state.step);
    watch.lap(Phase::order);
}

// When the shear rate changes, every velocity gets the change of the affine profile at once: it is what the flow would be
// after momentum had diffused across the box, which takes L^2/(pi^2 nu).
template <int D>
void CpuEngine<D>::follow_shear() {
    double const rate = shear_.rate(state.step, scheme_.timestep), change = rate - box.shear_rate();
    if (change == 0.0) return;
    settle();
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) kind->change_profile(change, state, box);
    double const middle = 0.5 * box.length()[1];
    double const* const y = state.position.axis[1].data();
    double* const v = state.velocity.axis[0].data();
    team_.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t p = begin; p < end; ++p) v[p] += change * (y[p] - middle);
    });
    box.set_shear_rate(rate);
}

// The second half of the last step's kick, which waits for the first half of the next step's: memory is passed over once.
template <int D>
void CpuEngine<D>::settle() {
    if (!std::exchange(owes_kick_, false)) return;
    scheme_.after_forces(state, kernels_, team_);
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) kind->settle(state, box, team_);
}

template <int D>
void CpuEngine<D>::note_all(StepKey const& key) {
    Columns<D> const particles = state.columns();
    team_.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        pairs_->note(particles, box, key, 0.0, begin, end);
    });
}

// Once rigid bodies have put their constituents where they belong.
template <int D>
void CpuEngine<D>::note_bodies(StepKey const& key) {
    Columns<D> const particles = state.columns();
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) {
        if (!kind->is_rigid()) continue;
        std::size_t const first = kind->first_id(0), count = kind->end_id() - first;
        team_.ranges(count, particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t k = begin; k < end; ++k) {
                std::size_t const place = state.place[first + k];
                pairs_->note(particles, box, key, scheme_.prediction(), place, place + 1);
            }
        });
    }
}

// The order is part of the state, and changes at steps of given numbers: results do not depend on how often a run was
// stopped on its way.
template <int D>
void CpuEngine<D>::put_in_order(std::uint64_t number) {
    if (number % steps_in_order == 0 && !pairs_->order().empty()) state.reorder(pairs_->order(), team_);
}

template <int D>
void CpuEngine<D>::forces(Holding const& holding, Sample<D>* sample) {
    PairVirial<D> const virial = pairs_->compute(sample != nullptr, state, box, team_, watch);
    if (!holding.gently) driving_.add_to(state, box.length()[1], team_);
    Held<D> held;
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) held += kind->hold(holding, state, box, team_);
    if (!sample) return;
    double const per_volume = -1.0 / box.volume();
    sample->conservative = scaled<D>(difference<D>(virial.tensor(0), held.inner_conservative), per_volume);
    sample->dissipative = scaled<D>(virial.tensor(1), per_volume);
    sample->random = scaled<D>(difference<D>(virial.tensor(2), held.inner_random), per_volume);
    sample->body = scaled<D>(held.moment, per_volume);
}

template class CpuEngine<2>;
template class CpuEngine<3>;

}  // namespace tether
