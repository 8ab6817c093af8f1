// What the files of this folder share: arrays in, arrays out, and the list of what the module exports.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "vector.hpp"

namespace nb = nanobind;

namespace tether::bindings {

using Array1 = nb::ndarray<double const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Array2 = nb::ndarray<double const, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Array3 = nb::ndarray<double const, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using Ids = nb::ndarray<std::uint32_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// A NumPy array that owns a copy of the values.
template <class T>
nb::ndarray<nb::numpy, T> to_numpy(T const* values, std::vector<std::size_t> const& shape) {
    std::size_t size = 1;
    for (std::size_t side : shape) size *= side;
    T* copy = new T[size > 0 ? size : 1];
    if (size > 0) std::memcpy(copy, values, size * sizeof(T));
    nb::capsule owner(copy, [](void* p) noexcept { delete[] static_cast<T*>(p); });
    return nb::ndarray<nb::numpy, T>(copy, shape.size(), shape.data(), owner);
}

template <int D>
nb::ndarray<nb::numpy, double> to_numpy(std::vector<Vector<D>> const& vectors) {
    return to_numpy<double>(reinterpret_cast<double const*>(vectors.data()), {vectors.size(), std::size_t{D}});
}

// An (n, D) array as vectors; ValueError when it has another shape.
template <int D>
std::vector<Vector<D>> to_vectors(Array2 const& array) {
    if (array.shape(1) != D) throw std::invalid_argument("expected an array of shape (n, " + std::to_string(D) + ")");
    std::vector<Vector<D>> vectors(array.shape(0));
    if (!vectors.empty()) std::memcpy(vectors.data(), array.data(), vectors.size() * sizeof(Vector<D>));
    return vectors;
}

template <int D>
Vector<D> to_vector(std::vector<double> const& values) {
    if (values.size() != D) throw std::invalid_argument("expected " + std::to_string(D) + " numbers");
    Vector<D> vector{};
    for (std::size_t k = 0; k < D; ++k) vector[k] = values[k];
    return vector;
}

void export_engine(nb::module_& module);
void export_box(nb::module_& module);
void export_noise(nb::module_& module);
void export_law(nb::module_& module);
void export_pairs(nb::module_& module);
void export_pair_histogram(nb::module_& module);
void export_rotation(nb::module_& module);

}  // namespace tether::bindings
