#include "laws/dpd.hpp"

#include "bindings.hpp"

namespace tether::bindings {

namespace {

template <class Weight>
nb::ndarray<nb::numpy, double> forces_of(Weight weight, Array1 const& distance, Array1 const& departure,
                                         Array1 const& noise, DpdParameters<double> const& parameters) {
    Dpd<Weight> const law{weight};
    std::vector<double> terms(3 * distance.shape(0));
    for (std::size_t k = 0; k < distance.shape(0); ++k) {
        PairForce<double> const force = law(Pair<double>{distance(k), departure(k), noise(k)}, parameters);
        terms[3 * k] = force.conservative;
        terms[3 * k + 1] = force.dissipative;
        terms[3 * k + 2] = force.random;
    }
    return to_numpy<double>(terms.data(), {distance.shape(0), std::size_t{3}});
}

}  // namespace

void export_law(nb::module_& module) {
    module.def(
        "dpd_force",
        [](Array1 const& distance, Array1 const& departure, Array1 const& noise, double repulsion, double friction,
           double noise_amplitude, double cutoff, double exponent, bool general) {
            if (departure.shape(0) != distance.shape(0) || noise.shape(0) != distance.shape(0))
                throw std::invalid_argument("distance, departure and noise must have one length");
            DpdParameters<double> const parameters{repulsion, friction, noise_amplitude, 1.0 / cutoff};
            if (!general && exponent == 0.5) return forces_of(HalfPower{}, distance, departure, noise, parameters);
            if (!general && exponent == 2.0) return forces_of(SquarePower{}, distance, departure, noise, parameters);
            return forces_of(AnyPower{0.5 * exponent}, distance, departure, noise, parameters);
        },
        nb::arg("distance"), nb::arg("departure"), nb::arg("noise"), nb::arg("repulsion"), nb::arg("friction"),
        nb::arg("noise_amplitude"), nb::arg("cutoff"), nb::arg("exponent"), nb::arg("general") = false,
        "Conservative, dissipative and random force along e_ij, (n, 3); `general` takes the power function for every "
        "exponent.");
}

}  // namespace tether::bindings
