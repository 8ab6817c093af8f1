#include "pairs/cell_grid.hpp"

#include "bindings.hpp"

namespace tether::bindings {

namespace {

template <int D>
nb::tuple neighbor_pairs_of(Array2 const& position, std::vector<double> const& size, double shear_rate, double offset,
                            double cutoff) {
    Box<D> box(to_vector<D>(size), shear_rate);
    box.set_offset(offset);
    Team team(1);
    CellGrid<D> grid(box, cutoff, position.shape(0));
    grid.sort(to_vectors<D>(position), box, team);
    std::vector<std::uint32_t> ids;
    std::vector<Vector<D>> separations;
    std::vector<double> image_velocities;
    for (std::vector<std::size_t> const& color : grid.colors())
        for (std::size_t row : color)
            grid.for_each_pair(row, [&](std::size_t i, auto const& partners) {
                for (std::size_t k = 0; k < partners.size(); ++k) {
                    Neighbor<D> const n = partners[k];
                    ids.push_back(grid.ids()[i]);
                    ids.push_back(grid.ids()[n.j]);
                    separations.push_back(n.separation);
                    image_velocities.push_back(n.image_velocity);
                }
            });
    return nb::make_tuple(to_numpy<std::uint32_t>(ids.data(), {ids.size() / 2, std::size_t{2}}), to_numpy(separations),
                          to_numpy<double>(image_velocities.data(), {image_velocities.size()}));
}

}  // namespace

void export_pairs(nb::module_& module) {
    module.def(
        "neighbor_pairs",
        [](Array2 const& position, std::vector<double> const& size, double shear_rate, double offset, double cutoff) {
            return size.size() == 2 ? neighbor_pairs_of<2>(position, size, shear_rate, offset, cutoff)
                                    : neighbor_pairs_of<3>(position, size, shear_rate, offset, cutoff);
        },
        nb::arg("position"), nb::arg("size"), nb::arg("shear_rate") = 0.0, nb::arg("offset") = 0.0,
        nb::arg("cutoff") = 1.0,
        "Every pair within the cutoff as the pair loop finds it: ids (n, 2), separations r_i - r_j of the images (n, "
        "D), and what the\n"
        "image of j moves faster than j along x (n,).");
}

}  // namespace tether::bindings
