// The pair loop on packs.  Included by files that are each compiled for one instruction set.
//
// A row of particles is worked on in three sweeps:
//   sift      each particle's candidates, those of the bins in its reach, are compared with the cutoff a pack at a time,
//             and the near ones are written to a list of pairs;
//   evaluate  the law works on packs of listed pairs.  Few candidates are near, some one in six, so that the costly part
//             (noise, law, stress) always has full packs.  The force on the second particle of each pair is added to what
//             that particle has, and to a running total;
//   collect   what the running total gained over a particle's pairs is its own force, with the opposite sign.  Being
//             integers, totals and differences are exact.
// Sifting is in float with a margin above its rounding; what is near is decided anew, and exactly, when it is evaluated.
#pragma once

#include <type_traits>

#include "kernels/kernels.hpp"
#include "laws/steep.hpp"
#include "simd/pack.hpp"

namespace tether {

// Gaussian noise of a pack, one lane after the other.
template <class Real, int N>
TETHER_DEVICE inline Real gaussian(Words<N> for_radius, Words<N> for_angle) {
    Real noise;
    for (int k = 0; k < N; ++k) noise.lanes[k] = gaussian<double>(for_radius.lanes[k], for_angle.lanes[k]);
    return noise;
}

template <class Real, int N>
TETHER_DEVICE inline Real signed_value(Words<N> word) {
    return {__builtin_convertvector(same_bits<std::int32_t>(word).lanes, decltype(Real::lanes))};
}

namespace {

template <class Real>
constexpr int law_lanes = register_bytes / sizeof(Real) > 4 ? register_bytes / sizeof(Real) : 4;
constexpr int sift_lanes = register_bytes / 4;

// A row that another row is charged with, as that one sees it.
template <int D>
struct NeighborRow {
    std::uint32_t const* bin_start;
    float shift[D];      // to the image that is seen
    double displaced;    // its offset, in bins
    std::int32_t image;  // -1, 0, 1: below the sheared boundary, in the box, above it

    NeighborRow() = default;
    NeighborRow(PairArguments<D> const& a, std::int32_t y, std::int32_t z) : shift{} {
        if constexpr (D == 3)
            if (z == a.rows.count[1]) {
                z = 0;
                shift[2] = static_cast<float>(a.box.length[2]);
            }
        std::int32_t const beyond = y < 0 ? -1 : y >= a.rows.count[0] ? 1 : 0;
        y -= beyond * a.rows.count[0];
        shift[0] = static_cast<float>(beyond * a.box.offset);
        shift[1] = static_cast<float>(beyond * a.box.length[1]);
        displaced = beyond * a.box.offset * a.rows.per_length[0];
        // Without shear what is beyond the boundary is an image like any other.
        image = a.box.offset == 0.0 && a.box.velocity_difference == 0.0 ? 0 : beyond;
        bin_start = a.bin_start + static_cast<std::size_t>(y + a.rows.count[0] * z) * a.rows.bin_starts();
    }

    bool is_displaced() const {
        bool any = false;
        for (float s : shift) any |= s != 0.0f;
        return any;
    }
};

template <class Law>
constexpr bool is_by_species = false;
template <class Weight>
constexpr bool is_by_species<SteepDpd<Weight>> = true;

template <int D, class Real, class Law, bool Stress>
class PairSweeps {
    static constexpr int lanes = law_lanes<Real>;
    static constexpr int components = D * (D + 1) / 2;
    static constexpr int sets = 64 / static_cast<int>(sizeof(Real)) / lanes;  // of lanes that virials are summed in
    static constexpr bool is_mixed = sizeof(Real) == 4;
    static constexpr bool by_species = is_by_species<Law>;
    using Reals = Pack<Real, lanes>;
    using Integer = typename QuantaOf<Real>::type;
    using Integers = Pack<Integer, lanes>;
    using Floats = Pack<float, sift_lanes>;
    using Mask = typename Reals::Mask;
    static constexpr std::uint32_t stride = sizeof(Quanta<Real>);  // the list has places times this

