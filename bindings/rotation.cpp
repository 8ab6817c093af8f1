#include "bodies/rotation.hpp"

#include "bindings.hpp"

namespace tether::bindings {

namespace {

template <int D>
nb::ndarray<nb::numpy, double> placed(Array2 const& reference, Array2 const& actual) {
    auto const from = to_vectors<D>(reference), to = to_vectors<D>(actual);
    if (from.size() != to.size()) throw std::invalid_argument("reference and actual must have one shape");
    Correlation<D> correlation{};
    for (std::size_t i = 0; i < from.size(); ++i)
        for (std::size_t k = 0; k < D; ++k)
            for (std::size_t l = 0; l < D; ++l) correlation[k][l] += from[i][k] * to[i][l];
    Rotation<D> const rotation = best_rotation(correlation);
    std::vector<Vector<D>> turned;
    for (Vector<D> const& r : from) turned.push_back(rotation.turn(r));
    return to_numpy(turned);
}

}  // namespace

void export_rotation(nb::module_& module) {
    module.def(
        "best_fit",
        [](Array2 const& reference, Array2 const& actual) {
            return reference.shape(1) == 2 ? placed<2>(reference, actual) : placed<3>(reference, actual);
        },
        nb::arg("reference"), nb::arg("actual"), "Reference points (n, D), turned to fit the actual ones best.");
}

}  // namespace tether::bindings
