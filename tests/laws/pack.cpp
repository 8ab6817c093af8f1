// A pack of four words and a pack of four floats, as a SIMD engine would bring them: the law, the weights and the noise have to
// compile for them as they stand, and give lane by lane what they give one by one.
#include <cmath>
#include <cstdio>

#include "lane.hpp"

struct Floats {
    float lane[4];
    Floats() = default;
    explicit Floats(double x) : lane{float(x), float(x), float(x), float(x)} {}
    template <class Of>
    static Floats each(Of of) {
        Floats out;
        for (int k = 0; k < 4; ++k) out.lane[k] = of(k);
        return out;
    }
    friend Floats operator+(Floats a, Floats b) {
        return each([&](int k) { return a.lane[k] + b.lane[k]; });
    }
    friend Floats operator-(Floats a, Floats b) {
        return each([&](int k) { return a.lane[k] - b.lane[k]; });
    }
    friend Floats operator*(Floats a, Floats b) {
        return each([&](int k) { return a.lane[k] * b.lane[k]; });
    }
    friend Floats operator-(Floats a) {
        return each([&](int k) { return -a.lane[k]; });
    }
};
struct Words {
    std::uint32_t lane[4];
    Words() = default;
    explicit Words(std::uint32_t x) : lane{x, x, x, x} {}
    friend Words operator^(Words a, Words b) {
        for (int k = 0; k < 4; ++k) a.lane[k] ^= b.lane[k];
        return a;
    }
};
namespace tether {
Floats square_root(Floats x) {
    return Floats::each([&](int k) { return std::sqrt(x.lane[k]); });
}
Floats power(Floats x, Floats y) {
    return Floats::each([&](int k) { return std::pow(x.lane[k], y.lane[k]); });
}
void widening_product(Words a, std::uint32_t b, Words& high, Words& low) {
    for (int k = 0; k < 4; ++k) widening_product(a.lane[k], b, high.lane[k], low.lane[k]);
}
template <class Real>
Real signed_value(Words words) {
    return Real::each([&](int k) { return float(static_cast<std::int32_t>(words.lane[k])); });
}
}  // namespace tether

#include "laws/dpd.hpp"
#include "noise.hpp"

template <class Weight>
bool agree(Weight weight) {
    using namespace tether;
    StepKey const key = step_key(7, 11, Stream::run);
    Words lower, higher;
    Floats distance, departure;
    for (std::uint32_t k = 0; k < 4; ++k) {
        lower.lane[k] = 3 * k;
        higher.lane[k] = 5 * k + 40;
        distance.lane[k] = 0.2f * float(k) + 0.1f;
        departure.lane[k] = 1.0f - float(k);
    }
    Dpd<Weight> const law{weight};
    Floats const noise = UniformNoise::draw<Floats>(pair_bits(key, lower, higher));
    DpdParameters<Floats> const packed{Floats(18.75), Floats(4.5), Floats(42.0), Floats(1.0)};
    DpdParameters<float> const single{18.75f, 4.5f, 42.0f, 1.0f};
    PairForce<Floats> const forces = law(Pair<Floats>{distance, departure, noise}, packed);
    bool same = true;
    for (int k = 0; k < 4; ++k) {
        float const alone = UniformNoise::draw<float>(pair_bits(key, lower.lane[k], higher.lane[k]));
        PairForce<float> const force = law(Pair<float>{distance.lane[k], departure.lane[k], alone}, single);
        same = same && force.conservative == forces.conservative.lane[k] &&
               force.dissipative == forces.dissipative.lane[k] && force.random == forces.random.lane[k];
    }
    return same;
}

int main() {
    using namespace tether;
    bool const same = agree(HalfPower{}) && agree(SquarePower{}) && agree(AnyPower{0.35});
    std::puts(same ? "the same" : "not the same");
    return same ? 0 : 1;
}
