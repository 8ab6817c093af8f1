// Orientation of a body: a unit complex number in 2D, a unit quaternion in 3D, and the best rotation between two
// point sets.
#pragma once

#include <cmath>
#include <cstddef>

#include "vector.hpp"

namespace tether {

template <int D>
struct Rotation;

template <>
struct Rotation<2> {
    double cosine = 1.0, sine = 0.0;

    Vector<2> turn(Vector<2> const& r) const { return {{cosine * r[0] - sine * r[1], sine * r[0] + cosine * r[1]}}; }
    Vector<2> turn_back(Vector<2> const& r) const {
        return {{cosine * r[0] + sine * r[1], -sine * r[0] + cosine * r[1]}};
    }
    Axial<2> turn_axial(Axial<2> const& a) const { return a; }
    Axial<2> turn_back_axial(Axial<2> const& a) const { return a; }
    void turn_about_own_axis(std::size_t, double angle) {
        Vector<2> const turned = turn({{std::cos(angle), std::sin(angle)}});
        double const norm = std::sqrt(dot(turned, turned));
        *this = {turned[0] / norm, turned[1] / norm};
    }
};

template <>
struct Rotation<3> {
    double w = 1.0, x = 0.0, y = 0.0, z = 0.0;

    Vector<3> turn(Vector<3> const& r) const { return turned(r, 1.0); }
    Vector<3> turn_back(Vector<3> const& r) const { return turned(r, -1.0); }
    Axial<3> turn_axial(Axial<3> const& a) const { return turn(a); }
    Axial<3> turn_back_axial(Axial<3> const& a) const { return turn_back(a); }

    // Turn by `angle` about the body's own axis k: q <- q (cos, sin e_k) of the half angle, normalized.
    void turn_about_own_axis(std::size_t k, double angle) {
        Vector<3> p{};
        p[k] = std::sin(0.5 * angle);
        multiply(std::cos(0.5 * angle), p);
    }

    // Turn about the body's own axis that `angles` points along, by its length: exact, however large.
    void turn_about_own_axis(Vector<3> const& angles) {
        double const angle = std::sqrt(dot(angles, angles));
        if (angle == 0.0) return;
        multiply(std::cos(0.5 * angle), (std::sin(0.5 * angle) / angle) * angles);
    }

  private:
    // q <- q (c, p), normalized.
    void multiply(double c, Vector<3> const& p) {
        Rotation const q{w * c - x * p[0] - y * p[1] - z * p[2], w * p[0] + x * c + y * p[2] - z * p[1],
                         w * p[1] + y * c + z * p[0] - x * p[2], w * p[2] + z * c + x * p[1] - y * p[0]};
        double const norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        *this = {q.w / norm, q.x / norm, q.y / norm, q.z / norm};
    }

