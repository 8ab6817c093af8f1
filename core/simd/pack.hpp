// A pack of N numbers that are worked on together: SIMD written once, in the vector extensions that GCC and Clang share.
//
// Arithmetic, comparison, selection and conversion are the compiler's, for every processor it knows.  Five operations
// have no such spelling and are named here with the processor's own instruction where there is one: square root, maximum,
// rounding to an integer, and packing a subset of lanes to the front.  Each gives the same bits on every processor, as
// IEEE 754 has it.
//
// A file that includes this is compiled for one instruction set.  Everything is inlined by force, so that no copy made
// for another instruction set can stand in for it at link time.
#pragma once

#include <type_traits>
#include <utility>

#include "lane.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace tether {

// Bytes of the widest register of the instruction set that this file is compiled for.
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
constexpr int register_bytes = 64;
#elif defined(__AVX2__)
constexpr int register_bytes = 32;
#else
constexpr int register_bytes = 16;
#endif

template <class T, int N>
using Lanes [[gnu::vector_size(N * sizeof(T))]] = T;

template <class T, int N>
struct Pack {
    using Mask =
        Lanes<std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>, N>;  // each lane all ones or all zeros
    Lanes<T, N> lanes;

    Pack() = default;
    TETHER_DEVICE Pack(Lanes<T, N> l) : lanes(l) {}
    template <class Scalar>
        requires(std::is_arithmetic_v<Scalar>)
    TETHER_DEVICE explicit Pack(Scalar x) : lanes(static_cast<T>(x) - Lanes<T, N>{}) {}  // a broadcast

    TETHER_DEVICE friend Pack operator+(Pack a, Pack b) { return {(Lanes<T, N>)(a.wrapping() + b.wrapping())}; }
    TETHER_DEVICE friend Pack operator-(Pack a, Pack b) { return {(Lanes<T, N>)(a.wrapping() - b.wrapping())}; }
    TETHER_DEVICE friend Pack operator*(Pack a, Pack b) { return {a.lanes * b.lanes}; }
    TETHER_DEVICE friend Pack operator/(Pack a, Pack b) { return {a.lanes / b.lanes}; }
    TETHER_DEVICE friend Pack operator^(Pack a, Pack b) { return {a.lanes ^ b.lanes}; }
    TETHER_DEVICE friend Pack operator>>(Pack a, int bits) { return {a.lanes >> bits}; }
    TETHER_DEVICE friend Pack operator-(Pack a) { return {-a.lanes}; }
    TETHER_DEVICE Pack& operator+=(Pack b) { return *this = *this + b; }
    TETHER_DEVICE friend Mask operator<(Pack a, Pack b) { return a.lanes < b.lanes; }

  private:
    // Integers wrap around; those with a sign do so as integers without one, by the rules of the language.
    TETHER_DEVICE auto wrapping() const {
        if constexpr (std::is_integral_v<T>)
            return (Lanes<std::make_unsigned_t<T>, N>)lanes;
        else
            return lanes;
    }
};

template <int N>
using Words = Pack<std::uint32_t, N>;

// a where the mask is set, 0 elsewhere (whatever `a` is there, not a number included).
template <class T, int N>
TETHER_DEVICE inline Pack<T, N> where(typename Pack<T, N>::Mask mask, Pack<T, N> a) {
    using Mask = typename Pack<T, N>::Mask;
    return {reinterpret_cast<Lanes<T, N>>(mask & reinterpret_cast<Mask>(a.lanes))};
}

template <class To, class From, int N>
TETHER_DEVICE inline Pack<To, N> converted(Pack<From, N> a) {
    return {__builtin_convertvector(a.lanes, Lanes<To, N>)};
}

template <class To, class From, int N>
TETHER_DEVICE inline Pack<To, N> same_bits(Pack<From, N> a) {
    static_assert(sizeof(To) == sizeof(From));
    return {reinterpret_cast<Lanes<To, N>>(a.lanes)};
}