  public:
    PairSweeps(PairArguments<D> const& a, Law const& law) : a_(a), law_(law) {
        // The rounding of float coordinates, which count from the box's corner.
        double largest = a.law.uniform.cutoff;
        for (double side : a.box.length) largest = largest > side ? largest : side;
        double const reach = a.law.uniform.cutoff * (1.0 + 1e-6) + 4e-7 * largest;
        sift_square_ = static_cast<float>(reach * reach);
        offset_fraction_ =
            static_cast<std::uint32_t>(static_cast<std::int64_t>(a.box.offset / a.box.length[0] * 4294967296.0));
        prefix_[0] = {};
    }

    void work(std::size_t row, double* virial) {
        if constexpr (Stress) clear();
        auto const y = static_cast<std::int32_t>(row) % a_.rows.count[0],
                   z = static_cast<std::int32_t>(row) / a_.rows.count[0];
        images_ = others_ = 0;
        bool is_displaced = false;
        auto const add = [&](std::int32_t at_y, std::int32_t at_z) {
            NeighborRow<D> const neighbor(a_, at_y, at_z);
            is_displaced |= neighbor.is_displaced();
            (neighbor.image == 0 ? other_row_[others_++] : image_row_[images_++]) = neighbor;
        };
        add(y + 1, z);
        if constexpr (D == 3)
            for (std::int32_t up = -1; up <= 1; ++up) add(y + up, z + 1);
        is_displaced |= images_ > 0;
        is_displaced ? sift_row<true>(row) : sift_row<false>(row);
        flush();
        if constexpr (Stress) reduce(virial);
    }

  private:
    static constexpr int most_rows = D == 3 ? 4 : 1;

    // --- sift ---

    template <bool Displaced>
    void sift_row(std::size_t row) {
        std::uint32_t const* const own_start = a_.bin_start + row * a_.rows.bin_starts();
        std::int32_t const bins = a_.rows.bins, reach = a_.rows.reach;
        float const width = static_cast<float>(a_.box.length[0]);
        Entries const entries(a_, sift_square_);
        std::uint32_t const first = a_.row_start[row], last = a_.row_start[row + 1];
        for (std::uint32_t place = first; place < last; ++place) {
            begin_task(place, 0);
            std::uint32_t const entry = first + place;
            auto const bin = static_cast<std::int32_t>(a_.bin[place]);
            std::uint32_t* listed = other_ + listed_;
            Floats at[D];
            for (int k = 0; k < D; ++k) at[k] = Floats(entries.near[k][entry]);
            listed = sift(entries, listed, at, entry + 1, own_start[bin + reach + 1]);
            std::int32_t const low = bin - reach;
            std::int32_t const begin_bin = low < 0 ? low + bins : low, end_bin = begin_bin + 2 * reach + 1;
            at[0] = Floats(entries.near[0][entry] + (low < 0 ? width : 0.0f));
            int const rows = Displaced ? others_ : most_rows;
            for (int r = 0; r < rows; ++r) {
                NeighborRow<D> const& other = other_row_[r];
                Floats seen[D];
                for (int k = 0; k < D; ++k) seen[k] = Displaced ? at[k] - Floats(other.shift[k]) : at[k];
                listed = sift(entries, listed, seen, other.bin_start[begin_bin], other.bin_start[end_bin]);
            }
            listed_ = static_cast<std::uint32_t>(listed - other_);
            end_task();
            if (Displaced && images_ > 0) sift_images(place, entry, bin);
        }
    }

