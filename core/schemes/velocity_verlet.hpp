// Modified velocity Verlet for DPD (Groot & Warren 1997, doi 10.1063/1.474784):
//     v(t + dt/2) = v + dt/2 F/m
//     r(t + dt)   = r + dt v(t + dt/2)
//     F(t + dt)   = F(r(t + dt), v + lambda dt F/m)        the predicted velocity
//     v(t + dt)   = v(t + dt/2) + dt/2 F(t + dt)/m
// lambda = 1/2 predicts v(t + dt/2).  Without friction and noise this is velocity Verlet, of second order.
//
// All that happens to a particle between two evaluations of the forces is done to a block of particles before the next
// block is fetched: memory is slower than arithmetic.
#pragma once

#include <atomic>

#include "box.hpp"
#include "kernels/kernels.hpp"
#include "pairs/pair_forces.hpp"
#include "state.hpp"
#include "threads.hpp"

namespace tether {

constexpr std::size_t particle_block = 512;  // particles of one unit of work

template <int D>
struct VelocityVerlet {
    double timestep, lambda;
    double runaway_speed;

    double prediction() const { return (lambda - 0.5) * timestep; }  // from the velocity at half a step

    // Up to the forces of the step: `box` has advanced, `box_before` has not.  With `owes_kick` the step before ends here
    // too.  False when a particle runs away; it and its block then stay where they are.
    bool before_forces(bool owes_kick, State<D>& state, Box<D> const& box_before, Box<D> const& box, StepKey const& key,
                       Kernels<D> const& kernels, PairForces<D>& pairs, Team& team) const {
        Columns<D> const particles = state.columns();
        BoxNumbers<D> const before = box_before.numbers(), now = box.numbers();
        std::atomic<bool> is_well{true};
        team.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
            if (owes_kick) kernels.kick(particles, 0.5 * timestep, begin, end);
            kernels.kick(particles, 0.5 * timestep, begin, end);
            if (kernels.runaway(particles, before, runaway_speed, begin, end)) {
                is_well = false;
                return;
            }
            kernels.drift(particles, timestep, begin, end);
            kernels.wrap(particles, now, begin, end);
            pairs.note(particles, box, key, prediction(), begin, end);
        });
        return is_well;
    }

    void after_forces(State<D>& state, Kernels<D> const& kernels, Team& team) const {
        Columns<D> const particles = state.columns();
        team.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
            kernels.kick(particles, 0.5 * timestep, begin, end);
        });
    }
};

// Shorten velocities to at most `speed`; for a box at rest.
template <int D>
void limit(State<D>& state, double speed, std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
        Vector<D> const velocity = state.velocity[p];
        double const square = dot(velocity, velocity);
        if (square > speed * speed) state.velocity.set(p, (speed / std::sqrt(square)) * velocity);
    }
}

// The lowest id of a particle that is not finite or moves (against the imposed flow) faster than `speed`; the number
// of particles if none.
template <int D>
std::size_t find_runaway(State<D> const& state, Box<D> const& box, double speed) {
    for (std::size_t id = 0; id < state.size(); ++id) {
        std::size_t const p = state.place[id];
        Vector<D> velocity = state.velocity[p];
        velocity[0] -= box.flow_velocity(state.position[p][1]);
        if (!(dot(velocity, velocity) <= speed * speed)) return id;  // true for what is not a number, too
    }
    return state.size();
}

}  // namespace tether
