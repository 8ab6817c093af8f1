// The loops that are compiled once for each instruction set, and chosen when the program runs.
//
// They see bare arrays: no class of the core, whose inline functions would then exist once for each instruction set and
// be mixed up by the linker.  What they compute has the same bits on every one of them: each operation is rounded as
// IEEE 754 has it, none is contracted, forces are summed as integers, and sums of floating-point numbers run over a
// number of lanes that does not depend on the processor.
#pragma once

#include <cstddef>
#include <cstdint>

#include "noise.hpp"

namespace tether {

enum class NoiseKind { uniform, gaussian };
enum class Precision { mixed, full };

// Particles in the order that they have in memory ("places"): a column for each axis.
template <int D>
struct Columns {
    double *position[D], *velocity[D];
    double const* force[D];
    double const* inverse_mass;
    std::uint32_t const* id;
};

// The sheared box, as box.hpp defines it.
template <int D>
struct BoxNumbers {
    double length[D];
    double shear_rate, offset, velocity_difference;
};

// All that the pair loop knows of a particle, in two quads such that all that it asks of a pair is their difference (the
// noise takes the sum of the words, so the difference is taken from one particle's word to minus the other's; likewise the
// species, which tell a pair's place in the table of laws, if there is more than one):
//     in mixed precision   positions as fractions of the box in units of 2^-32, whose differences wrap around on their
//                          own; velocities in float
//     in full precision    all in double
template <class Real>
struct Record;
template <>
struct alignas(32) Record<float> {
    std::uint32_t position[3], minus_word;
    float velocity[3], minus_species;
};
template <>
struct alignas(64) Record<double> {
    double position[3], minus_word;
    double velocity[3], minus_species;
};

// A force as integer multiples of a quantum, so that its sum does not depend on the order of its parts and the two sides
// of a pair cancel exactly.
template <class Real>
struct QuantaOf;
template <>
struct QuantaOf<float> {
    using type = std::int32_t;
};
template <>
struct QuantaOf<double> {
    using type = std::int64_t;
};
template <class Real>
struct alignas(4 * sizeof(Real)) Quanta {
    typename QuantaOf<Real>::type axis[4];
};

// How the box is cut into rows of bins: rows along x at (y, z), each cut into bins along x.  A row goes on beyond its end
// with copies of its first bins, seen one period of x further, so that all that is near a particle stands in one stretch.
template <int D>
struct Rows {
    std::int32_t count[2];  // rows along y, and along z (1 in 2D)
    std::int32_t bins;
    std::int32_t reach;    // bins that a cutoff reaches beyond one's own
    double per_length[D];  // bins along x, rows along y and z, in one unit of length

    std::int32_t copied_bins() const { return 2 * reach + 3; }
    std::size_t bin_starts() const { return static_cast<std::size_t>(bins + copied_bins()) + 1; }  // of a row
};

template <int D>
struct RecordArguments {
    Columns<D> particles;
    BoxNumbers<D> box;
    Rows<D> rows;
    StepKey key;
    double prediction;            // the predicted velocity is v + prediction F/m
    std::uint8_t const* species;  // by id; null where all pairs have one law
    void* records;                // Record<Real>, by place
    std::uint32_t *row, *bin;     // by place
};

enum class LawKind { half_power, square_power, any_power };
constexpr int law_kinds = 3;

// The parameters of a pair of species: a or a_e (force), gamma, sigma/sqrt(dt), the pair's own cutoff (length), and the
// steepness b of the conservative force, 0 for a linear one.
struct PairNumbers {
    double repulsion, friction, noise_amplitude, cutoff, steepness;
};

// A law as the pair loop takes it.
struct LawArguments {
    PairNumbers uniform;    // of all pairs; of a table, only the cutoff counts, and it is the largest
    void const* table;      // SteepParameters<Real>, species by species, or null
    std::uint32_t species;  // in the table
    double half_exponent;
    NoiseKind noise_kind;
};

// Sums over pairs of (force magnitude / distance) times the independent components of r_ij r_ij: conservative,
// dissipative, random.
template <int D>
constexpr int virial_values = 3 * D * (D + 1) / 2;

template <int D>
struct PairArguments {
    BoxNumbers<D> box;
    Rows<D> rows;
    LawArguments law;
    double quantum;           // of force
    std::uint32_t particles;  // below 2^27
    // In the order of (row, bin), followed by `padding` more that nothing is asked of
    void const* records;             // Record<Real>
    void* forces;                    // Quanta<Real>, added to
    std::uint32_t const* bin;        // along x
    std::uint32_t const* row_start;  // of each row, and one more
    // Entries: what particles are sifted by.  The first of a row is at twice its row_start.
    float const* near[D];            // position
    std::uint32_t const* other;      // place in the order above, times sizeof(Quanta<Real>)
    std::uint32_t const* bin_start;  // where each bin of a row begins, rows.bin_starts() numbers for each row
};
constexpr std::size_t padding = 16;

// Sums of one block of particles; the velocity V is that against the imposed flow.
template <int D>
struct MotionSums {
    double flux[D][D];             // sum m V V
    double momentum[D];            // sum m V
    double solvent, constituents;  // sum m V^2 over each
};

// Ranges [begin, end) of places; of rows for `pairs`.
template <int D>
struct Kernels {
    // v += time F/m
    void (*kick)(Columns<D> const&, double time, std::size_t begin, std::size_t end);
    // r += time v
    void (*drift)(Columns<D> const&, double time, std::size_t begin, std::size_t end);
    // Put particles back into the box, with the velocities of the images that they become.
    void (*wrap)(Columns<D> const&, BoxNumbers<D> const&, std::size_t begin, std::size_t end);
    // Whether one is not finite or moves faster than `speed` against the imposed flow.
    bool (*runaway)(Columns<D> const&, BoxNumbers<D> const&, double speed, std::size_t begin, std::size_t end);
    void (*motion)(Columns<D> const&, BoxNumbers<D> const&, std::uint32_t solvent, MotionSums<D>&, std::size_t begin,
                   std::size_t end);
    // [precision]
    void (*record[2])(RecordArguments<D> const&, std::size_t begin, std::size_t end);
    // [precision][whether laws come from a table by species][law][whether the virials are wanted: virial_values<D> for
    // each row]
    void (*pairs[2][2][law_kinds][2])(PairArguments<D> const&, std::size_t begin, std::size_t end, double* virials);
};

}  // namespace tether
