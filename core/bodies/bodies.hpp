// Bodies of one shape, whatever holds their constituents together: where they are, how they move, and what a base with
// inertia does between two evaluations of the forces.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "bodies/rotation.hpp"
#include "box.hpp"
#include "noise.hpp"
#include "observe/virial.hpp"
#include "state.hpp"
#include "threads.hpp"
#include "vector.hpp"

namespace tether {

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

// What holds a constituent: the force on it from its base, at `arm` from the base's center.
template <int D>
struct Pull {
    Vector<D> arm, force;
};

// The step that bodies are held in.
struct Holding {
    StepKey key;       // of the noise
    double pending;    // time by which bases are still to be kicked with the forces that are found now
    bool gently;       // in the gentle start
    bool is_measured;  // the stress is wanted
    bool keeps_pulls;  // Bodies::pulls is wanted
};

// What bodies of one kind add to the stress, sums over bodies (energy): sum (r_i - X) F_i of the forces that hold the
// constituents; and, where constituents do not act on each other, what the pair loop took for their doing,
// sum over pairs r_ij F_ij, term by term.
template <int D>
struct Held {
    Tensor<D> moment{}, inner_conservative{}, inner_random{};

    Held& operator+=(Held const& b) {
        for (auto [to, from] : {std::pair(&moment, &b.moment), std::pair(&inner_conservative, &b.inner_conservative),
                                std::pair(&inner_random, &b.inner_random)})
            for (std::size_t k = 0; k < D; ++k)
                for (std::size_t l = 0; l < D; ++l) (*to)[k][l] += (*from)[k][l];
        return *this;
    }
};

template <int D>
class Bodies {
  public:
    // Sites: about their centroid and along the principal axes of their inertia.  `first` is the id of the first
    // constituent.
    Bodies(std::vector<Vector<D>> sites, std::size_t count, std::size_t first, double constituent_mass)
        : bases(count), sites_(std::move(sites)), first_(first), mass_(constituent_mass) {
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
        for (double inverse : inverse_moments_) rotational_freedom_ += inverse > 0.0;
    }
    virtual ~Bodies() = default;

    std::size_t count() const { return bases.size(); }
    std::size_t sites_per_body() const { return sites_.size(); }
    std::size_t first_id(std::size_t body) const { return first_ + body * sites_.size(); }
    std::size_t end_id() const { return first_ + count() * sites_.size(); }
    double body_mass() const { return mass_ * static_cast<double>(sites_.size()); }
    int rotational_freedom() const { return rotational_freedom_; }

    // Whether the base has a motion of its own, and whether the constituents have none.
    virtual bool has_inertia() const = 0;
    virtual bool is_rigid() const { return false; }

    // From one evaluation of the forces to the next, in which the particles have been moved already; `box` has advanced.
    // In the gentle start nothing moves faster than `most_speed`.
    virtual void before_forces(double timestep, double most_speed, State<D>& state, Box<D> const& box, Team& team) = 0;
    // Given the other forces in state.force: what they do to the base, and the forces that hold the constituents.
    virtual Held<D> hold(Holding const& step, State<D>& state, Box<D> const& box, Team& team) = 0;
    // The rest of the step.
    virtual void after_forces(double timestep, Team& team) = 0;
    // At the end of a step, once the particles have their velocities there.
    virtual void settle(State<D>&, Box<D> const&, Team&) {}

    // Stand every base where its constituents are and let it move as they do.
    void place(State<D>& state, Box<D> const& box, Team& team) {
        for (std::size_t b = 0; b < count(); ++b) {
            fit(b, state, gather(b, state, box));
            BodyMotion<D> const motion = motion_of(b, state, box);
            bases[b].velocity = motion.velocity;
            bases[b].angular_momentum = motion.angular_momentum;
            box.wrap(bases[b].center, bases[b].velocity);
        }
        settle(state, box, team);
    }