    // What is seen through the sheared boundary, a task for each kind of image.
    [[gnu::noinline]] void sift_images(std::uint32_t place, std::uint32_t entry, std::int32_t bin) {
        std::int32_t const bins = a_.rows.bins, reach = a_.rows.reach;
        Entries const entries(a_, sift_square_);
        for (int image : {-1, 1}) {
            begin_task(place, image);
            std::uint32_t* listed = other_ + listed_;
            for (int r = 0; r < images_; ++r) {
                NeighborRow<D> const& row = image_row_[r];
                if (row.image != image) continue;
                constexpr double rounding = 1e-9;
                auto low = static_cast<std::int32_t>(__builtin_floor(bin - row.displaced - reach - rounding));
                float shift = row.shift[0];
                for (; low < 0; low += bins) shift -= static_cast<float>(a_.box.length[0]);
                for (; low >= bins; low -= bins) shift += static_cast<float>(a_.box.length[0]);
                Floats at[D];
                for (int k = 0; k < D; ++k) at[k] = Floats(entries.near[k][entry] - (k == 0 ? shift : row.shift[k]));
                listed = sift(entries, listed, at, row.bin_start[low], row.bin_start[low + 2 * reach + 2]);
            }
            listed_ = static_cast<std::uint32_t>(listed - other_);
            end_task();
        }
    }

    // What is sifted, in a place of its own: the compiler need not fear that writing the list changes it.
    struct Entries {
        float const* near[D];
        std::uint32_t const* other;
        Floats most;
        Entries(PairArguments<D> const& a, float most_) : other(a.other), most(most_) {
            for (int k = 0; k < D; ++k) near[k] = a.near[k];
        }
    };

    // List those of the entries [begin, end) that are near; return the end of the list.  Nearly always there are at most
    // sixteen, which are looked at without a branch that would have to be foreseen.
    TETHER_DEVICE std::uint32_t* sift(Entries const& entries, std::uint32_t* listed, Floats const (&at)[D],
                                      std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t done = 0; done < 16; done += sift_lanes)
            listed =
                list_near(entries, listed, at, begin + done, done == 0 || end - begin > done ? end - begin - done : 0);
        if (end - begin > 16) [[unlikely]] {
            for (std::uint32_t done = 16; done < 32; done += sift_lanes)
                listed = list_near(entries, listed, at, begin + done, end - begin > done ? end - begin - done : 0);
            if (end - begin > 32) [[unlikely]]
                listed = sift_more(listed, at, begin + 32, end);
        }
        return listed;
    }

    [[gnu::noinline]] std::uint32_t* sift_more(std::uint32_t* listed, Floats const (&at)[D], std::uint32_t begin,
                                               std::uint32_t end) {
        Entries const entries(a_, sift_square_);
        for (; begin < end; begin += 16) {
            if (listed - other_ > enough_listed + 256) listed = spill(listed);
            for (std::uint32_t done = 0; done < 16 && begin + done < end; done += sift_lanes)
                listed = list_near(entries, listed, at, begin + done, end - begin - done);
        }
        return listed;
    }

    TETHER_DEVICE static std::uint32_t* list_near(Entries const& entries, std::uint32_t* listed, Floats const (&at)[D],
                                                  std::uint32_t begin, std::uint32_t count) {
        Floats square;
        for (int k = 0; k < D; ++k) {
            Floats const d = at[k] - load<float, sift_lanes>(entries.near[k] + begin);
            square = k == 0 ? d * d : square + d * d;
        }
        std::uint32_t const near = lanes_below(square, entries.most) & first_lanes<sift_lanes>(count);
        store_lanes(listed, near, load<std::uint32_t, sift_lanes>(entries.other + begin));
        return listed + __builtin_popcount(near);
    }

    void begin_task(std::uint32_t place, std::int32_t image) {
        if (listed_ > enough_listed || tasks_ == most_tasks) flush();
        place_[tasks_] = place;
        image_[tasks_] = image;
    }

