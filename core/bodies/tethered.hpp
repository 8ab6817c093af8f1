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

#include <cstdint>
#include <vector>

#include "bodies/rotation.hpp"
#include "box.hpp"
#include "observe/virial.hpp"
#include "state.hpp"
#include "threads.hpp"

namespace tether {

enum class BaseMotion { massless, newton_euler, newton_euler_lagged };
enum class TorqueArms { constituents, sites };  // the paper's eq. 32 has constituents

template <int D>
struct Base {
    Vector<D> center{};
    Rotation<D> rotation{};
    Vector<D> velocity{};         // from here on: of a base with inertia only
    Axial<D> angular_momentum{};  // in the laboratory frame
    Vector<D> force{};
    Axial<D> torque{};
};

template <int D>
constexpr std::size_t axial = D == 2 ? 1 : 3;  // components of an angular quantity

template <int D>
using Inertia = std::array<std::array<double, axial<D>>, axial<D>>;

// What a body's constituents do together.  The turns are those of the constituents as they stand at the moment,
// springs stretched: given the places, Maxwellian velocities make <L . I^-1 . L> exactly kT for each axis, however
// soft the springs.
template <int D>
struct BodyMotion {
    Vector<D> center, velocity;
    Axial<D> angular_momentum;  // about the center, laboratory axes
    Inertia<D> inertia{};       // without what turns about the line of a collinear body
    Axial<D> spin{};            // omega = I^-1 L
};

// Bodies of one shape.
template <int D>
class TetheredBodies {
  public:
    // Sites: about their centroid and along the principal axes of their inertia.  `first` is the id of the first
    // constituent.
    TetheredBodies(std::vector<Vector<D>> sites, std::size_t count, std::size_t first, double stiffness,
                   double constituent_mass, BaseMotion motion, TorqueArms arms)
        : sites_(std::move(sites)),
          first_(first),
          stiffness_(stiffness),
          mass_(constituent_mass),
          motion_(motion),
          arms_(arms),
          bases(count) {
        for (Vector<D> const& s : sites_) {
            double const square = dot(s, s);
            if constexpr (D == 2)
                moments_[0] += mass_ * square;
            else
                for (std::size_t k = 0; k < 3; ++k) moments_[k] += mass_ * (square - s[k] * s[k]);
        }
        double largest = 0.0;
        for (double moment : moments_) largest = std::max(largest, moment);
        for (std::size_t k = 0; k < moments_.size();
             ++k)  // sites on a line have no inertia about it, and no turn about it either
            inverse_moments_[k] = moments_[k] > 1e-12 * largest ? 1.0 / moments_[k] : 0.0;
    }

    std::size_t count() const { return bases.size(); }
    std::size_t sites_per_body() const { return sites_.size(); }
    std::size_t first_id(std::size_t body) const { return first_ + body * sites_.size(); }
    std::size_t end_id() const { return first_ + count() * sites_.size(); }
    bool has_inertia() const { return motion_ != BaseMotion::massless; }
    bool lagged() const { return motion_ == BaseMotion::newton_euler_lagged; }
    double body_mass() const { return mass_ * static_cast<double>(sites_.size()); }
    int rotational_freedom() const {
        int freedom = 0;
        for (double inverse : inverse_moments_) freedom += inverse > 0.0;
        return freedom;
    }

    // Stand every base where its constituents are and let it move as they do.
    void place(State<D> const& state, Box<D> const& box) {
        for (std::size_t b = 0; b < count(); ++b) {
            fit(b, state, gather(b, state, box));
            BodyMotion<D> const motion = motion_of(b, state, box);
            bases[b].velocity = motion.velocity;
            bases[b].angular_momentum = motion.angular_momentum;
            box.wrap(bases[b].center, bases[b].velocity);
        }
    }

