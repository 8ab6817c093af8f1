// What is measured at every step, and its mean over an interval of steps.
//
// Stress is positive in tension, S_xy the x-force through a plane normal to y (Phan-Thien et al. 2014, eq. 16):
//     kinetic       -(1/V) sum m V V                  V: velocity against the imposed profile
//     conservative  -(1/V) sum over pairs r_ij F_C    and likewise dissipative, random
//     body          -(1/V) sum (r_i - X) F_S,i        the tension in the bases, from the springs' pull on constituents
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "bodies/tethered.hpp"
#include "box.hpp"
#include "state.hpp"
#include "threads.hpp"

namespace tether {

// Sums over pairs of (force magnitude / distance) times the independent components of r_ij r_ij, a row for each of
// the law's terms.
template <int D>
struct PairVirial {
    static constexpr std::size_t components = D * (D + 1) / 2;
    std::array<std::array<double, components>, 3> term{};

    void add(Vector<D> const& separation, double conservative, double dissipative, double random) {
        std::size_t c = 0;
        for (std::size_t k = 0; k < D; ++k)
            for (std::size_t l = k; l < D; ++l, ++c) {
                double const product = separation[k] * separation[l];
                term[0][c] += conservative * product;
                term[1][c] += dissipative * product;
                term[2][c] += random * product;
            }
    }
    PairVirial& operator+=(PairVirial const& b) {
        for (std::size_t t = 0; t < 3; ++t)
            for (std::size_t c = 0; c < components; ++c) term[t][c] += b.term[t][c];
        return *this;
    }
    Tensor<D> tensor(std::size_t t) const {
        Tensor<D> full{};
        std::size_t c = 0;
        for (std::size_t k = 0; k < D; ++k)
            for (std::size_t l = k; l < D; ++l, ++c) full[k][l] = full[l][k] = term[t][c];
        return full;
    }
};

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

// The kinetic part of a sample: everything that velocities alone tell.
template <int D>
void sample_motion(Sample<D>& sample, State<D> const& state, Box<D> const& box,
                   std::vector<TetheredBodies<D>> const& bodies, std::size_t solvent, Team& team) {
    struct Sums {
        Tensor<D> flux{};
        Vector<D> momentum{};
        double solvent = 0.0, constituents = 0.0;
    };
    constexpr std::size_t block = 1024;
    std::vector<Sums> sums((state.size() + block - 1) / block);
    team.ranges(state.size(), block, [&](std::size_t begin, std::size_t end, std::size_t unit) {
        Sums sum;
        for (std::size_t i = begin; i < end; ++i) {
            double const mass = state.mass(i);
            Vector<D> velocity = state.velocity[i];
            velocity[0] -= box.flow_velocity(state.position[i][1]);
            (i < solvent ? sum.solvent : sum.constituents) += mass * dot(velocity, velocity);
            for (std::size_t k = 0; k < D; ++k) {
                sum.momentum[k] += mass * velocity[k];
                for (std::size_t l = 0; l < D; ++l) sum.flux[k][l] += mass * velocity[k] * velocity[l];
            }
        }
        sums[unit] = sum;
    });
    double const per_volume = -1.0 / box.volume();
    for (Sums const& sum : sums) {
        sample.thermal_solvent += sum.solvent;
        sample.thermal_constituents += sum.constituents;
        sample.momentum += sum.momentum;
        for (std::size_t k = 0; k < D; ++k)
            for (std::size_t l = 0; l < D; ++l) sample.kinetic[k][l] += per_volume * sum.flux[k][l];
    }
    for (TetheredBodies<D> const& kind : bodies)
        for (std::size_t b = 0; b < kind.count(); ++b) {
            BodyMotion<D> const motion = kind.motion_of(b, state, box);
            Vector<D> velocity = motion.velocity;
            velocity[0] -= box.flow_velocity(motion.center[1]);
            sample.thermal_translation += kind.body_mass() * dot(velocity, velocity);
            sample.spin_energy += dot(motion.angular_momentum, motion.spin);
            sample.spin += motion.spin;
            sample.angular_momentum += motion.angular_momentum;
            for (std::size_t k = 0; k < axial<D>; ++k)
                for (std::size_t l = 0; l < axial<D>; ++l) sample.inertia[k][l] += motion.inertia[k][l];
        }
}

}  // namespace tether
