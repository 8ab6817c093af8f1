// Packs against the same thing one lane at a time, in every bit: the law, the weights and the noise that every engine
// shares, and the operations that simd/pack.hpp names with the processor's own instructions.
//
// Prints the name of each check that found a difference, or "the same".  With -DSPOILED every check is given expectations
// whose last lane is wrong in its last bit, and must notice.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <type_traits>

#include "kernels/pairs.hpp"

using namespace tether;

namespace {

char const* wrong[64];
int wrongs = 0;

void accuse(char const* check) {
    for (int k = 0; k < wrongs; ++k)
        if (wrong[k] == check) return;
    wrong[wrongs++] = check;
}

// Whether each lane is what it should be, all bits.
template <class T, int N>
void compare(char const* check, Pack<T, N> got, T const (&lane)[N]) {
    T expected[N];
    std::memcpy(expected, lane, sizeof expected);
#if defined(SPOILED)
    reinterpret_cast<unsigned char*>(&expected[N - 1])[0] ^= 1;
#endif
    if (std::memcmp(&got.lanes, expected, sizeof expected) != 0) accuse(check);
}

void compare(char const* check, std::uint32_t got, std::uint32_t expected) {
#if defined(SPOILED)
    expected ^= 1;
#endif
    if (got != expected) accuse(check);
}

// Numbers that differ from call to call and lane to lane.
std::uint32_t word() {
    static StepKey const key = step_key(7, 11, Stream::run);
    static std::uint32_t drawn = 0;
    return particle_word(key, drawn++);
}

template <class Real>
Real between(double low, double high) {
    return static_cast<Real>(low + (high - low) * (word() / 4294967296.0));
}

template <class T, int N, class Draw>
Pack<T, N> filled(Draw draw) {
    T lane[N];
    for (T& each : lane) each = static_cast<T>(draw());
    return load<T, N>(lane);
}

// --- law, weights and noise ---

template <class Real, class Noise, class Weight>
void law(char const* check, Weight weight) {
    constexpr int N = law_lanes<Real>;
    using Reals = Pack<Real, N>;
    auto const distance = filled<Real, N>([] { return between<Real>(0.0, 1.3); });
    auto const departure = filled<Real, N>([] { return between<Real>(-10.0, 10.0); });
    auto const words = filled<std::uint32_t, N>(word);
    Dpd<Weight> const dpd{weight};
    DpdParameters<Reals> const packed{Reals(18.75), Reals(4.5), Reals(42.0), Reals(1.0 / 1.3)};
    DpdParameters<Real> const single{Real(18.75), Real(4.5), Real(42.0), Real(1.0 / 1.3)};
    PairForce<Reals> const got =
        dpd(Pair<Reals>{distance, departure, Noise::template draw<Reals>(pair_bits(words))}, packed);
    Real conservative[N], dissipative[N], random[N], total[N];
    for (int k = 0; k < N; ++k) {
        Real const noise = Noise::template draw<Real>(pair_bits(std::uint32_t{words.lanes[k]}));
        PairForce<Real> const alone = dpd(Pair<Real>{distance.lanes[k], departure.lanes[k], noise}, single);
        conservative[k] = alone.conservative;
        dissipative[k] = alone.dissipative;
        random[k] = alone.random;
        total[k] = alone.total();
    }
    compare(check, got.conservative, conservative);
    compare(check, got.dissipative, dissipative);
    compare(check, got.random, random);
    compare(check, got.total(), total);
}

template <class Real>
void laws() {
    law<Real, UniformNoise>("half power", HalfPower{});
    law<Real, UniformNoise>("square power", SquarePower{});
    law<Real, UniformNoise>("any power", AnyPower{0.35});
    law<Real, GaussianNoise>("gaussian noise", HalfPower{});
}

void bits() {
    constexpr int N = law_lanes<float>;
    auto const words = filled<std::uint32_t, N>(word);
    PairBits<Words<N>> const got = pair_bits(words);
    std::uint32_t first[N], second[N];
    for (int k = 0; k < N; ++k) {
        auto const alone = pair_bits(std::uint32_t{words.lanes[k]});
        first[k] = alone.first;
        second[k] = alone.second;
    }
    compare("words of noise", got.first, first);
    compare("words of noise", got.second, second);
}

// --- operations ---

template <class Real>
void arithmetic() {
    constexpr int N = law_lanes<Real>;
    auto const a =
        filled<Real, N>([] { return std::ldexp(between<Real>(0.5, 1.0), static_cast<int>(word() % 200) - 100); });
    auto const b = filled<Real, N>([] { return between<Real>(-2.0, 2.0); });
    Real root[N], most[N], bigger[N];
    for (int k = 0; k < N; ++k) {
        root[k] = std::sqrt(a.lanes[k]);
        most[k] = a.lanes[k] > b.lanes[k] ? a.lanes[k] : b.lanes[k];
        bigger[k] = a.lanes[k] < b.lanes[k] ? b.lanes[k] : Real(0);
    }
    compare("square root", square_root(a), root);
    compare("larger", larger(a, b), most);
    compare("where", where<Real, N>(a < b, b), bigger);
    Real special[N], special_root[N], nothing[N];
    for (int k = 0; k < N; ++k) {
        Real const values[] = {Real(0), std::numeric_limits<Real>::denorm_min(), std::numeric_limits<Real>::infinity(),
                               std::numeric_limits<Real>::max()};
        special[k] = values[k % 4];
        special_root[k] = std::sqrt(special[k]);
        nothing[k] = Real(0);
    }
    compare("square root", square_root(load<Real, N>(special)), special_root);
    // What the mask leaves out is 0, even where it is not a number
    Pack<Real, N> const no_number(std::numeric_limits<Real>::quiet_NaN());
    compare("where", where<Real, N>(no_number < no_number, no_number), nothing);
}

// A pack of one lane has the same operations in the same order.
template <class Real>
void exponentials() {
    constexpr int N = law_lanes<Real>;
    auto const check = [](Pack<Real, N> a) {
        Real alone[N], less[N];
        for (int k = 0; k < N; ++k) {
            alone[k] = exponential(Pack<Real, 1>(a.lanes[k])).lanes[0];
            less[k] = exponential_less_one(Pack<Real, 1>(a.lanes[k])).lanes[0];
        }
        compare("exponential", exponential(a), alone);
        compare("exponential less one", exponential_less_one(a), less);
    };
    check(filled<Real, N>([] { return between<Real>(-80.0, 0.0); }));
    check(filled<Real, N>([] { return -std::ldexp(between<Real>(0.5, 1.0), static_cast<int>(word() % 80) - 60); }));
}

template <class Real, class Integer>
void rounding(double most) {
    constexpr int N = law_lanes<Real>;
    auto const check = [](Pack<Real, N> a) {
        Integer nearest[N];
        for (int k = 0; k < N; ++k) nearest[k] = static_cast<Integer>(std::nearbyint(a.lanes[k]));
        compare("rounded", rounded(a), nearest);
    };
    for (double size : {1.0, 1e3, 1e6, most}) check(filled<Real, N>([=] { return between<Real>(-size, size); }));
    check(filled<Real, N>([] { return static_cast<int>(word() % 2001) - 1000 + 0.5; }));  // ties, to even
}

void comparisons() {
    constexpr int N = sift_lanes;
    float const special[] = {
        0.0f, -0.0f, 1.0f, std::numeric_limits<float>::quiet_NaN(), -1.0f, std::numeric_limits<float>::infinity()};
    for (int trial = 0; trial < 200; ++trial) {
        auto const pick = [&] { return word() % 2 ? special[word() % 6] : between<float>(-1.0, 1.0); };
        auto const a = filled<float, N>(pick), b = filled<float, N>(pick);
        std::uint32_t below = 0;
        for (int k = 0; k < N; ++k) below |= std::uint32_t{a.lanes[k] < b.lanes[k]} << k;
        compare("lanes below", lanes_below(a, b), below);
    }
    for (std::uint32_t count = 0; count < 3 * N; ++count) {
        std::uint32_t first = 0;
        for (std::uint32_t k = 0; k < N && k < count; ++k) first |= 1u << k;
        compare("first lanes", first_lanes<N>(count), first);
    }
    compare("first lanes", first_lanes<N>(4000000000u), (1u << N) - 1);
}

void storing() {
    constexpr int N = sift_lanes;
    for (std::uint32_t set = 0; set < 1u << N; ++set) {
        auto const from = filled<std::uint32_t, N>(word);
        std::uint32_t to[2 * N] = {}, in_front[N];
        store_lanes(to, set, from);
        int count = 0;
        for (int k = 0; k < N; ++k)
            if (set >> k & 1) in_front[count++] = from.lanes[k];
        for (int k = count; k < N; ++k) in_front[k] = to[k] = 0;  // anything may stand there
        compare("store lanes", load<std::uint32_t, N>(to), in_front);
    }
}

template <class T>
void quads() {
    constexpr int N = law_lanes<std::conditional_t<sizeof(T) == 4, float, double>>;
    Quads<T, N> in;
    for (auto& field : in.of) field = filled<T, N>(word);
    Quads<T, N> const out = transposed(in);
    for (int k = 0; k < 4; ++k) {
        T column[N];
        for (int b = 0; b < N / 4; ++b)
            for (int f = 0; f < 4; ++f) column[4 * b + f] = in.of[f].lanes[4 * b + k];
        compare("transposed", out.of[k], column);
    }
    T from[64], gathered[N];
    for (T& each : from) each = static_cast<T>(word());
    char const* quad[N / 4];
    for (int b = 0; b < N / 4; ++b) {
        std::uint32_t const place = word() % 60;
        quad[b] = reinterpret_cast<char const*>(from + place);
        for (std::uint32_t k = 0; k < 4; ++k) gathered[4 * b + static_cast<int>(k)] = from[place + k];
    }
    auto const all = gather_quads<T, N>(quad);
    compare("gather quads", all, gathered);
    for (int b = 0; b < N / 4; ++b) {
        T lane[4];
        for (int k = 0; k < 4; ++k) lane[k] = gathered[4 * b + k];
        compare("quad of", quad_of(all, b), lane);
    }
}

template <class Real, int N>
void sums() {
    auto const a = filled<Real, N>([] { return between<Real>(-1.0, 1.0); });
    Real half[N];
    std::memcpy(half, &a.lanes, sizeof half);
    for (int width = N / 2; width > 0; width /= 2)
        for (int k = 0; k < width; ++k) half[k] += half[k + width];
    Real const once[1] = {half[0]};
    compare("sum", Pack<Real, 1>(sum(a)), once);
}

void conversions() {
    constexpr int N = law_lanes<float>, M = law_lanes<double>;
    auto const words = filled<std::uint32_t, N>(word);
    auto const few = filled<std::uint32_t, M>(word);
    float single[N];
    double full[M];
    std::int32_t counted[N];
    for (int k = 0; k < N; ++k) {
        single[k] = signed_value<float>(std::uint32_t{words.lanes[k]});
        counted[k] = k;
    }
    for (int k = 0; k < M; ++k) full[k] = signed_value<double>(std::uint32_t{few.lanes[k]});
    compare("signed value", signed_value<Pack<float, N>>(words), single);
    compare("signed value", signed_value<Pack<double, M>>(few), full);
    compare("counting", counting<std::int32_t, N>(), counted);
}

}  // namespace

int main() {
    for (int trial = 0; trial < 100; ++trial) {
        laws<float>();
        laws<double>();
        bits();
        arithmetic<float>();
        arithmetic<double>();
        exponentials<float>();
        exponentials<double>();
        rounding<float, std::int32_t>(2147483000.0);
        rounding<double, std::int64_t>(2251799813685247.0);
        quads<float>();
        quads<std::int32_t>();
        quads<double>();
        quads<std::int64_t>();
        sums<float, 16>();
        sums<double, 8>();
        sums<float, law_lanes<float>>();
        sums<double, law_lanes<double>>();
        conversions();
    }
    comparisons();
    storing();
    for (int k = 0; k < wrongs; ++k) std::printf("%s\n", wrong[k]);
    if (wrongs == 0) std::puts("the same");
}
