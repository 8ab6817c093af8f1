// Rigid bodies: the constituents have no motion of their own (the paper's frozen particles; Koelman & Hoogerbrugge 1993,
// doi 10.1209/0295-5075/21/3/018).
//
// A body moves by the sum of the forces F_i on its constituents and by their torque about its center X (Newton, Euler):
//     M dV/dt = sum F_i,   dL/dt = sum (r_i - X) x F_i,   omega = I^-1 L,   v_i = V + omega x (r_i - X)
// by velocity Verlet: kick, free flight, forces, kick.  Constituents do not act on each other: the pair loop knows no
// body, but what it finds between two of one body cancels in force and torque, and is taken out of the stress here.
//
// What holds constituent i is the constraint force G_i = m a_i - F_i, with a_i the acceleration of its place,
//     a_i = dV/dt + domega/dt x (r_i - X) + omega x (omega x (r_i - X)),
// and it adds -(1/V) sum (r_i - X) G_i to the stress.  The noise that the forces have is in it, with mean zero.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "bodies/bodies.hpp"
#include "laws/species_law.hpp"

namespace tether {

template <int D>
class RigidBodies final : public Bodies<D> {
    using Bodies<D>::bases, Bodies<D>::sites_, Bodies<D>::mass_;

  public:
    // Sites: as Bodies takes them.  `law` and `species` tell the forces that constituents would have on each other.
    RigidBodies(std::vector<Vector<D>> sites, std::size_t count, std::size_t first, double constituent_mass,
                LawNumbers const& law, std::size_t species)
        : Bodies<D>(std::move(sites), count, first, constituent_mass),
          law_(species_law(law)),
          noise_kind_(law.noise_kind),
          species_(species) {
        for (Vector<D> const& s : sites_) radius_ = std::max(radius_, std::sqrt(dot(s, s)));
    }

    bool has_inertia() const override { return true; }
    bool is_rigid() const override { return true; }

    void before_forces(double timestep, double most_speed, State<D>& state, Box<D> const& box, Team& team) override {
        this->kick(0.5 * timestep, team);
        if (std::isfinite(most_speed))
            for (Base<D>& base : bases) limit(base, most_speed);
        this->drift(timestep, team);
        this->wrap(box);
        put(state, box, team);
        predict(state, team);
    }

    Held<D> hold(Holding const& step, State<D>& state, Box<D> const&, Team& team) override {
        this->pulls.resize(step.keeps_pulls ? this->count() * sites_.size() : 0);
        return this->each_held(team, [&](std::size_t body, Held<D>& held) { hold_one(body, state, step, held); });
    }

    void after_forces(double timestep, Team& team) override { this->kick(0.5 * timestep, team); }

    void settle(State<D>& state, Box<D> const& box, Team& team) override { put(state, box, team); }