template <class T, int N>
TETHER_DEVICE inline Pack<T, N> load(T const* from) {
    Lanes<T, N> lanes;
    __builtin_memcpy(&lanes, from, sizeof lanes);
    return {lanes};
}

template <class T, int N>
TETHER_DEVICE inline void store(T* to, Pack<T, N> a) {
    __builtin_memcpy(to, &a.lanes, sizeof a.lanes);
}

template <class T, int N>
TETHER_DEVICE inline Pack<T, N> counting() {  // 0, 1, 2, ...
    Lanes<T, N> lanes;
    for (int k = 0; k < N; ++k) lanes[k] = static_cast<T>(k);
    return {lanes};
}

template <class T, int N>
TETHER_DEVICE inline T sum(Pack<T, N> a) {  // by halves
    if constexpr (N == 1) {
        return a.lanes[0];
    } else {
        Lanes<T, N / 2> low, high;
        __builtin_memcpy(&low, &a.lanes, sizeof low);
        __builtin_memcpy(&high, reinterpret_cast<char const*>(&a.lanes) + sizeof low, sizeof high);
        return sum(Pack<T, N / 2>{low} + Pack<T, N / 2>{high});
    }
}

// --- by the processor's own instructions ---

// IEEE 754 square root, lane by lane.
template <class T, int N>
TETHER_DEVICE inline Pack<T, N> square_root(Pack<T, N> a) {
    constexpr int bytes = N * sizeof(T);
#if defined(__x86_64__)
    if constexpr (bytes > register_bytes) {
        Pack<T, N> root;
        Lanes<T, N / 2> half[2];
        __builtin_memcpy(half, &a.lanes, sizeof half);
        for (auto& h : half) h = square_root(Pack<T, N / 2>{h}).lanes;
        __builtin_memcpy(&root.lanes, half, sizeof half);
        return root;
    } else {
#if defined(__AVX512F__)
        if constexpr (bytes == 64 && sizeof(T) == 4) return {(Lanes<T, N>)_mm512_sqrt_ps((__m512)a.lanes)};
        if constexpr (bytes == 64 && sizeof(T) == 8) return {(Lanes<T, N>)_mm512_sqrt_pd((__m512d)a.lanes)};
#endif
#if defined(__AVX__)
        if constexpr (bytes == 32 && sizeof(T) == 4) return {(Lanes<T, N>)_mm256_sqrt_ps((__m256)a.lanes)};
        if constexpr (bytes == 32 && sizeof(T) == 8) return {(Lanes<T, N>)_mm256_sqrt_pd((__m256d)a.lanes)};
#endif
        if constexpr (bytes == 16 && sizeof(T) == 4) return {(Lanes<T, N>)_mm_sqrt_ps((__m128)a.lanes)};
        if constexpr (bytes == 16 && sizeof(T) == 8) return {(Lanes<T, N>)_mm_sqrt_pd((__m128d)a.lanes)};
    }
#else
    for (int k = 0; k < N; ++k) a.lanes[k] = square_root(a.lanes[k]);
    return a;
#endif
}

// One lane at a time: the C library's, for exponents other than 1/2 and 2.
template <class T, int N>
TETHER_DEVICE inline Pack<T, N> power(Pack<T, N> a, Pack<T, N> exponent) {
    for (int k = 0; k < N; ++k) a.lanes[k] = power(a.lanes[k], exponent.lanes[k]);
    return a;
}

// 2^n and e^r - 1 with x = n ln 2 + r, |r| <= ln 2 / 2, for -80 < x <= 0 (what is below counts as -80): the latter by its
// Taylor sum, the same operations on every processor.
template <class T, int N>
struct Exponential {
    Pack<T, N> power, rest;
};