    void kick(double time, Team& team) {
        if (!has_inertia()) return;
        team.ranges(count(), block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t b = begin; b < end; ++b) {
                bases[b].velocity += (time / body_mass()) * bases[b].force;
                bases[b].angular_momentum += time * bases[b].torque;
            }
        });
    }

    // Free flight: the center goes straight, and the body turns about its principal axes in the symmetric order of
    // Dullweber, Leimkuhler & McLachlan (1997, doi 10.1063/1.474310), which keeps the angular momentum exactly and is
    // reversible.
    void drift(double time, Team& team) {
        if (!has_inertia()) return;
        team.ranges(count(), block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t b = begin; b < end; ++b) {
                Base<D>& base = bases[b];
                base.center += time * base.velocity;
                auto const turn = [&](std::size_t k, double t) {
                    double const own = base.rotation.turn_back_axial(base.angular_momentum)[k];
                    base.rotation.turn_about_own_axis(k, t * own * inverse_moments_[k]);
                };
                for (std::size_t k = 0; k + 1 < moments_.size(); ++k) turn(k, 0.5 * time);
                turn(moments_.size() - 1, time);
                for (std::size_t k = moments_.size() - 1; k-- > 0;) turn(k, 0.5 * time);
            }
        });
    }

    void wrap(Box<D> const& box) {
        if (!has_inertia()) return;
        for (Base<D>& base : bases) box.wrap(base.center, base.velocity);
    }

    // Given the DPD forces in state.force: drive the base, add the springs, and return sum (r_i - X) F_S,i over all
    // bodies (energy). `massless` overrides the base's own way of moving (in the gentle start).
    Tensor<D> tether(State<D>& state, Box<D> const& box, Team& team, bool massless) {
        std::vector<Tensor<D>> moments((count() + block - 1) / block);
        team.ranges(count(), block, [&](std::size_t begin, std::size_t end, std::size_t unit) {
            moments[unit] = {};
            for (std::size_t b = begin; b < end; ++b) tether_one(b, state, box, massless, moments[unit]);
        });
        Tensor<D> sum{};
        for (Tensor<D> const& part : moments)
            for (std::size_t k = 0; k < D; ++k)
                for (std::size_t l = 0; l < D; ++l) sum[k][l] += part[k][l];
        return sum;
    }

    BodyMotion<D> motion_of(std::size_t body, State<D> const& state, Box<D> const& box) const {
        Constituents& near = gather(body, state, box);
        BodyMotion<D> motion{};
        motion.center = position_of(state, first_id(body)) + near.center;
        for (Vector<D> const& v : near.velocity) motion.velocity += (1.0 / static_cast<double>(sites_.size())) * v;
        // In the body's own axes if it is collinear, so that its line is one of them; else in the laboratory's.
        Rotation<D> const& rotation = bases[body].rotation;
        bool const is_collinear = rotational_freedom() < static_cast<int>(axial<D>);
        auto const in_axes = [&](Vector<D> const& r) { return is_collinear ? rotation.turn_back(r) : r; };
        auto const in_laboratory = [&](Axial<D> const& a) { return is_collinear ? rotation.turn_axial(a) : a; };
        Axial<D> momentum{};
        Inertia<D> inertia{};
        for (std::size_t i = 0; i < sites_.size(); ++i) {
            Vector<D> const arm = in_axes(near.arm[i]);
            momentum += cross(arm, in_axes(near.velocity[i] - motion.velocity));
            double const square = dot(arm, arm);
            for (std::size_t k = 0; k < axial<D>; ++k)
                for (std::size_t l = 0; l < axial<D>; ++l)
                    inertia[k][l] += (k == l ? square : 0.0) - (D == 3 ? arm[k] * arm[l] : 0.0);
        }
        for (std::size_t k = 0; k < axial<D>; ++k) {
            momentum[k] *= mass_;
            for (std::size_t l = 0; l < axial<D>; ++l) inertia[k][l] *= mass_;
        }
        for (std::size_t k = 0; k < axial<D>; ++k)
            if (inverse_moments_[k] == 0.0) {
                momentum[k] = 0.0;
                for (std::size_t l = 0; l < axial<D>; ++l) inertia[k][l] = inertia[l][k] = 0.0;
            }
        motion.angular_momentum = in_laboratory(momentum);
        motion.spin = in_laboratory(solve(inertia, momentum));
        motion.inertia = is_collinear ? turned(rotation, inertia) : inertia;
        return motion;
    }

  private:
    static constexpr std::size_t block = 32;  // bodies of one unit of work

    // A body's constituents as the images nearest to its first one.  Arms are sums of small numbers, so that the
    // springs' net force vanishes to the rounding of an arm rather than of a coordinate.
    struct Constituents {
        Vector<D> center;            // against the first constituent
        std::vector<Vector<D>> arm;  // r_i - center
        std::vector<Vector<D>> velocity;
    };

    static Vector<D> position_of(State<D> const& state, std::size_t id) { return state.position[state.place[id]]; }

    Constituents& gather(std::size_t body, State<D> const& state, Box<D> const& box) const {
        thread_local Constituents near;
        std::size_t const id = first_id(body);
        near.arm.resize(sites_.size());
        near.velocity.resize(sites_.size());
        near.center = {};
        Vector<D> const first_position = position_of(state, id), first_velocity = state.velocity[state.place[id]];
        for (std::size_t i = 0; i < sites_.size(); ++i) {
            Vector<D> separation = state.position[state.place[id + i]] - first_position;
            Vector<D> relative_velocity = state.velocity[state.place[id + i]] - first_velocity;
            box.nearest_image(separation, relative_velocity);
            near.arm[i] = separation;
            near.velocity[i] = first_velocity + relative_velocity;
            near.center += (1.0 / static_cast<double>(sites_.size())) * separation;
        }
        for (Vector<D>& arm : near.arm) arm -= near.center;
        return near;
    }

    // The best fit of the sites to the constituents.
    void fit(std::size_t body, State<D> const& state, Constituents const& near) {
        Base<D>& base = bases[body];
        base.center = position_of(state, first_id(body)) + near.center;
        Correlation<D> correlation{};
        for (std::size_t i = 0; i < sites_.size(); ++i)
            for (std::size_t k = 0; k < D; ++k)
                for (std::size_t l = 0; l < D; ++l) correlation[k][l] += sites_[i][k] * near.arm[i][l];
        base.rotation = best_rotation(correlation);
    }

    // Arms from a base that stands where it will, not at its constituents' center.
    void measure_from_base(std::size_t body, State<D> const& state, Box<D> const& box, Constituents& near) const {
        for (std::size_t i = 0; i < sites_.size(); ++i) {
            Vector<D> ignored{};
            near.arm[i] = position_of(state, first_id(body) + i) - bases[body].center;
            box.nearest_image(near.arm[i], ignored);
        }
    }

    void tether_one(std::size_t body, State<D>& state, Box<D> const& box, bool massless, Tensor<D>& moment) {
        std::size_t const id = first_id(body);
        Base<D>& base = bases[body];
        Constituents& near = gather(body, state, box);
        if (massless || !has_inertia())
            fit(body, state, near);
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
            for (std::size_t k = 0; k < D; ++k)
                for (std::size_t l = 0; l < D; ++l) moment[k][l] += near.arm[i][k] * spring[l];
        }
    }

    // omega with I omega = L over the axes that have inertia: by elimination, as I is positive on them.
    static Axial<D> solve(Inertia<D> inertia, Axial<D> momentum) {
        for (std::size_t k = 0; k < axial<D>; ++k) {
            if (inertia[k][k] == 0.0) continue;
            for (std::size_t row = k + 1; row < axial<D>; ++row) {
                double const factor = inertia[row][k] / inertia[k][k];
                for (std::size_t l = k; l < axial<D>; ++l) inertia[row][l] -= factor * inertia[k][l];
                momentum[row] -= factor * momentum[k];
            }
        }
        Axial<D> spin{};
        for (std::size_t k = axial<D>; k-- > 0;) {
            if (inertia[k][k] == 0.0) continue;
            double rest = momentum[k];
            for (std::size_t l = k + 1; l < axial<D>; ++l) rest -= inertia[k][l] * spin[l];
            spin[k] = rest / inertia[k][k];
        }
        return spin;
    }

    // R I R^T
    static Inertia<D> turned(Rotation<D> const& rotation, Inertia<D> inertia) {
        for (int side = 0; side < 2; ++side) {  // rows, then (the transpose's rows) columns
            for (auto& row : inertia) {
                Axial<D> axis{};
                for (std::size_t k = 0; k < axial<D>; ++k) axis[k] = row[k];
                axis = rotation.turn_axial(axis);
                for (std::size_t k = 0; k < axial<D>; ++k) row[k] = axis[k];
            }
            for (std::size_t k = 0; k < axial<D>; ++k)
                for (std::size_t l = k + 1; l < axial<D>; ++l) std::swap(inertia[k][l], inertia[l][k]);
        }
        return inertia;
    }

    std::vector<Vector<D>> sites_;
    std::size_t first_;
    double stiffness_, mass_;
    BaseMotion motion_;
    TorqueArms arms_;
    Axial<D> moments_{}, inverse_moments_{};

  public:
    std::vector<Base<D>> bases;
};

}  // namespace tether
