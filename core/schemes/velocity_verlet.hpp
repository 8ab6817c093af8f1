// Modified velocity Verlet for DPD (Groot & Warren 1997, doi 10.1063/1.474784):
//     v(t + dt/2) = v + dt/2 F/m
//     r(t + dt)   = r + dt v(t + dt/2)
//     F(t + dt)   = F(r(t + dt), v + lambda dt F/m)        the predicted velocity
//     v(t + dt)   = v(t + dt/2) + dt/2 F(t + dt)/m
// lambda = 1/2 predicts v(t + dt/2).  Without friction and noise this is velocity Verlet, of second order.
#pragma once

#include <atomic>
#include <vector>

#include "box.hpp"
#include "state.hpp"
#include "threads.hpp"

namespace tether {

constexpr std::size_t particle_block = 1024;  // particles of one unit of work

template <int D>
void kick(State<D>& state, double time, Team& team) {
    team.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) state.velocity[i] += (time / state.mass(i)) * state.force[i];
    });
}

template <int D>
void drift(State<D>& state, double time, Team& team) {
    team.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) state.position[i] += time * state.velocity[i];
    });
}

template <int D>
void wrap(State<D>& state, Box<D> const& box, Team& team) {
    team.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) box.wrap(state.position[i], state.velocity[i]);
    });
}

// Velocities v(t) + lambda dt F/m, from state.velocity = v(t + dt/2) and the forces of time t.
template <int D>
void predict(std::vector<Vector<D>>& predicted, State<D> const& state, double timestep, double lambda, Team& team) {
    predicted.resize(state.size());
    team.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i)
            predicted[i] = state.velocity[i] + ((lambda - 0.5) * timestep / state.mass(i)) * state.force[i];
    });
}

// Shorten velocities to at most `speed`; for a box at rest.
template <int D>
void limit(State<D>& state, double speed, Team& team) {
    team.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            double const square = dot(state.velocity[i], state.velocity[i]);
            if (square > speed * speed) state.velocity[i] *= speed / std::sqrt(square);
        }
    });
}

// The lowest id of a particle that is not finite or moves (against the imposed flow) faster than `speed`; the number
// of particles if none.
template <int D>
std::size_t find_runaway(State<D> const& state, Box<D> const& box, double speed, Team& team) {
    std::atomic<std::size_t> lowest{state.size()};
    team.ranges(state.size(), particle_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            Vector<D> velocity = state.velocity[i];
            velocity[0] -= box.flow_velocity(state.position[i][1]);
            if (dot(velocity, velocity) <= speed * speed) continue;  // false for what is not a number, too
            std::size_t seen = lowest.load();
            while (i < seen && !lowest.compare_exchange_weak(seen, i)) {}
            break;
        }
    });
    return lowest.load();
}

}  // namespace tether