template <class T, int N>
TETHER_DEVICE inline Exponential<T, N> exponential_parts(Pack<T, N> x) {
    using Integer = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    constexpr int digits = sizeof(T) == 4 ? 23 : 52, terms = sizeof(T) == 4 ? 7 : 13;
    constexpr T high = sizeof(T) == 4 ? T(0.693359375) : T(0x1.62e42fefa38p-1);  // ln 2, the first digits of it
    constexpr T low = sizeof(T) == 4 ? T(-2.12194440e-4) : T(0x1.ef35793c7673p-45);
    Pack<T, N> const magic(sizeof(T) == 4 ? 12582912.0 : 6755399441055744.0);  // adding it rounds to an integer
    Pack<T, N> const least(-80.0), one(1.0);
    x = {x.lanes > least.lanes ? x.lanes : least.lanes};
    Pack<T, N> const shifted = x * Pack<T, N>(1.4426950408889634) + magic;
    Pack<T, N> const n = shifted - magic;
    Pack<T, N> const r = (x - n * Pack<T, N>(high)) - n * Pack<T, N>(low);
    double factorial = 1.0;
    for (int k = 2; k <= terms; ++k) factorial *= k;
    Pack<T, N> sum(1.0 / factorial);
    for (int k = terms; k > 1; --k) {
        factorial /= k;
        sum = sum * r + Pack<T, N>(1.0 / factorial);
    }
    Lanes<Integer, N> const exponent = same_bits<Integer>(shifted).lanes << digits;
    return {same_bits<T>(Pack<Integer, N>(same_bits<Integer>(one).lanes + exponent)), sum * r};
}

// e^x for -80 < x <= 0, to a rounding or two.
template <class T, int N>
TETHER_DEVICE inline Pack<T, N> exponential(Pack<T, N> x) {
    Exponential<T, N> const parts = exponential_parts(x);
    return parts.power + parts.power * parts.rest;
}

// e^x - 1 likewise, with all digits where x is small.
template <class T, int N>
TETHER_DEVICE inline Pack<T, N> exponential_less_one(Pack<T, N> x) {
    Exponential<T, N> const parts = exponential_parts(x);
    return parts.power * parts.rest + (parts.power - Pack<T, N>(1.0));
}

template <class T, int N>
TETHER_DEVICE inline Pack<T, N> larger(Pack<T, N> a, Pack<T, N> b) {
    return {a.lanes > b.lanes ? a.lanes : b.lanes};
}

// The nearest integer, ties to even, of numbers below 2^31 in size.
template <int N>
TETHER_DEVICE inline Pack<std::int32_t, N> rounded(Pack<float, N> a) {
#if defined(__AVX512F__)
    if constexpr (N == 16) return {(Lanes<std::int32_t, N>)_mm512_cvtps_epi32((__m512)a.lanes)};
#endif
#if defined(__AVX__)
    if constexpr (N == 8) return {(Lanes<std::int32_t, N>)_mm256_cvtps_epi32((__m256)a.lanes)};
#endif
#if defined(__x86_64__)
    if constexpr (N == 4) return {(Lanes<std::int32_t, N>)_mm_cvtps_epi32((__m128)a.lanes)};
#elif defined(__aarch64__)
    if constexpr (N == 4) return {(Lanes<std::int32_t, N>)vcvtnq_s32_f32((float32x4_t)a.lanes)};
#else
    Pack<std::int32_t, N> out;
    for (int k = 0; k < N; ++k) out.lanes[k] = static_cast<std::int32_t>(__builtin_rintf(a.lanes[k]));
    return out;
#endif
}

// The same of numbers below 2^51 in size: after adding 3 * 2^51 the last bit of a double counts ones.
template <int N>
TETHER_DEVICE inline Pack<std::int64_t, N> rounded(Pack<double, N> a) {
    Pack<double, N> const magic(6755399441055744.0);
    return same_bits<std::int64_t>(a + magic) - same_bits<std::int64_t>(magic);
}

// A bit for each lane: whether a < b there.
template <int N>
TETHER_DEVICE inline std::uint32_t lanes_below(Pack<float, N> a, Pack<float, N> b) {
#if defined(__AVX512F__)
    if constexpr (N == 16) return _mm512_cmp_ps_mask((__m512)a.lanes, (__m512)b.lanes, _CMP_LT_OQ);
#endif
#if defined(__AVX__)
    if constexpr (N == 8)
        return static_cast<std::uint32_t>(
            _mm256_movemask_ps(_mm256_cmp_ps((__m256)a.lanes, (__m256)b.lanes, _CMP_LT_OQ)));
#endif
#if defined(__x86_64__)
    if constexpr (N == 4)
        return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmplt_ps((__m128)a.lanes, (__m128)b.lanes)));
