#include "box.hpp"

#include "bindings.hpp"

namespace tether::bindings {

namespace {

template <int D>
void export_box_of(nb::module_& module, char const* name) {
    using B = Box<D>;
    nb::class_<B>(module, name, "The periodic box: the owner of the images' displacement and velocity difference.")
        .def(
            "__init__",
            [](B* self, std::vector<double> const& size, double shear_rate, double offset) {
                new (self) B(to_vector<D>(size), shear_rate);
                self->set_offset(offset);
            },
            nb::arg("size"), nb::arg("shear_rate") = 0.0, nb::arg("offset") = 0.0)
        .def_prop_ro("offset", &B::offset)
        .def("advance", &B::advance, nb::arg("time"))
        .def(
            "wrap",
            [](B const& self, Array2 const& position, Array2 const& velocity) {
                auto r = to_vectors<D>(position), v = to_vectors<D>(velocity);
                for (std::size_t i = 0; i < r.size(); ++i) self.wrap(r[i], v[i]);
                return nb::make_tuple(to_numpy(r), to_numpy(v));
            },
            nb::arg("position"), nb::arg("velocity"),
            "Positions and velocities of the images inside the box, (n, D) each.")
        .def(
            "nearest_image",
            [](B const& self, Array2 const& separation, Array2 const& velocity) {
                auto r = to_vectors<D>(separation), v = to_vectors<D>(velocity);
                for (std::size_t i = 0; i < r.size(); ++i) self.nearest_image(r[i], v[i]);
                return nb::make_tuple(to_numpy(r), to_numpy(v));
            },
            nb::arg("separation"), nb::arg("relative_velocity"),
            "Separations and relative velocities of nearest images, (n, D) each.");
}

}  // namespace

void export_box(nb::module_& module) {
    export_box_of<2>(module, "Box2");
    export_box_of<3>(module, "Box3");
}

}  // namespace tether::bindings