    void end_task() {
        std::uint32_t const begin = begin_[tasks_];
        if (listed_ == begin) return;
        Record<Real>& own = own_[tasks_];
        __builtin_memcpy(&own, static_cast<Record<Real> const*>(a_.records) + place_[tasks_], sizeof own);
        own.minus_word = -own.minus_word;
        if constexpr (by_species) own.minus_species *= -static_cast<Real>(a_.law.species);
        std::int32_t const image = image_[tasks_];
        if (image != 0) [[unlikely]] {
            if constexpr (is_mixed)
                own.position[0] -= offset_fraction_ * static_cast<std::uint32_t>(image);
            else
                own.position[0] -= a_.box.offset * image;
            own.velocity[0] -= static_cast<Real>(image * a_.box.velocity_difference);
        }
        Words<sift_lanes> const task(tasks_ * static_cast<std::uint32_t>(sizeof own));
        for (std::uint32_t h = 0; h < 16; h += sift_lanes) store(task_of_ + begin + h, task);
        if (listed_ - begin > 16) [[unlikely]]
            for (std::uint32_t h = begin + 16; h < listed_; h += sift_lanes) store(task_of_ + h, task);
        begin_[++tasks_] = listed_;
    }

    // A crowd: do what has been found so far, and go on with the same particle.
    [[gnu::noinline]] std::uint32_t* spill(std::uint32_t* listed) {
        listed_ = static_cast<std::uint32_t>(listed - other_);
        std::uint32_t const place = place_[tasks_];
        std::int32_t const image = image_[tasks_];
        end_task();
        flush();
        begin_task(place, image);
        return other_;
    }

    // --- evaluate and collect ---

    [[gnu::noinline]] void flush() {
        if (tasks_ == 0) return;
        // Fill up the last pack with pairs that no sum counts.
        for (std::uint32_t k = 0; k < padding; ++k) {
            other_[listed_ + k] = (a_.particles + k) * stride;
            task_of_[listed_ + k] = 0;
        }
        evaluate();
        auto* const forces = static_cast<Quanta<Real>*>(a_.forces);
        for (std::uint32_t t = 0; t < tasks_; ++t) {
            Integer* const force = forces[place_[t]].axis;
            auto const gained =
                load<Integer, 4>(prefix_[begin_[t + 1]].axis) - load<Integer, 4>(prefix_[begin_[t]].axis);
            store(force, load<Integer, 4>(force) - gained);
        }
        tasks_ = listed_ = 0;
    }