#elif defined(__aarch64__)
    if constexpr (N == 4) {
        uint32x4_t const bits = {1, 2, 4, 8};
        return vaddvq_u32(vandq_u32(vcltq_f32((float32x4_t)a.lanes, (float32x4_t)b.lanes), bits));
    }
#endif
    std::uint32_t bits = 0;
    for (int k = 0; k < N; ++k) bits |= (a.lanes[k] < b.lanes[k] ? 1u : 0u) << k;
    return bits;
}

// The bits of the first `count` of N lanes; of all, if there are no more.
template <int N>
TETHER_DEVICE inline std::uint32_t first_lanes(std::uint32_t count) {
    constexpr std::uint32_t all = (1u << N) - 1;
#if defined(__BMI2__)
    return _bzhi_u32(all, count < N ? count : N);
#else
    return count < N ? (1u << count) - 1 : all;
#endif
}

#if defined(__SSE4_1__) || defined(__aarch64__)
// For each set of four lanes, the bytes that bring its lanes to the front.
struct FrontBytes {
    alignas(16) std::uint8_t of[16][16];
    constexpr FrontBytes() : of{} {
        for (int set = 0; set < 16; ++set)
            for (int lane = 0, front = 0; lane < 4; ++lane)
                if (set >> lane & 1) {
                    for (int byte = 0; byte < 4; ++byte)
                        of[set][4 * front + byte] = static_cast<std::uint8_t>(4 * lane + byte);
                    ++front;
                }
    }
};
static constexpr FrontBytes front_bytes;
#endif

// Store the lanes that `bits` name, in order, at `to`; up to N lanes behind them are overwritten with anything.
template <int N>
TETHER_DEVICE inline void store_lanes(std::uint32_t* to, std::uint32_t bits, Words<N> a) {
#if defined(__AVX512F__)
    if constexpr (N == 16) {
        _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), (__m512i)a.lanes));
        return;
    }
#endif
#if defined(__AVX2__)
    if constexpr (N == 8) {
        // Each bit a byte of eight: first a mask, then the numbers of the lanes that it names.
        std::uint64_t const bytes = _pdep_u64(bits, 0x0101010101010101u) * 0xFFu;
        std::uint64_t const order = _pext_u64(0x0706050403020100u, bytes);
        __m256i const from = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(order)));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_permutevar8x32_epi32((__m256i)a.lanes, from));
        return;
    }
#endif
#if defined(__SSE4_1__)
    if constexpr (N == 4) {
        __m128i const from = _mm_load_si128(reinterpret_cast<__m128i const*>(front_bytes.of[bits]));
        _mm_storeu_si128(reinterpret_cast<__m128i*>(to), _mm_shuffle_epi8((__m128i)a.lanes, from));
        return;
    }
#elif defined(__aarch64__)
    if constexpr (N == 4) {
        vst1q_u8(reinterpret_cast<std::uint8_t*>(to), vqtbl1q_u8((uint8x16_t)a.lanes, vld1q_u8(front_bytes.of[bits])));
        return;
    }
#endif
    for (int k = 0; k < N; ++k) {
        *to = a.lanes[k];
        to += bits >> k & 1;
    }
}

// --- four fields of N records ---

template <class T, int N>
struct Quads {
    Pack<T, N> of[4];
};

// In each block of four lanes: lanes P, Q, R, S of the block of x (0 to 3) or of y (4 to 7).
template <int P, int Q, int R, int S, class V, int... Lane>
TETHER_DEVICE inline V shuffled(V x, V y, std::integer_sequence<int, Lane...>) {
    constexpr int pattern[4] = {P, Q, R, S}, count = sizeof...(Lane);
    return __builtin_shufflevector(x, y, (pattern[Lane % 4] % 4 + pattern[Lane % 4] / 4 * count + Lane / 4 * 4)...);
}

