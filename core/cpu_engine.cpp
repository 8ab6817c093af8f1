#include "cpu_engine.hpp"

#include <algorithm>
#include <limits>

namespace tether {

namespace {

std::variant<Dpd<HalfPower>, Dpd<SquarePower>, Dpd<AnyPower>> law_of(double exponent) {
    if (exponent == 0.5) return Dpd<HalfPower>{};
    if (exponent == 2.0) return Dpd<SquarePower>{};
    return Dpd<AnyPower>{{0.5 * exponent}};
}

template <int D>
Tensor<D> scaled(Tensor<D> tensor, double factor) {
    for (auto& row : tensor)
        for (double& entry : row) entry *= factor;
    return tensor;
}

// A particle that crosses half a cutoff in one step has left the reach of any time step in use (a thermal one goes a
// hundredth).
constexpr double runaway_displacement = 0.5;

}  // namespace

template <int D>
CpuEngine<D>::CpuEngine(Box<D> const& box_, FluidParameters const& fluid, double timestep, double lambda,
                        std::uint64_t seed, std::vector<double> species_mass, std::vector<std::uint8_t> species,
                        int threads)
    : box(box_),
      law_(law_of(fluid.exponent)),
      parameters_{fluid.repulsion, fluid.friction, fluid.noise / std::sqrt(timestep), 1.0 / fluid.cutoff},
      noise_kind_(fluid.noise_kind),
      timestep_(timestep),
      lambda_(lambda),
      runaway_speed_(runaway_displacement * fluid.cutoff / timestep),
      seed_(seed),
      solvent_(static_cast<std::size_t>(std::count(species.begin(), species.end(), std::uint8_t{0}))),
      pairs_(box_, fluid.cutoff, species.size()),
      team_(threads) {
    state.position.resize(species.size());
    state.velocity.resize(species.size());
    state.force.resize(species.size());
    state.species = std::move(species);
    state.species_mass = std::move(species_mass);
}

template <int D>
void CpuEngine<D>::start_gently(std::uint64_t first, std::uint64_t steps, double displacement) {
    double const shear_rate = box.shear_rate();
    box.set_shear_rate(0.0);
    if (first == 0) {
        predict(predicted_, state, timestep_, 0.5, team_);
        forces(Stream::gentle_start, 0, true, nullptr);
    }
    for (std::uint64_t number = first + 1; number <= first + steps; ++number) {
        kick(state, 0.5 * timestep_, team_);
        limit(state, displacement / timestep_, team_);
        drift(state, timestep_, team_);
        wrap(state, box, team_);
        predict(predicted_, state, timestep_, 0.5, team_);
        forces(Stream::gentle_start, number, true, nullptr);
        kick(state, 0.5 * timestep_, team_);
    }
    box.set_shear_rate(shear_rate);
}

template <int D>
void CpuEngine<D>::place() {
    for (TetheredBodies<D>& kind : bodies) kind.place(state, box);
    predict(predicted_, state, timestep_, 0.5, team_);  // with lambda = 1/2: the velocities themselves
    forces(Stream::run, state.step, false, nullptr);
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
    if (!fault) watch();  // nothing of a state that is already lost is handed out
    return means;
}

template <int D>
void CpuEngine<D>::watch() {
    std::size_t const runaway = find_runaway(state, box, runaway_speed_, team_);
    if (runaway < state.size())
        fault = Fault{state.step, runaway, std::sqrt(dot(state.velocity[runaway], state.velocity[runaway]))};
}

template <int D>
void CpuEngine<D>::step(Sample<D>* sample) {
    ++state.step;
    kick(state, 0.5 * timestep_, team_);
    watch();
    if (fault) return;
    drift(state, timestep_, team_);
    for (TetheredBodies<D>& kind : bodies) {
        kind.kick(0.5 * timestep_, team_);
        kind.drift(timestep_, team_);
        if (kind.lagged()) kind.kick(0.5 * timestep_, team_);
    }
    box.advance(timestep_);
    wrap(state, box, team_);
    for (TetheredBodies<D>& kind : bodies) kind.wrap(box);
    predict(predicted_, state, timestep_, lambda_, team_);
    forces(Stream::run, state.step, false, sample);
    kick(state, 0.5 * timestep_, team_);
    for (TetheredBodies<D>& kind : bodies)
        if (!kind.lagged()) kind.kick(0.5 * timestep_, team_);
    if (sample) sample_motion(*sample, state, box, bodies, solvent_, team_);
}

template <int D>
void CpuEngine<D>::forces(Stream stream, std::uint64_t number, bool massless, Sample<D>* sample) {
    StepKey const key = step_key(seed_, number, stream);
    auto const compute = [&]<class Noise>(auto const& law, Noise) {
        return sample ? pairs_.template compute<true, Noise>(law, parameters_, key, state, predicted_, box, team_)
                      : pairs_.template compute<false, Noise>(law, parameters_, key, state, predicted_, box, team_);
    };
    PairVirial<D> const virial = std::visit(
        [&](auto const& law) {
            return noise_kind_ == NoiseKind::uniform ? compute(law, UniformNoise{}) : compute(law, GaussianNoise{});
        },
        law_);
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
