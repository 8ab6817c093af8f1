// The periodic box, sheared or not (Lees & Edwards 1972, doi 10.1088/0022-3719/5/15/006).
//
// x is the flow direction, y the gradient, z the vorticity.  The image of the box one period up in y stands displaced
// by `offset` along +x and moves at `velocity_difference` = shear_rate * L_y along +x.  The box owns both, so nobody
// who asks it for an image can forget the second.  The imposed flow is u_x = shear_rate (y - L_y/2).
#pragma once

#include <cmath>

#include "kernels/kernels.hpp"
#include "vector.hpp"

namespace tether {

template <int D>
class Box {
  public:
    Box(Vector<D> const& length, double shear_rate) : length_(length), shear_rate_(shear_rate) {}

    Vector<D> const& length() const { return length_; }
    double shear_rate() const { return shear_rate_; }
    double offset() const { return offset_; }  // in [0, L_x)
    double velocity_difference() const { return shear_rate_ * length_[1]; }
    double flow_velocity(double y) const { return shear_rate_ * (y - 0.5 * length_[1]); }
    double volume() const {
        double product = 1.0;
        for (double side : length_) product *= side;
        return product;
    }

    BoxNumbers<D> numbers() const {
        BoxNumbers<D> bare{{}, shear_rate_, offset_, velocity_difference()};
        for (std::size_t k = 0; k < D; ++k) bare.length[k] = length_[k];
        return bare;
    }

    void set_offset(double offset) { offset_ = wrapped(offset, length_[0]); }
    void set_shear_rate(double shear_rate) { shear_rate_ = shear_rate; }
    void advance(double time) { set_offset(offset_ + velocity_difference() * time); }

    // Put a particle back into the box, with the velocity of the image that it becomes.
    void wrap(Vector<D>& position, Vector<D>& velocity) const {
        if (!is_inside(position[1], length_[1])) {
            double const crossings = std::floor(position[1] / length_[1]);
            double const y = position[1] - crossings * length_[1];
            if (y < length_[1]) {  // else it stands a rounding error below 0, and is at 0
                position[1] = y;
                position[0] -= crossings * offset_;
                velocity[0] -= crossings * velocity_difference();
            } else {
                position[1] = 0.0;
            }
        }
        position[0] = wrapped(position[0], length_[0]);
        if constexpr (D == 3) position[2] = wrapped(position[2], length_[2]);
    }

    // Turn the separation and relative velocity of two particles into those of their nearest images.
    void nearest_image(Vector<D>& separation, Vector<D>& relative_velocity) const {
        double const rows = std::nearbyint(separation[1] / length_[1]);
        separation[1] -= rows * length_[1];
        separation[0] -= rows * offset_;
        relative_velocity[0] -= rows * velocity_difference();
        separation[0] -= length_[0] * std::nearbyint(separation[0] / length_[0]);
        if constexpr (D == 3) separation[2] -= length_[2] * std::nearbyint(separation[2] / length_[2]);
    }

  private:
    static bool is_inside(double x, double side) { return x >= 0.0 && x < side; }

    static double wrapped(double x, double side) {
        if (is_inside(x, side)) return x;  // nearly always, and floor is slow
        double const inside = x - side * std::floor(x / side);
        return inside < side ? inside : 0.0;
    }

    Vector<D> length_;
    double shear_rate_;
    double offset_ = 0.0;
};

}  // namespace tether