// Within each block of four lanes, rows become columns: lane 4 b + k of of[f] goes to lane 4 b + f of of[k].  The
// patterns are those that a processor shuffles in one instruction: within 16 bytes first, across them then.
template <class T, int N>
TETHER_DEVICE inline Quads<T, N> transposed(Quads<T, N> const& in) {
    constexpr std::make_integer_sequence<int, N> every{};
    auto const [a, b, c, d] = in.of;
    if constexpr (sizeof(T) == 4) {
        auto const ab = shuffled<0, 4, 1, 5>(a.lanes, b.lanes, every),
                   AB = shuffled<2, 6, 3, 7>(a.lanes, b.lanes, every);
        auto const cd = shuffled<0, 4, 1, 5>(c.lanes, d.lanes, every),
                   CD = shuffled<2, 6, 3, 7>(c.lanes, d.lanes, every);
        return {{{shuffled<0, 1, 4, 5>(ab, cd, every)},
                 {shuffled<2, 3, 6, 7>(ab, cd, every)},
                 {shuffled<0, 1, 4, 5>(AB, CD, every)},
                 {shuffled<2, 3, 6, 7>(AB, CD, every)}}};
    } else {
        auto const ab = shuffled<0, 4, 2, 6>(a.lanes, b.lanes, every),
                   AB = shuffled<1, 5, 3, 7>(a.lanes, b.lanes, every);
        auto const cd = shuffled<0, 4, 2, 6>(c.lanes, d.lanes, every),
                   CD = shuffled<1, 5, 3, 7>(c.lanes, d.lanes, every);
        return {{{shuffled<0, 1, 4, 5>(ab, cd, every)},
                 {shuffled<0, 1, 4, 5>(AB, CD, every)},
                 {shuffled<2, 3, 6, 7>(ab, cd, every)},
                 {shuffled<2, 3, 6, 7>(AB, CD, every)}}};
    }
}

template <class T>
TETHER_DEVICE inline Lanes<T, 8> joined(Lanes<T, 4> a, Lanes<T, 4> b) {
#if defined(__AVX2__)  // compilers shuffle registers where they could insert from memory
    if constexpr (sizeof(T) == 4)
        return (Lanes<T, 8>)_mm256_inserti128_si256(_mm256_castsi128_si256((__m128i)a), (__m128i)b, 1);
#endif
#if defined(__AVX512F__)
    if constexpr (sizeof(T) == 8)
        return (Lanes<T, 8>)_mm512_inserti64x4(_mm512_castsi256_si512((__m256i)a), (__m256i)b, 1);
#endif
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}

// Lane 4 b + k of the result is number k of the four at `from[b]`.
template <class T, int N>
TETHER_DEVICE inline Pack<T, N> gather_quads(char const* const* from) {
    Lanes<T, 4> quad[N / 4];
    for (int b = 0; b < N / 4; ++b) __builtin_memcpy(&quad[b], from[b], sizeof quad[b]);
    if constexpr (N == 4) {
        return {quad[0]};
    } else if constexpr (N == 8) {
        return {joined<T>(quad[0], quad[1])};
    } else {
#if defined(__AVX512F__)
        return {(Lanes<T, N>)_mm512_inserti64x4(_mm512_castsi256_si512((__m256i)joined<T>(quad[0], quad[1])),
                                                (__m256i)joined<T>(quad[2], quad[3]), 1)};
#else
        Lanes<T, 8> const low = joined<T>(quad[0], quad[1]), high = joined<T>(quad[2], quad[3]);
        return {__builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)};
#endif
    }
}

// The four lanes of block b.
template <class T, int N>
TETHER_DEVICE inline Pack<T, 4> quad_of(Pack<T, N> a, int b) {
    Lanes<T, 4> quad;
    __builtin_memcpy(&quad, reinterpret_cast<char const*>(&a.lanes) + static_cast<std::size_t>(b) * sizeof quad,
                     sizeof quad);
    return {quad};
}

}  // namespace tether