    // r + 2 u x (u x r + w r), with u the vector part of the quaternion, or minus that for the way back.
    Vector<3> turned(Vector<3> const& r, double sign) const {
        Vector<3> const u{{sign * x, sign * y, sign * z}};
        Vector<3> const inner = cross(u, r) + w * r;
        return r + 2.0 * cross(u, inner);
    }
};

// Sum over points of (reference_k actual_l).
template <int D>
using Correlation = std::array<std::array<double, D>, D>;

// The rotation R that minimizes sum |actual - R reference|^2.  In 2D this is one angle.
inline Rotation<2> best_rotation(Correlation<2> const& s) {
    double const cosine = s[0][0] + s[1][1], sine = s[0][1] - s[1][0];
    double const norm = std::sqrt(cosine * cosine + sine * sine);
    if (norm == 0.0) return {};
    return {cosine / norm, sine / norm};
}

// The unit quaternion of a rotation matrix, from its largest component.
inline Rotation<3> quaternion_of(double const (&r)[3][3]) {
    double const diagonal[4] = {r[0][0] + r[1][1] + r[2][2], r[0][0] - r[1][1] - r[2][2], r[1][1] - r[0][0] - r[2][2],
                                r[2][2] - r[0][0] - r[1][1]};  // 4 q_i^2 - 1
    int largest = 0;
    for (int i = 1; i < 4; ++i)
        if (diagonal[i] > diagonal[largest]) largest = i;
    double const twice = std::sqrt(1.0 + diagonal[largest]), quarter = 0.5 / twice;
    double const antisymmetric[3] = {r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};  // 4 w (x, y, z)
    if (largest == 0)
        return {0.5 * twice, antisymmetric[0] * quarter, antisymmetric[1] * quarter, antisymmetric[2] * quarter};
    int const a = largest - 1, b = (a + 1) % 3, c = (a + 2) % 3;
    double axis[3];
    axis[a] = 0.5 * twice;
    axis[b] = (r[a][b] + r[b][a]) * quarter;
    axis[c] = (r[a][c] + r[c][a]) * quarter;
    return {antisymmetric[a] * quarter, axis[0], axis[1], axis[2]};
}

// Fit in 3D, for points that span space and are not far from a rotated copy of the reference: R is the orthogonal factor
// of A = sum (actual reference^T) = R S, by Newton's iteration X <- (X + X^-T)/2 (Higham 1986, doi 10.1137/0907079), which
// converges quadratically from any A of positive determinant.  False, and nothing done, for other points.
inline bool polar_rotation(Correlation<3> const& s, Rotation<3>& rotation) {
    double square = 0.0;
    for (auto const& row : s)
        for (double entry : row) square += entry * entry;
    double const scale = std::sqrt(3.0 / square);  // singular values about 1
    double x[3][3];
    for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) x[l][k] = scale * s[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)];
    constexpr double flat = 1e-3;   // of the determinant: 1 for a cube, 0 for points in a plane
    constexpr double close = 1e-9;  // a change this small leaves an error of its square
    for (int iteration = 0; iteration < 30; ++iteration) {
        double cofactor[3][3];
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                int const k1 = (k + 1) % 3, k2 = (k + 2) % 3, l1 = (l + 1) % 3, l2 = (l + 2) % 3;
                cofactor[k][l] = x[k1][l1] * x[k2][l2] - x[k1][l2] * x[k2][l1];
            }
        double const determinant = x[0][0] * cofactor[0][0] + x[0][1] * cofactor[0][1] + x[0][2] * cofactor[0][2];
        if (!(determinant > flat)) return false;
        double const half_inverse = 0.5 / determinant;
        double change = 0.0;
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                double const next = 0.5 * x[k][l] + half_inverse * cofactor[k][l];  // X^-T = cofactors / determinant
                change += (next - x[k][l]) * (next - x[k][l]);
                x[k][l] = next;
            }
        if (change <= close * close) {
            rotation = quaternion_of(x);
            return true;
        }
    }
    return false;
}

// For any points in 3D the quaternion of R is the eigenvector of the largest eigenvalue of a symmetric 4 x 4 matrix (Horn 1987,
// doi 10.1364/JOSAA.4.000629), found by Jacobi rotations, which are accurate to rounding, need no start and so are a
// pure function of the points.  Points on a line leave the turn about that line open: any is returned, and all place
// the points alike.
inline Rotation<3> best_rotation(Correlation<3> const& s) {
    Rotation<3> rotation;
    if (polar_rotation(s, rotation)) return rotation;
    double m[4][4] = {
        {s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]},
        {s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
        {s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]},
        {s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]},
    };
    double v[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    double scale = 0.0;
    for (auto const& row : m)
        for (double entry : row) scale += entry * entry;
    constexpr int most_sweeps = 50;  // convergence is quadratic: some five sweeps
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        double off_diagonal = 0.0;
        for (int p = 0; p < 3; ++p)
            for (int q = p + 1; q < 4; ++q) off_diagonal += m[p][q] * m[p][q];
        if (off_diagonal <= 1e-34 * scale) break;  // a relative angle of 1e-17: below rounding
        for (int p = 0; p < 3; ++p)
            for (int q = p + 1; q < 4; ++q) {
                if (m[p][q] == 0.0) continue;
                double const theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
                double const t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
                double const c = 1.0 / std::sqrt(t * t + 1.0), sn = t * c;
                for (int k = 0; k < 4; ++k) {
                    double const a = m[k][p], b = m[k][q];
                    m[k][p] = c * a - sn * b;
                    m[k][q] = sn * a + c * b;
                }
                for (int k = 0; k < 4; ++k) {
                    double const a = m[p][k], b = m[q][k];
                    m[p][k] = c * a - sn * b;
                    m[q][k] = sn * a + c * b;
                }
                for (int k = 0; k < 4; ++k) {
                    double const a = v[k][p], b = v[k][q];
                    v[k][p] = c * a - sn * b;
                    v[k][q] = sn * a + c * b;
                }
            }
    }
    int best = 0;
    for (int k = 1; k < 4; ++k)
        if (m[k][k] > m[best][best]) best = k;
    return {v[0][best], v[1][best], v[2][best], v[3][best]};
}

}  // namespace tether
