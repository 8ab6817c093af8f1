// Bodies whose constituents are tethered to the sites of a base by springs (Phan-Thien et al. 2014, section 3).
//
// The force on constituent i is its DPD force plus F_S = -H (r_i - rbar_i), with rbar_i = X + R s_i the site: X and R
// are the base's center and rotation, s_i the shape.  Three ways to move the base:
//
//   massless             A base without mass bears no net force and no net torque, so it stands where the sites fit the
//                        constituents best: X is their center, R minimizes the spring energy.  The springs' forces are
//                        then the gradient of that minimum, a function of the constituents' positions alone, and
//                        conserve momentum and angular momentum.
//   newton_euler         The paper's algorithm (eq. 31-35): the base has a velocity and an angular momentum of its own,
//                        driven by the DPD forces on the constituents, and the springs do not pull back on it.
//   newton_euler_lagged  The same, reading "using data from the previous time step" literally: the base ends its step
//                        with the forces and torques that it began it with; its sites never see those of the step.
//
// Equation 34 has the wrong sign before its gyroscopic term; here dL/dt = T in the laboratory frame, which is
// I domega/dt = T - omega x I omega.
#pragma once

#include "bodies/bodies.hpp"

namespace tether {

enum class BaseMotion { massless, newton_euler, newton_euler_lagged };
enum class TorqueArms { constituents, sites };  // the paper's eq. 32 has constituents

template <int D>
class TetheredBodies final : public Bodies<D> {
    using typename Bodies<D>::Constituents;
    using Bodies<D>::bases, Bodies<D>::sites_;

  public:
    // Sites: as Bodies takes them.
    TetheredBodies(std::vector<Vector<D>> sites, std::size_t count, std::size_t first, double stiffness,
                   double constituent_mass, BaseMotion motion, TorqueArms arms)
        : Bodies<D>(std::move(sites), count, first, constituent_mass),
          stiffness_(stiffness),
          motion_(motion),
          arms_(arms) {}

    bool has_inertia() const override { return motion_ != BaseMotion::massless; }

    void before_forces(double timestep, double, State<D>&, Box<D> const& box, Team& team) override {
        if (!has_inertia()) return;
        this->kick(0.5 * timestep, team);
        this->drift(timestep, team);
        if (is_lagged()) this->kick(0.5 * timestep, team);
        this->wrap(box);
    }

    Held<D> hold(Holding const& step, State<D>& state, Box<D> const& box, Team& team) override {
        this->pulls.resize(step.keeps_pulls ? this->count() * sites_.size() : 0);
        return this->each_held(team, [&](std::size_t body, Held<D>& held) { tether(body, state, box, step, held); });
    }

    void after_forces(double timestep, Team& team) override {
        if (has_inertia() && !is_lagged()) this->kick(0.5 * timestep, team);
    }

  private:
    bool is_lagged() const { return motion_ == BaseMotion::newton_euler_lagged; }

    // Arms from a base that stands where it will, not at its constituents' center.
    void measure_from_base(std::size_t body, State<D> const& state, Box<D> const& box, Constituents& near) const {
        for (std::size_t i = 0; i < sites_.size(); ++i) {
            Vector<D> ignored{};
            near.arm[i] = this->position_of(state, this->first_id(body) + i) - bases[body].center;
            box.nearest_image(near.arm[i], ignored);
        }
    }

    void tether(std::size_t body, State<D>& state, Box<D> const& box, Holding const& step, Held<D>& held) {
        std::size_t const id = this->first_id(body);
        Base<D>& base = bases[body];
        Constituents& near = this->gather(body, state, box);
        if (step.gently || !has_inertia())
            this->fit(body, state, near);
        else
            measure_from_base(body, state, box, near);
        base.force = {};
        base.torque = {};
        for (std::size_t i = 0; i < sites_.size(); ++i) {
            Vector<D> const site = base.rotation.turn(sites_[i]);
            Vector<D> const spring = -stiffness_ * (near.arm[i] - site);
            std::size_t const place = state.place[id + i];
            Vector<D> const force = state.force[place];
            if (has_inertia()) {
                base.force += force;
                base.torque += cross(arms_ == TorqueArms::sites ? site : near.arm[i], force);
            }
            state.force.set(place, force + spring);
            add_moment<D>(held.moment, near.arm[i], spring);
            if (step.keeps_pulls) this->pulls[body * sites_.size() + i] = {near.arm[i], spring};
        }
    }

    double stiffness_;
    BaseMotion motion_;
    TorqueArms arms_;
};

}  // namespace tether