    void evaluate() {
        Law const law = law_;
        PairNumbers const& uniform = a_.law.uniform;
        DpdParameters<Reals> const of_all{Reals(uniform.repulsion), Reals(uniform.friction),
                                          Reals(uniform.noise_amplitude), Reals(1.0 / uniform.cutoff)};
        Reals cutoff(uniform.cutoff);
        Reals const per_quantum(-1.0 / a_.quantum);
        Reals unit[D], per_side[D];
        for (int k = 0; k < D; ++k) {
            unit[k] = Reals(is_mixed ? a_.box.length[k] / 4294967296.0 : a_.box.length[k]);
            per_side[k] = Reals(1.0 / a_.box.length[k]);
        }
        bool const is_uniform = a_.law.noise_kind == NoiseKind::uniform;
        auto const* const records = static_cast<char const*>(a_.records);
        auto* const forces = static_cast<char*>(a_.forces);
        std::uint32_t const listed = listed_;
        Pack<Integer, 4> running = load<Integer, 4>(prefix_[0].axis);
        for (std::uint32_t begin = 0; begin < listed; begin += lanes) {
            // The difference of each pair's records
            Quads<Integer, lanes> place;
            Quads<Real, lanes> motion;
            for (std::size_t k = 0; k < 4; ++k) {
                char const *own[lanes / 4], *other[lanes / 4];
                for (std::size_t b = 0; b < lanes / 4; ++b) {
                    own[b] = reinterpret_cast<char const*>(own_) + task_of_[begin + 4 * b + k];
                    other[b] = records + 2 * std::size_t{other_[begin + 4 * b + k]};
                }
                if constexpr (is_mixed)
                    place.of[k] = gather_quads<Integer, lanes>(own) - gather_quads<Integer, lanes>(other);
                else
                    place.of[k] = same_bits<Integer>(gather_quads<Real, lanes>(own) - gather_quads<Real, lanes>(other));
                for (std::size_t b = 0; b < lanes / 4; ++b) own[b] += 4 * sizeof(Real), other[b] += 4 * sizeof(Real);
                motion.of[k] = gather_quads<Real, lanes>(own) - gather_quads<Real, lanes>(other);
            }
            place = transposed(place);
            motion = transposed(motion);

            // Separation r_i - r_j of nearest images, distance, e . v
            Reals separation[D];
            for (int k = 0; k < D; ++k) {
                if constexpr (is_mixed) {
                    separation[k] = converted<Real>(place.of[k]) * unit[k];
                } else {
                    Reals const magic(6755399441055744.0);  // adding it rounds to an integer
                    Reals const difference = same_bits<Real>(place.of[k]);
                    separation[k] = difference - ((difference * per_side[k] + magic) - magic) * unit[k];
                }
            }
            Reals square = separation[0] * separation[0], departure = separation[0] * motion.of[0];
            for (int k = 1; k < D; ++k) {
                square += separation[k] * separation[k];
                departure += separation[k] * motion.of[k];
            }
            constexpr Real tiny = is_mixed ? 1e-30f : 1e-150;  // two particles on one point push nowhere
            Reals const distance = square_root(square);
            Reals const inverse = Reals(1.0) / larger(distance, Reals(tiny));

            PairBits<Words<lanes>> const bits = pair_bits(words_of(place.of[3]));
            Reals const noise = is_uniform ? UniformNoise::draw<Reals>(bits) : GaussianNoise::draw<Reals>(bits);
            Pair<Reals> const pair{distance, departure * inverse, noise};
            PairForce<Reals> magnitude;
            if constexpr (by_species) {
                SteepParameters<Reals> const of_pairs = parameters_of(motion.of[3]);
                cutoff = of_pairs.cutoff;
                magnitude = law(pair, of_pairs);
            } else {
                magnitude = law(pair, of_all);
            }

            Mask const counts = (distance < cutoff) & (counting<Integer, lanes>() < Integers(listed - begin));
            Reals const scale = where<Real, lanes>(counts, magnitude.total() * inverse * per_quantum);
            Quads<Integer, lanes> push;  // on j
            for (int k = 0; k < D; ++k) push.of[k] = rounded(scale * separation[k]);
            for (int k = D; k < 4; ++k) push.of[k] = Integers(0);
            push = transposed(push);
            auto const add = [&](std::size_t b, std::size_t k) {
                std::size_t const h = begin + 4 * b + k;
                Pack<Integer, 4> const quad = quad_of(push.of[k], static_cast<int>(b));
                auto* const force = reinterpret_cast<Integer*>(forces + other_[h]);
                store(force, load<Integer, 4>(force) + quad);
                running += quad;
                store(prefix_[h + 1].axis, running);
            };
            if (begin + lanes <= listed)
                for (std::size_t b = 0; b < lanes / 4; ++b)
                    for (std::size_t k = 0; k < 4; ++k) add(b, k);
            else  // what fills up the last pack is nobody's: another thread may be at it too
                for (std::size_t lane = 0; lane < listed - begin; ++lane) add(lane / 4, lane % 4);
            if constexpr (Stress)
                add_virial(separation, magnitude, where<Real, lanes>(counts, inverse), counts, (begin / lanes) % sets);
        }
    }

    // Of each pair, by its place in the table.
    SteepParameters<Reals> parameters_of(Reals place) const {
        auto const* const table = static_cast<SteepParameters<Real> const*>(a_.law.table);
        constexpr std::size_t fields = sizeof(SteepParameters<Real>) / sizeof(Real);
        Reals gathered[fields];
        for (int lane = 0; lane < lanes; ++lane) {
            Real of_pair[fields];
            __builtin_memcpy(of_pair, table + static_cast<std::int32_t>(place.lanes[lane]), sizeof of_pair);
            for (std::size_t f = 0; f < fields; ++f) gathered[f].lanes[lane] = of_pair[f];
        }
        return {{gathered[0], gathered[1], gathered[2], gathered[3]}, gathered[4], gathered[5], gathered[6]};
    }