    // The imposed profile changes by `shear_rate` (y - L_y/2), and with it what moves along.
    void change_profile(double shear_rate, State<D> const& state, Box<D> const& box) {
        if (!has_inertia()) return;
        for (std::size_t b = 0; b < count(); ++b) {
            Base<D>& base = bases[b];
            base.velocity[0] += shear_rate * (base.center[1] - 0.5 * box.length()[1]);
            for (Vector<D> const& arm : gather(b, state, box).arm) {
                Vector<D> change{};
                change[0] = mass_ * shear_rate * arm[1];
                base.angular_momentum += cross(arm, change);
            }
        }
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

    std::vector<Base<D>> bases;
    std::vector<Pull<D>> pulls;  // of each constituent, body by body, where they were to be kept

  protected:
    static constexpr std::size_t block = 32;  // bodies of one unit of work

    void kick(double time, Team& team) {
        team.ranges(count(), block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t b = begin; b < end; ++b) {
                bases[b].velocity += (time / body_mass()) * bases[b].force;
                bases[b].angular_momentum += time * bases[b].torque;
                if (rotational_freedom() < static_cast<int>(axial<D>)) keep_across(bases[b]);
            }
        });
    }

    // Free flight: the center goes straight, and the body turns about its principal axes in the symmetric order of
    // Dullweber, Leimkuhler & McLachlan (1997, doi 10.1063/1.474310), which keeps the angular momentum exactly and is
    // reversible.  A rod, which has no inertia about its line, turns uniformly about the axis of its angular momentum.
    void drift(double time, Team& team) {
        team.ranges(count(), block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t b = begin; b < end; ++b) {
                Base<D>& base = bases[b];
                base.center += time * base.velocity;
                if constexpr (D == 3)
                    if (rotational_freedom() == 2) {
                        Axial<D> const own = base.rotation.turn_back_axial(base.angular_momentum);
                        base.rotation.turn_about_own_axis(time * largest_inverse_moment() * across(own));
                        continue;
                    }
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

    // The inverse moment of a rod across its line, and an angular quantity without the part along it.
    double largest_inverse_moment() const {
        return *std::max_element(inverse_moments_.begin(), inverse_moments_.end());
    }
    Axial<D> across(Axial<D> own) const {
        for (std::size_t k = 0; k < own.size(); ++k)
            if (inverse_moments_[k] == 0.0) own[k] = 0.0;
        return own;
    }

    // A rod has no angular momentum along its line: what stretched springs would add to it turns nothing.
    void keep_across(Base<D>& base) const {
        base.angular_momentum = base.rotation.turn_axial(across(base.rotation.turn_back_axial(base.angular_momentum)));
    }

    void wrap(Box<D> const& box) {
        for (Base<D>& base : bases) box.wrap(base.center, base.velocity);
    }

    Axial<D> spin_of(Base<D> const& base, Axial<D> const& angular_momentum) const {
        Axial<D> own = base.rotation.turn_back_axial(angular_momentum);
        for (std::size_t k = 0; k < own.size(); ++k) own[k] *= inverse_moments_[k];
        return base.rotation.turn_axial(own);
    }

    // Sum what `one(body, held)` adds, block by block.
    template <class One>
    Held<D> each_held(Team& team, One&& one) {
        std::vector<Held<D>> parts((count() + block - 1) / block);
        team.ranges(count(), block, [&](std::size_t begin, std::size_t end, std::size_t unit) {
            parts[unit] = {};
            for (std::size_t b = begin; b < end; ++b) one(b, parts[unit]);
        });
        Held<D> sum;
        for (Held<D> const& part : parts) sum += part;
        return sum;
    }

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
    double mass_;  // of a constituent
    Axial<D> moments_{}, inverse_moments_{};
    int rotational_freedom_ = 0;
};

template <int D>
void add_moment(Tensor<D>& moment, Vector<D> const& arm, Vector<D> const& force) {
    for (std::size_t k = 0; k < D; ++k)
        for (std::size_t l = 0; l < D; ++l) moment[k][l] += arm[k] * force[l];
}

}  // namespace tether
