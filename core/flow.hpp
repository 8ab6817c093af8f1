// What sets a suspension in motion: the shear that the box imposes, which may change from step to step, and forces along x
// on every particle.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "state.hpp"
#include "threads.hpp"

namespace tether {

// sin(2 pi turns), by its Taylor sum: the same bits on every processor, which the C library's sine has not.
inline double sine_of_turns(double turns) {
    double x = turns - std::nearbyint(turns);  // within half a turn
    if (x > 0.25) x = 0.5 - x;
    if (x < -0.25) x = -0.5 - x;  // within a quarter
    double const angle = 6.283185307179586 * x, square = angle * angle;
    constexpr int terms = 11;  // the next would be about 1e-18
    double sum = 0.0;
    for (int k = terms; k-- > 0;) sum = 1.0 - sum * square / ((2.0 * k + 2.0) * (2.0 * k + 3.0));
    return angle * sum;
}

// The shear rate of each step.  It is constant during a step, such that the strain at every step's end is exact:
//     stages      rate of the stage that the step is in; after the last one comes the first again
//     oscillation strain = amplitude sin(omega t), so rate = amplitude (sin(omega t) - sin(omega (t - dt))) / dt
class Shear {
  public:
    struct Stage {
        std::uint64_t steps;
        double rate;
    };

    static Shear steady(double rate) { return Shear({{1, rate}}, 0.0, 0.0); }
    static Shear stages(std::vector<Stage> stages) { return Shear(std::move(stages), 0.0, 0.0); }
    static Shear oscillation(double amplitude, double frequency) { return Shear({}, amplitude, frequency); }

    // Of the step that ends at `step` time steps; 1 is the first.
    double rate(std::uint64_t step, double timestep) const {
        if (stages_.empty()) {
            auto const strain = [&](double steps) {
                return amplitude_ * sine_of_turns(frequency_ * (steps * timestep) / 6.283185307179586);
            };
            return (strain(static_cast<double>(step)) - strain(static_cast<double>(step) - 1.0)) / timestep;
        }
        std::uint64_t place = (step + cycle_ - 1) % cycle_;
        for (Stage const& stage : stages_) {
            if (place < stage.steps) return stage.rate;
            place -= stage.steps;
        }
        return 0.0;
    }

  private:
    Shear(std::vector<Stage> stages, double amplitude, double frequency)
        : stages_(std::move(stages)), amplitude_(amplitude), frequency_(frequency) {
        for (Stage const& stage : stages_) cycle_ += stage.steps;
    }

    std::vector<Stage> stages_;
    std::uint64_t cycle_ = 0;
    double amplitude_, frequency_;  // omega, 1/time
};

// A force along x on every particle at height y of a box of height L:
//     poiseuille   g above L/2, -g below (the paper's section 4.8)
//     kolmogorov   g sin(2 pi n y/L)
// The mean over all particles at each moment is taken off, so that the suspension as a whole stays where it is.
struct Driving {
    enum class Profile { none, poiseuille, kolmogorov } profile = Profile::none;
    double force = 0.0;    // g
    double periods = 1.0;  // n, whole

    double at(double y, double height) const {
        if (profile == Profile::poiseuille) return y > 0.5 * height ? force : -force;
        return force * sine_of_turns(periods * y / height);
    }

    template <int D>
    void add_to(State<D>& state, double height, Team& team) const {
        if (profile == Profile::none) return;
        constexpr std::size_t block = 1024;
        std::vector<double> sums((state.size() + block - 1) / block);
        double const* const y = state.position.axis[1].data();
        double* const f = state.force.axis[0].data();
        team.ranges(state.size(), block, [&](std::size_t begin, std::size_t end, std::size_t unit) {
            double sum = 0.0;
            for (std::size_t p = begin; p < end; ++p) {
                double const push = at(y[p], height);
                f[p] += push;
                sum += push;
            }
            sums[unit] = sum;
        });
        double sum = 0.0;
        for (double part : sums) sum += part;
        double const mean = sum / static_cast<double>(state.size());
        team.ranges(state.size(), block, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t p = begin; p < end; ++p) f[p] -= mean;
        });
    }
};

}  // namespace tether
