// A point, velocity or force in D = 2 or 3 dimensions.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace tether {

template <int D>
struct Vector : std::array<double, D> {
    Vector& operator+=(Vector const& b) {
        for (std::size_t k = 0; k < D; ++k) (*this)[k] += b[k];
        return *this;
    }
    Vector& operator-=(Vector const& b) {
        for (std::size_t k = 0; k < D; ++k) (*this)[k] -= b[k];
        return *this;
    }
    Vector& operator*=(double s) {
        for (std::size_t k = 0; k < D; ++k) (*this)[k] *= s;
        return *this;
    }
    friend Vector operator+(Vector a, Vector const& b) { return a += b; }
    friend Vector operator-(Vector a, Vector const& b) { return a -= b; }
    friend Vector operator*(double s, Vector a) { return a *= s; }
};

template <int D>
double dot(Vector<D> const& a, Vector<D> const& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
}

// Angular quantities: one number in 2D (about z), three in 3D.
template <int D>
using Axial = Vector<D == 2 ? 1 : 3>;

inline Axial<2> cross(Vector<2> const& a, Vector<2> const& b) { return {{a[0] * b[1] - a[1] * b[0]}}; }
inline Axial<3> cross(Vector<3> const& a, Vector<3> const& b) {
    return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

}  // namespace tether
