// The loops over single particles.  Included by files that are each compiled for one instruction set: what is here has a
// copy of its own in each of them.
#pragma once

#include "kernels/kernels.hpp"
#include "simd/pack.hpp"

namespace tether {
namespace {

template <int D>
void kick(Columns<D> const& particles, double time, std::size_t begin, std::size_t end) {
    double const* const inverse_mass = particles.inverse_mass;
    for (int k = 0; k < D; ++k) {
        double* __restrict const v = particles.velocity[k];
        double const* __restrict const f = particles.force[k];
        for (std::size_t i = begin; i < end; ++i) v[i] += time * inverse_mass[i] * f[i];
    }
}

template <int D>
void drift(Columns<D> const& particles, double time, std::size_t begin, std::size_t end) {
    for (int k = 0; k < D; ++k) {
        double* __restrict const r = particles.position[k];
        double const* __restrict const v = particles.velocity[k];
        for (std::size_t i = begin; i < end; ++i) r[i] += time * v[i];
    }
}

// x in [0, side); by selection, so that it is one instruction after another for a whole pack.
TETHER_DEVICE inline double wrapped(double x, double side) {
    double const inside = x - side * __builtin_floor(x / side);
    double const outside_again = inside < side ? inside : 0.0;
    return (x >= 0.0) & (x < side) ? x : outside_again;
}

// As Box::wrap.
template <int D>
void wrap(Columns<D> const& particles, BoxNumbers<D> const& box, std::size_t begin, std::size_t end) {
    double* __restrict const x = particles.position[0];
    double* __restrict const y = particles.position[1];
    double* __restrict const v = particles.velocity[0];
    double const height = box.length[1], offset = box.offset, velocity_difference = box.velocity_difference;
    for (std::size_t i = begin; i < end; ++i) {
        bool const is_inside = (y[i] >= 0.0) & (y[i] < height);
        double crossings = is_inside ? 0.0 : __builtin_floor(y[i] / height);
        double const back = y[i] - crossings * height;
        bool const fits = back < height;  // else it stands a rounding error below 0, and is at 0
        crossings = fits ? crossings : 0.0;
        y[i] = fits ? back : 0.0;
        x[i] -= crossings * offset;
        v[i] -= crossings * velocity_difference;
    }
    double const width = box.length[0];
    for (std::size_t i = begin; i < end; ++i) x[i] = wrapped(x[i], width);
    if constexpr (D == 3) {
        double* __restrict const z = particles.position[2];
        double const depth = box.length[2];
        for (std::size_t i = begin; i < end; ++i) z[i] = wrapped(z[i], depth);
    }
}

template <int D>
bool runaway(Columns<D> const& particles, BoxNumbers<D> const& box, double speed, std::size_t begin, std::size_t end) {
    double const rate = box.shear_rate, half = 0.5 * box.length[1], most = speed * speed;
    double const* __restrict const y = particles.position[1];
    double const* __restrict const vx = particles.velocity[0];
    double const* __restrict const vy = particles.velocity[1];
    double const* __restrict const vz = particles.velocity[D - 1];
    long found = 0;
    for (std::size_t i = begin; i < end; ++i) {
        double const peculiar = vx[i] - rate * (y[i] - half);
        double square = peculiar * peculiar + vy[i] * vy[i];
        if constexpr (D == 3) square += vz[i] * vz[i];
        found |= square <= most ? 0l : 1l;  // what is not a number is not <= either
    }
    return found != 0;
}

template <int D>
void motion(Columns<D> const& particles, BoxNumbers<D> const& box, std::uint32_t solvent, MotionSums<D>& sums,
            std::size_t begin, std::size_t end) {
    constexpr int lanes = 8;
    using Real = Pack<double, lanes>;
    Real flux[D][D], momentum[D], energy[2];
    for (int k = 0; k < D; ++k) {
        momentum[k] = Real(0.0);
        for (int l = 0; l < D; ++l) flux[k][l] = Real(0.0);
    }
    energy[0] = energy[1] = Real(0.0);
    Real const rate(box.shear_rate), half(0.5 * box.length[1]), one(1.0);
    auto const add = [&](Real y, Real inverse_mass, Real(&v)[D], Pack<std::int64_t, lanes>::Mask is_solvent,
                         Pack<std::int64_t, lanes>::Mask counts) {
        Real const mass = where<double, lanes>(counts, one / inverse_mass);
        v[0] = v[0] - rate * (y - half);
        Real square(0.0);
        for (int k = 0; k < D; ++k) {
            Real const flow = mass * v[k];
            momentum[k] += flow;
            square += flow * v[k];
            for (int l = k; l < D; ++l) flux[k][l] += flow * v[l];
        }
        energy[0] += where<double, lanes>(is_solvent, square);
        energy[1] += where<double, lanes>(~is_solvent, square);
    };
    Pack<std::int64_t, lanes> const first_constituent(static_cast<std::int64_t>(solvent));
    std::size_t i = begin;
    for (; i < end; i += lanes) {
        std::size_t const rest = end - i;
        Real y, inverse_mass, v[D];
        Words<lanes> id;
        if (rest >= lanes) {
            y = load<double, lanes>(particles.position[1] + i);
            inverse_mass = load<double, lanes>(particles.inverse_mass + i);
            for (int k = 0; k < D; ++k) v[k] = load<double, lanes>(particles.velocity[k] + i);
            id = load<std::uint32_t, lanes>(particles.id + i);
        } else {  // the last few: lanes that hold nothing weigh nothing
            y = inverse_mass = Real(1.0);
            id = Words<lanes>(0u);
            for (int k = 0; k < D; ++k) v[k] = Real(0.0);
            for (std::size_t lane = 0; lane < rest; ++lane) {
                y.lanes[lane] = particles.position[1][i + lane];
                inverse_mass.lanes[lane] = particles.inverse_mass[i + lane];
                id.lanes[lane] = particles.id[i + lane];
                for (int k = 0; k < D; ++k) v[k].lanes[lane] = particles.velocity[k][i + lane];
            }
        }
        auto const counts = counting<std::int64_t, lanes>() <
                            Pack<std::int64_t, lanes>(static_cast<std::int64_t>(rest < lanes ? rest : lanes));
        add(y, inverse_mass, v, converted<std::int64_t>(id) < first_constituent, counts);
    }
    for (int k = 0; k < D; ++k) {
        sums.momentum[k] = sum(momentum[k]);
        for (int l = k; l < D; ++l) sums.flux[k][l] = sums.flux[l][k] = sum(flux[k][l]);
    }
    sums.solvent = sum(energy[0]);
    sums.constituents = sum(energy[1]);
}

// A number in [0, 1) as the nearest multiple of 2^-32 below 1: after adding 2^52 the last bit of a double counts ones.
TETHER_DEVICE inline std::uint32_t fraction_bits(double fraction) {
    double const units = fraction * 4294967296.0, most = 4294967295.0;
    return static_cast<std::uint32_t>(
        __builtin_bit_cast(std::uint64_t, (units < most ? units : most) + 4503599627370496.0));
}

// Records, rows and bins of particles for the pair loop.
template <int D, class Real>
void record(RecordArguments<D> const& a, std::size_t begin, std::size_t end) {
    constexpr std::size_t most = 256;  // particles at a time: they stay in the nearest cache between the loops
    constexpr bool is_mixed = sizeof(Real) == 4;
    for (; begin < end; begin += most) {
        std::size_t const count = end - begin < most ? end - begin : most;
        std::uint32_t word[most];
        std::uint32_t const* const id = a.particles.id + begin;
        for (std::size_t i = 0; i < count; ++i) word[i] = particle_word(a.key, id[i]);

        auto const place = [&](int axis, std::uint32_t most_place, std::size_t i) {
            auto const number =
                static_cast<std::int32_t>(a.particles.position[axis][begin + i] * a.rows.per_length[axis]);
            auto const found = static_cast<std::uint32_t>(number);
            return found < most_place ? found : most_place;
        };
        std::uint32_t* const row = a.row + begin;
        std::uint32_t* const bin = a.bin + begin;
        auto const rows_y = static_cast<std::uint32_t>(a.rows.count[0]);
        for (std::size_t i = 0; i < count; ++i) {
            bin[i] = place(0, static_cast<std::uint32_t>(a.rows.bins) - 1, i);
            row[i] = place(1, rows_y - 1, i);
            if constexpr (D == 3) row[i] += rows_y * place(2, static_cast<std::uint32_t>(a.rows.count[1]) - 1, i);
        }

        Record<Real>* const records = static_cast<Record<Real>*>(a.records) + begin;
        double const* const inverse_mass = a.particles.inverse_mass + begin;
        for (int k = 0; k < D; ++k) {
            double const* const r = a.particles.position[k] + begin;
            double const* const v = a.particles.velocity[k] + begin;
            double const* const f = a.particles.force[k] + begin;
            double const per_length = 1.0 / a.box.length[k];
            for (std::size_t i = 0; i < count; ++i) {
                if constexpr (is_mixed)
                    records[i].position[k] = fraction_bits(r[i] * per_length);
                else
                    records[i].position[k] = r[i];
                records[i].velocity[k] = static_cast<Real>(v[i] + (a.prediction * inverse_mass[i]) * f[i]);
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            if constexpr (is_mixed)
                records[i].minus_word = -word[i];
            else
                records[i].minus_word = -static_cast<double>(word[i]);
            records[i].minus_species = a.species ? -static_cast<Real>(a.species[id[i]]) : Real(0);
            if constexpr (D == 2) {
                records[i].position[2] = 0;
                records[i].velocity[2] = 0;
            }
        }
    }
}

// The loops over single particles, without those of a pair loop.
template <int D>
Kernels<D> motion_table() {
    return {kick<D>, drift<D>, wrap<D>, runaway<D>, motion<D>, {}, {}};
}

}  // namespace
}  // namespace tether
