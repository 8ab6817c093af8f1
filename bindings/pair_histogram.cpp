#include "observe/pair_histogram.hpp"

#include <algorithm>

#include "bindings.hpp"

namespace tether::bindings {

namespace {

using Labels = nb::ndarray<std::uint8_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

void check(std::size_t bins, double range, double most, int threads) {
    if (bins < 1) throw std::invalid_argument("expected at least one bin");
    if (!(range > 0.0 && range <= most))
        throw std::invalid_argument("expected a range above 0 and at most half of the box's sides");
    if (threads < 1) throw std::invalid_argument("expected at least one thread");
}

template <int D>
Box<D> box_of(std::vector<double> const& size, double offset) {
    Box<D> box(to_vector<D>(size), 0.0);
    box.set_offset(offset);
    return box;
}

template <int D>
auto pair_histogram_of(Array2 const& position, std::vector<double> const& size, double offset, double range,
                       std::size_t bins, Labels const& group, std::size_t labels, int threads) {
    Box<D> const box = box_of<D>(size, offset);
    std::vector<Vector<D>> const points = to_vectors<D>(position);
    std::span<std::uint8_t const> const label(group.data(), group.shape(0));
    check(bins, range, 0.5 * smallest_side(box), threads);
    if (label.size() != points.size()) throw std::invalid_argument("expected one label for each position");
    if (std::any_of(label.begin(), label.end(), [&](std::uint8_t l) { return l >= labels; }))
        throw std::invalid_argument("expected labels below their number");
    Counts counts;
    {
        nb::gil_scoped_release const release;
        Team team(threads);
        counts = pair_histogram<D>(points, label, labels, box, range, bins, team);
    }
    return to_numpy<std::uint64_t>(counts.data(), {labels, labels, bins});
}

template <int D>
auto pair_map_of(Array2 const& position, std::vector<double> const& size, double offset, double range, std::size_t bins,
                 double thickness, int threads) {
    Box<D> const box = box_of<D>(size, offset);
    std::vector<Vector<D>> const points = to_vectors<D>(position);
    check(bins, range, 0.5 * std::min(size[0], size[1]), threads);
    if (D == 3 && !(thickness > 0.0 && thickness <= 0.5 * size[D - 1]))
        throw std::invalid_argument("expected a thickness above 0 and at most half of the box's side in z");
    Counts counts;
    {
        nb::gil_scoped_release const release;
        Team team(threads);
        counts = pair_map<D>(points, box, range, bins, thickness, team);
    }
    return to_numpy<std::uint64_t>(counts.data(), {bins, bins});
}

}  // namespace

void export_pair_histogram(nb::module_& module) {
    module.def(
        "pair_histogram",
        [](Array2 const& position, std::vector<double> const& size, double offset, double range, std::size_t bins,
           Labels const& group, std::size_t labels, int threads) {
            return size.size() == 2 ? pair_histogram_of<2>(position, size, offset, range, bins, group, labels, threads)
                                    : pair_histogram_of<3>(position, size, offset, range, bins, group, labels, threads);
        },
        nb::arg("position"), nb::arg("size"), nb::arg("offset"), nb::arg("range"), nb::arg("bins"), nb::arg("group"),
        nb::arg("labels"), nb::arg("threads") = 1,
        "Numbers of pairs by their labels and distance, (labels, labels, bins): [a, b, k] counts every pair of a point "
        "labelled a\n"
        "and one labelled b once, with k w <= distance < (k + 1) w, w = range/bins; [b, a] is the same. `group` has "
        "the labels (n,).\n"
        "Positions (n, D) inside the box; range at most half of its smallest side.");
    module.def(
        "pair_map",
        [](Array2 const& position, std::vector<double> const& size, double offset, double range, std::size_t bins,
           double thickness, int threads) {
            return size.size() == 2 ? pair_map_of<2>(position, size, offset, range, bins, thickness, threads)
                                    : pair_map_of<3>(position, size, offset, range, bins, thickness, threads);
        },
        nb::arg("position"), nb::arg("size"), nb::arg("offset"), nb::arg("range"), nb::arg("bins"),
        nb::arg("thickness") = 0.0, nb::arg("threads") = 1,
        "Numbers of ordered pairs by their separation in the plane of flow and gradient, (bins, bins): [k, l] counts y "
        "in\n"
        "[-range + k w, -range + (k + 1) w) and x likewise in l, w = 2 range/bins, in 3D with |z| < thickness.\n"
        "Positions (n, D) inside the box; range at most half of the sides in x and y.");
}

}  // namespace tether::bindings