  private:
    // Place every constituent on its site, and let it move with it.
    void put(State<D>& state, Box<D> const& box, Team& team) {
        team.ranges(this->count(), Bodies<D>::block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t b = begin; b < end; ++b) {
                Axial<D> const spin = this->spin_of(bases[b], bases[b].angular_momentum);
                for (std::size_t i = 0; i < sites_.size(); ++i) {
                    Vector<D> const arm = bases[b].rotation.turn(sites_[i]);
                    Vector<D> position = bases[b].center + arm, velocity = bases[b].velocity + cross_axial(spin, arm);
                    box.wrap(position, velocity);
                    std::size_t const place = state.place[this->first_id(b) + i];
                    state.position.set(place, position);
                    state.velocity.set(place, velocity);
                }
            }
        });
    }

    // The forces that a pair loop predicts velocities with, of the step before, such that predicted bodies move rigidly
    // too: without what bends the paths of constituents.
    void predict(State<D>& state, Team& team) {
        team.ranges(this->count(), Bodies<D>::block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t b = begin; b < end; ++b) {
                Base<D> const& base = bases[b];
                Axial<D> const turning = this->spin_of(base, base.torque);
                for (std::size_t i = 0; i < sites_.size(); ++i) {
                    Vector<D> const acceleration =
                        (1.0 / this->body_mass()) * base.force + cross_axial(turning, base.rotation.turn(sites_[i]));
                    state.force.set(state.place[this->first_id(b) + i], mass_ * acceleration);
                }
            }
        });
    }

    void hold_one(std::size_t body, State<D>& state, Holding const& step, Held<D>& held) {
        thread_local std::vector<Vector<D>> arm, inner;
        arm.resize(sites_.size());
        inner.assign(sites_.size(), {});
        Base<D>& base = bases[body];
        std::size_t const id = this->first_id(body);
        base.force = {};
        base.torque = {};
        for (std::size_t i = 0; i < sites_.size(); ++i) {
            Vector<D> const force = state.force[state.place[id + i]];
            arm[i] = base.rotation.turn(sites_[i]);
            base.force += force;
            base.torque += cross(arm[i], force);
        }
        if (step.is_measured) add_inner(id, step.key, arm, inner, held);
        Axial<D> const momentum = base.angular_momentum + step.pending * base.torque;
        Axial<D> const spin = this->spin_of(base, momentum);
        Axial<D> const turning = this->spin_of(base, base.torque - gyroscopic(spin, momentum));  // domega/dt
        for (std::size_t i = 0; i < sites_.size(); ++i) {
            std::size_t const place = state.place[id + i];
            Vector<D> const acceleration = (1.0 / this->body_mass()) * base.force + cross_axial(turning, arm[i]) +
                                           cross_axial(spin, cross_axial(spin, arm[i]));
            Vector<D> const pull = mass_ * acceleration - state.force[place];
            state.force.set(place, mass_ * acceleration);
            add_moment<D>(held.moment, arm[i], pull + inner[i]);
            if (step.keeps_pulls) this->pulls[body * sites_.size() + i] = {arm[i], pull + inner[i]};
        }
    }

    // What the pair loop found between constituents of the body that begins with `id`.
    void add_inner(std::size_t id, StepKey const& key, std::vector<Vector<D>> const& arm, std::vector<Vector<D>>& inner,
                   Held<D>& held) const {
        std::visit(
            [&](auto const& law) {
                for (std::size_t i = 0; i < arm.size(); ++i)
                    for (std::size_t j = i + 1; j < arm.size(); ++j) {
                        Vector<D> const separation = arm[i] - arm[j];
                        double const distance = std::sqrt(dot(separation, separation));
                        if (!(distance < law.cutoff(species_, species_)) || distance == 0.0) continue;
                        auto const bits = pair_bits(particle_word(key, static_cast<std::uint32_t>(id + i)) +
                                                    particle_word(key, static_cast<std::uint32_t>(id + j)));
                        double const noise = noise_kind_ == NoiseKind::uniform ? UniformNoise::draw<double>(bits)
                                                                               : GaussianNoise::draw<double>(bits);
                        PairForce<double> const force = law(Pair<double>{distance, 0.0, noise}, species_, species_);
                        Vector<D> const direction = (1.0 / distance) * separation;
                        add_moment<D>(held.inner_conservative, separation, force.conservative * direction);
                        add_moment<D>(held.inner_random, separation, force.random * direction);
                        inner[i] += force.total() * direction;
                        inner[j] -= force.total() * direction;
                    }
            },
            law_);
    }

    // No constituent faster than `speed`.
    void limit(Base<D>& base, double speed) const {
        Axial<D> const spin = this->spin_of(base, base.angular_momentum);
        double square = 0.0;
        for (double turn : spin) square += turn * turn;
        double const fastest = std::sqrt(dot(base.velocity, base.velocity)) + radius_ * std::sqrt(square);
        if (!(fastest > speed)) return;
        base.velocity *= speed / fastest;
        base.angular_momentum *= speed / fastest;
    }

    static Vector<2> cross_axial(Axial<2> const& a, Vector<2> const& r) { return {{-a[0] * r[1], a[0] * r[0]}}; }
    static Vector<3> cross_axial(Axial<3> const& a, Vector<3> const& r) { return cross(a, r); }
    static Axial<2> gyroscopic(Axial<2> const&, Axial<2> const&) { return {}; }
    static Axial<3> gyroscopic(Axial<3> const& spin, Axial<3> const& momentum) { return cross(spin, momentum); }

    AnySpeciesLaw law_;
    NoiseKind noise_kind_;
    std::size_t species_;
    double radius_ = 0.0;
};

}  // namespace tether
