#include "bindings.hpp"
#include "cpu_engine.hpp"

namespace tether::bindings {

namespace {

// A base as a flat row, for checkpoints: center, rotation, velocity, angular momentum, force, torque.
template <int D>
constexpr std::size_t base_values = sizeof(Base<D>) / sizeof(double);

// The value that a word stands for; ValueError for any other word.
template <class Value>
Value chosen(std::string const& word, std::vector<std::pair<std::string, Value>> const& words) {
    for (auto const& [known, value] : words)
        if (known == word) return value;
    throw std::invalid_argument("unknown word \"" + word + "\"");
}

template <int D>
void export_engine_of(nb::module_& module, char const* name) {
    using E = CpuEngine<D>;
    auto const vectors = [](Field<D> State<D>::* member) {
        return std::pair(
            [member](E const& self) {
                State<D> const& state = self.state;
                std::vector<Vector<D>> by_id(state.size());
                for (std::size_t id = 0; id < by_id.size(); ++id) by_id[id] = (state.*member)[state.place[id]];
                return to_numpy(by_id);
            },
            [member](E& self, Array2 const& array) {
                State<D>& state = self.state;
                std::vector<Vector<D>> const by_id = to_vectors<D>(array);
                if (by_id.size() != state.size()) throw std::invalid_argument("expected a row for each particle");
                for (std::size_t id = 0; id < by_id.size(); ++id) (state.*member).set(state.place[id], by_id[id]);
            });
    };
    auto const [get_position, set_position] = vectors(&State<D>::position);
    auto const [get_velocity, set_velocity] = vectors(&State<D>::velocity);
    auto const [get_force, set_force] = vectors(&State<D>::force);

    auto const owned = nb::for_getter(nb::rv_policy::automatic);  // the arrays own their copies

    nb::class_<E>(module, name,
                  "The CPU engine: positions, velocities and forces are copies of shape (n, D), in the order of ids.")
        .def(
            "__init__",
            [](E* self, std::vector<double> const& size, double shear_rate, double repulsion, double friction,
               double noise, double cutoff, double exponent, std::string const& random, double timestep,
               double verlet_lambda, std::uint64_t seed, std::vector<double> const& species_mass,
               nb::ndarray<std::uint8_t const, nb::ndim<1>, nb::c_contig> species, std::string const& pairs,
               std::string const& precision, std::string const& instruction_set, int threads) {
                FluidParameters const fluid{
                    repulsion,
                    friction,
                    noise,
                    cutoff,
                    exponent,
                    chosen<NoiseKind>(random, {{"uniform", NoiseKind::uniform}, {"gaussian", NoiseKind::gaussian}})};
                PairEngine const engine{
                    chosen<bool>(pairs, {{"packed", false}, {"reference", true}}),
                    chosen<Precision>(precision, {{"mixed", Precision::mixed}, {"double", Precision::full}}),
                    instruction_set};
                new (self)
                    E(Box<D>(to_vector<D>(size), shear_rate), fluid, timestep, verlet_lambda, seed, species_mass,
                      std::vector<std::uint8_t>(species.data(), species.data() + species.shape(0)), engine, threads);
            },
            nb::kw_only(), nb::arg("size"), nb::arg("shear_rate"), nb::arg("repulsion"), nb::arg("friction"),
            nb::arg("noise"), nb::arg("cutoff"), nb::arg("exponent"), nb::arg("random"), nb::arg("timestep"),
            nb::arg("verlet_lambda"), nb::arg("seed"), nb::arg("species_mass"), nb::arg("species"),
            nb::arg("pairs") = "packed", nb::arg("precision") = "mixed", nb::arg("instruction_set") = "",
            nb::arg("threads") = 1)
        .def(
            "add_bodies",
            [](E& self, Array2 const& sites, std::size_t count, std::size_t first, double stiffness, double mass,
               std::string const& base, std::string const& torque_arms) {
                BaseMotion const motion =
                    chosen<BaseMotion>(base, {{"massless", BaseMotion::massless},
                                              {"newton-euler", BaseMotion::newton_euler},
                                              {"newton-euler-lagged", BaseMotion::newton_euler_lagged}});
                TorqueArms const arms = chosen<TorqueArms>(
                    torque_arms, {{"constituents", TorqueArms::constituents}, {"sites", TorqueArms::sites}});
                self.add_bodies(TetheredBodies<D>(to_vectors<D>(sites), count, first, stiffness, mass, motion, arms));
            },
            nb::kw_only(), nb::arg("sites"), nb::arg("count"), nb::arg("first"), nb::arg("stiffness"), nb::arg("mass"),
            nb::arg("base"), nb::arg("torque_arms"))
        .def("start_gently", &E::start_gently, nb::arg("first"), nb::arg("steps"), nb::arg("displacement"),
             nb::call_guard<nb::gil_scoped_release>())
        .def("place", &E::place, nb::call_guard<nb::gil_scoped_release>())
        .def(
            "run",
            [](E& self, std::uint64_t steps, std::uint64_t interval) {
                if (interval > 0 && steps % interval != 0)
                    throw std::invalid_argument("steps must be a multiple of interval");
                std::vector<double> means;
                {
                    nb::gil_scoped_release const release;
                    means = self.run(steps, interval);
                }
                return to_numpy<double>(means.data(), {means.size() / Sample<D>::values, Sample<D>::values});
            },
            nb::arg("steps"), nb::arg("interval") = 0,
            "Advance; with an interval, return the means of every measured quantity over each interval of steps, "
            "(steps/interval, values).")
        .def_prop_ro_static("columns", [](nb::handle) { return Sample<D>::columns(); })
        .def_prop_rw(
            "order", [](E const& self) { return to_numpy<std::uint32_t>(self.state.id.data(), {self.state.size()}); },
            [](E& self, Ids const& order) {
                Array<std::uint32_t> from(self.state.size());
                std::vector<bool> is_there(from.size());
                if (order.shape(0) != from.size()) throw std::invalid_argument("expected an id for each particle");
                for (std::size_t p = 0; p < from.size(); ++p) {
                    std::uint32_t const id = order(p);
                    if (id >= from.size() || is_there[id]) throw std::invalid_argument("expected each id once");
                    is_there[id] = true;
                    from[p] = self.state.place[id];
                }
                self.state.reorder(from, self.team());
            },
            owned, "Ids in the order that particles have in memory, (n,); sums of floating-point numbers depend on it.")
        .def_prop_rw("position", get_position, set_position, owned)
        .def_prop_rw("velocity", get_velocity, set_velocity, owned)
        .def_prop_rw("force", get_force, set_force, owned)
        .def_prop_ro(
            "species",
            [](E const& self) {
                return to_numpy<std::uint8_t>(self.state.species.data(), {self.state.species.size()});
            },
            owned)
        .def_prop_rw(
            "step", [](E const& self) { return self.state.step; },
            [](E& self, std::uint64_t step) { self.state.step = step; })
        .def_prop_rw(
            "offset", [](E const& self) { return self.box.offset(); },
            [](E& self, double offset) { self.box.set_offset(offset); })
        .def_prop_rw(
            "bases",
            [](E const& self) {
                std::vector<double> rows;
                for (TetheredBodies<D> const& kind : self.bodies)
                    for (Base<D> const& base : kind.bases) {
                        double const* values = reinterpret_cast<double const*>(&base);
                        rows.insert(rows.end(), values, values + base_values<D>);
                    }
                return to_numpy<double>(rows.data(), {rows.size() / base_values<D>, base_values<D>});
            },
            [](E& self, Array2 const& rows) {
                std::size_t count = 0;
                for (TetheredBodies<D> const& kind : self.bodies) count += kind.count();
                if (rows.shape(0) != count || rows.shape(1) != base_values<D>)
                    throw std::invalid_argument("expected a row of " + std::to_string(base_values<D>) +
                                                " for each body");
                double const* row = rows.data();
                for (TetheredBodies<D>& kind : self.bodies)
                    for (Base<D>& base : kind.bases) {
                        std::memcpy(static_cast<void*>(&base), row, sizeof(Base<D>));
                        row += base_values<D>;
                    }
            },
            owned, "Bases as rows of center, rotation, velocity, angular momentum, force and torque, kind by kind.")
        .def_prop_ro("rotational_freedom",
                     [](E const& self) {
                         std::size_t freedom = 0;
                         for (TetheredBodies<D> const& kind : self.bodies)
                             freedom += kind.count() * static_cast<std::size_t>(kind.rotational_freedom());
                         return freedom;
                     })
        .def_prop_ro("threads", &E::threads)
        .def_prop_rw(
            "is_timed", [](E const& self) { return self.watch.is_on; },
            [](E& self, bool is_on) { self.watch.is_on = is_on; }, "Whether the phases of a step are timed.")
        .def_prop_ro(
            "seconds",
            [](E const& self) {
                std::vector<std::pair<std::string, double>> phases;
                for (std::size_t k = 0; k < phase_names.size(); ++k)
                    phases.emplace_back(phase_names[k], self.watch.seconds[k]);
                return phases;
            },
            "Seconds spent in each phase of the steps that were timed.")
        .def_prop_ro("instruction_set", &E::instruction_set, "That of the pair loop; empty for the reference.")
        .def_prop_ro(
            "fault",
            [](E const& self) -> std::optional<std::tuple<std::uint64_t, std::size_t, double>> {
                if (!self.fault) return std::nullopt;
                return std::tuple(self.fault->step, self.fault->particle, self.fault->speed);
            },
            "Step, particle and speed of a particle that ran away, or None.");
}

}  // namespace

void export_engine(nb::module_& module) {
    export_engine_of<2>(module, "CpuEngine2");
    export_engine_of<3>(module, "CpuEngine3");
    module.def(
        "instruction_sets",
        [] {
            std::vector<std::pair<std::string, bool>> all;
            for (InstructionSet const& set : instruction_sets()) all.emplace_back(set.name, set.is_here);
            return all;
        },
        "The instruction sets that the pair loop was compiled for, the widest first, and whether this processor has "
        "them.");
}

}  // namespace tether::bindings
