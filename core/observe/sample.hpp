// What is measured at every step, and its mean over an interval of steps.
//
// Stress is positive in tension, S_xy the x-force through a plane normal to y (Phan-Thien et al. 2014, eq. 16):
//     kinetic       -(1/V) sum m V V                  V: velocity against the imposed profile
//     conservative  -(1/V) sum over pairs r_ij F_C    and likewise dissipative, random
//     body          -(1/V) sum (r_i - X) F_S,i        the tension in the bases, from what holds the constituents: springs,
//                                                     or the constraint of a rigid body
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bodies/bodies.hpp"
#include "box.hpp"
#include "kernels/kernels.hpp"
#include "observe/virial.hpp"
#include "state.hpp"
#include "threads.hpp"

namespace tether {

template <int D>
struct Sample {
    Tensor<D> kinetic{}, conservative{}, dissipative{}, random{}, body{};  // stress
    double thermal_solvent = 0.0, thermal_constituents = 0.0;              // sum m V^2 over each
    double thermal_translation = 0.0;                                      // the same over whole bodies
    double spin_energy = 0.0;                                              // sum over bodies L . omega
    Axial<D> spin{}, angular_momentum{};                                   // sums over bodies of omega and L
    Inertia<D> inertia{};                                                  // and of the inertia
    Vector<D> momentum{};                                                  // sum m V

    static constexpr std::size_t values = 5 * D * D + 4 + 2 * axial<D> + axial<D> * axial<D> + D;

    // Name and number of values of each quantity, in the order of write().
    static std::vector<std::pair<std::string, std::size_t>> columns() {
        return {{"stress_kinetic", D * D},
                {"stress_conservative", D * D},
                {"stress_dissipative", D * D},
                {"stress_random", D * D},
                {"stress_body", D * D},
                {"thermal_solvent", 1},
                {"thermal_constituents", 1},
                {"thermal_translation", 1},
                {"spin_energy", 1},
                {"spin", axial<D>},
                {"angular_momentum", axial<D>},
                {"inertia", axial<D> * axial<D>},
                {"momentum", D}};
    }
    void add_to(double* out, double share) const {
        for (Tensor<D> const* tensor : {&kinetic, &conservative, &dissipative, &random, &body})
            for (auto const& row : *tensor)
                for (double entry : row) *out++ += share * entry;
        for (double value : {thermal_solvent, thermal_constituents, thermal_translation, spin_energy})
            *out++ += share * value;
        for (double value : spin) *out++ += share * value;
        for (double value : angular_momentum) *out++ += share * value;
        for (auto const& row : inertia)
            for (double entry : row) *out++ += share * entry;
        for (double value : momentum) *out++ += share * value;
    }
};

// How the bodies of one kind move, added to a sample.
template <int D>
void sample_bodies(Sample<D>& sample, Bodies<D> const& kind, State<D> const& state, Box<D> const& box, Team& team) {
    constexpr std::size_t block = 32;
    std::vector<Sample<D>> parts((kind.count() + block - 1) / block);
    team.ranges(kind.count(), block, [&](std::size_t begin, std::size_t end, std::size_t unit) {
        Sample<D> part;
        for (std::size_t b = begin; b < end; ++b) {
            BodyMotion<D> const motion = kind.motion_of(b, state, box);
            Vector<D> velocity = motion.velocity;
            velocity[0] -= box.flow_velocity(motion.center[1]);
            part.thermal_translation += kind.body_mass() * dot(velocity, velocity);
            part.spin_energy += dot(motion.angular_momentum, motion.spin);
            part.spin += motion.spin;
            part.angular_momentum += motion.angular_momentum;
            for (std::size_t k = 0; k < axial<D>; ++k)
                for (std::size_t l = 0; l < axial<D>; ++l) part.inertia[k][l] += motion.inertia[k][l];
        }
        parts[unit] = part;
    });
    for (Sample<D> const& part : parts) {
        sample.thermal_translation += part.thermal_translation;
        sample.spin_energy += part.spin_energy;
        sample.spin += part.spin;
        sample.angular_momentum += part.angular_momentum;
        for (std::size_t k = 0; k < axial<D>; ++k)
            for (std::size_t l = 0; l < axial<D>; ++l) sample.inertia[k][l] += part.inertia[k][l];
    }
}

// The kinetic part of a sample: everything that velocities alone tell.
template <int D>
void sample_motion(Sample<D>& sample, Kernels<D> const& kernels, State<D>& state, Box<D> const& box,
                   std::vector<std::unique_ptr<Bodies<D>>> const& bodies, std::size_t solvent, Team& team) {
    constexpr std::size_t block = 1024;
    std::vector<MotionSums<D>> sums((state.size() + block - 1) / block);
    team.ranges(state.size(), block, [&](std::size_t begin, std::size_t end, std::size_t unit) {
        kernels.motion(state.columns(), box.numbers(), static_cast<std::uint32_t>(solvent), sums[unit], begin, end);
    });
    double const per_volume = -1.0 / box.volume();
    for (MotionSums<D> const& sum : sums) {
        sample.thermal_solvent += sum.solvent;
        sample.thermal_constituents += sum.constituents;
        for (std::size_t k = 0; k < D; ++k) {
            sample.momentum[k] += sum.momentum[k];
            for (std::size_t l = 0; l < D; ++l) sample.kinetic[k][l] += per_volume * sum.flux[k][l];
        }
    }
    for (std::unique_ptr<Bodies<D>> const& kind : bodies) sample_bodies(sample, *kind, state, box, team);
}

}  // namespace tether