    // The sum of a pair's noise words, from the difference of its records.
    static Words<lanes> words_of(Integers difference) {
        if constexpr (is_mixed) {
            return same_bits<std::uint32_t>(difference);
        } else {
            Reals const magic(4503599627370496.0);  // 2^52: the last bit counts ones
            return converted<std::uint32_t>(same_bits<std::uint64_t>(same_bits<Real>(difference) + magic));
        }
    }

    // --- virials: summed in as many lanes on every processor ---

    void clear() {
        for (auto& set : virial_)
            for (auto& term : set)
                for (auto& sum : term) sum = Reals(0.0);
    }

    TETHER_DEVICE void add_virial(Reals const (&separation)[D], PairForce<Reals> const& magnitude, Reals inverse,
                                  Mask counts, std::uint32_t set) {
        Reals const conservative = where<Real, lanes>(counts, magnitude.conservative * inverse);
        Reals const dissipative = where<Real, lanes>(counts, magnitude.dissipative * inverse);
        Reals const random = where<Real, lanes>(counts, magnitude.random * inverse);
        int c = 0;
        for (int k = 0; k < D; ++k)
            for (int l = k; l < D; ++l, ++c) {
                Reals const product = separation[k] * separation[l];
                virial_[set][0][c] += conservative * product;
                virial_[set][1][c] += dissipative * product;
                virial_[set][2][c] += random * product;
            }
    }

    void reduce(double* out) const {
        for (int t = 0; t < 3; ++t)
            for (int c = 0; c < components; ++c) {
                Pack<Real, sets * lanes> all;
                for (int s = 0; s < sets; ++s)
                    for (int k = 0; k < lanes; ++k) all.lanes[s * lanes + k] = virial_[s][t][c].lanes[k];
                *out++ = static_cast<double>(sum(all));
            }
    }

    static constexpr std::uint32_t enough_listed = 448, most_tasks = 256;
    static constexpr std::uint32_t most_listed = enough_listed + 512;

    PairArguments<D> const& a_;
    Law const& law_;
    NeighborRow<D> other_row_[most_rows], image_row_[most_rows];
    int images_, others_;
    std::uint32_t offset_fraction_;
    float sift_square_;
    std::uint32_t tasks_ = 0, listed_ = 0;
    // Tasks: a particle and one image of its partners
    std::uint32_t place_[most_tasks + 1];
    std::int32_t image_[most_tasks + 1];
    std::uint32_t begin_[most_tasks + 2] = {};  // of its pairs in the list
    Record<Real> own_[most_tasks + 1];
    // Pairs
    alignas(64) std::uint32_t other_[most_listed + 4 * padding];    // place of the second particle, times `stride`
    alignas(64) std::uint32_t task_of_[most_listed + 4 * padding];  // task of the first, in bytes
    // Running total of the forces on the second particles, before each pair
    alignas(64) Quanta<Real> prefix_[most_listed + 4 * padding];
    Reals virial_[Stress ? sets : 1][3][components];
};

template <int D, class Real, class Law, bool Stress>
void pairs(PairArguments<D> const& a, std::size_t begin, std::size_t end, double* virials) {
    Law law{};
    if constexpr (std::is_same_v<decltype(law.weight), AnyPower>) law.weight.half_exponent = a.law.half_exponent;
    PairSweeps<D, Real, Law, Stress> sweeps(a, law);
    for (std::size_t r = begin; r < end; ++r)
        sweeps.work(r, Stress ? virials + (r - begin) * virial_values<D> : nullptr);
}

}  // namespace
}  // namespace tether
