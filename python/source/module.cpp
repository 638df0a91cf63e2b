// SPDX-License-Identifier: MIT
// The extension module silt._silt, on which the package silt is built.
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/version.hpp>

#include "any_coupled.hpp"
#include "any_simulation.hpp"
#include "any_wall.hpp"
#include "arrays.hpp"
#include "core.hpp"
#include "interpreter_lock.hpp"
#include "setup.hpp"
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace silt::python {
namespace {

// Advice that C++ programs are given, and what it is in Python; the longer one first.
constexpr std::pair<std::string_view, std::string_view> advice[] = {
    {"run({.time_step = …}) or step(dt)", "run(until, time_step=…) or step(time_step=…)"},
    {"run({.time_step = …})", "run(until, time_step=…)"},
    {"{.file = …, .accepts_other_setup = true}", "accepts_other_setup=True"},
    {"set up the same simulation and pass the same parts as", "set up the same simulation as"},
    {"another FlowSettings::walls", "another tank, lid, wall, motion, opening or body"},
    {"another FlowSettings::", "another "},
    {"VelocityOpening: ", "Inflow or Extraction: "},
    {"HydrostaticPressure: ", "PressureOpening: "},
    {"ContactSettings::max_overlap", "max_overlap of grain_simulation()"},
    {"lower the time step, use a stiffer material, or raise ContactSettings::max_displacement",
     "lower the time step, or use a stiffer material"},
    {"the law gives more energy than its springs hold: check its force and its elastic energy, "
     "lower the time step, or raise ContactSettings::max_energy_gain",
     "lower the time step"},
    {"; set it, or add grains by add_grain()", "; set it"},
    {"with FlowSettings: viscosity", "with viscosity"},
    {"or the grains NoDrag", "or drag=None to Coupled"},
    {"FluidForces: ", "Coupled: "},
    {"FluidForces::drag", "drag"},
    {"FluidForceCoefficients::", ""},
    {"set Box::on_escape to OnEscape::remove", "set on_escape to 'remove'"},
    {"move it to the other side of the wall beside it, or set ImageWalls::let_fluid_fall",
     "change the gravity, or close the tank by lid=True"},
};

std::string in_python(std::string text) {
  for (const auto& [written, meant] : advice) {
    const auto at = text.find(written);
    if (at != std::string::npos) text.replace(at, written.size(), meant);
  }
  return text;
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const py::object type = py::module_::import("silt.error").attr("Error");
    const py::object made = type(in_python(error.what()));
    const Where& where = error.where();
    made.attr("id") = where.id;
    made.attr("step") = where.step;
    made.attr("time") = where.time;
    PyErr_SetObject(type.ptr(), made.ptr());
  }
}

py::dict named_values(const std::vector<std::pair<std::string, double>>& values) {
  py::dict all;
  for (const auto& [name, value] : values) all[py::str(name)] = value;
  return all;
}

// What simulations, and two in one, have in common.
template <class Any>
auto bind_core(py::module_& module, const char* name) {
  using C = CoreOf<Any>;
  return py::class_<C, std::shared_ptr<C>>(module, name)
      .def_property_readonly("dimension", [](C& core) { return core.use("dimension").dimension(); })
      .def_property_readonly("time", [](C& core) { return core.use("time").time(); })
      .def_property_readonly("steps", [](C& core) { return core.use("steps").steps(); })
      .def_property_readonly("last_time_step",
                             [](C& core) { return core.use("last_time_step").last_time_step(); })
      .def("time_step", [](C& core) { return core.use("time_step").time_step(); })
      .def("step", &C::step)
      .def("run",
           [](C& core, double until, double output_every, std::optional<double> time_step,
              bool end_exactly, const py::object& observer) {
             core.run({.until = until,
                       .output_every = output_every,
                       .time_step = time_step,
                       .end_exactly = end_exactly},
                      observer);
           })
      .def("write_frame",
           [](C& core, VtkSeries& frames) { core.use("write_frame").write_frame(frames); })
      .def("write_checkpoint",
           [](C& core, const std::filesystem::path& path) {
             core.use("write_checkpoint").write_checkpoint(path);
           })
      .def("read_checkpoint", [](C& core, const std::filesystem::path& path,
                                 bool accepts_other_setup) {
        core.advance("read_checkpoint", [&](Any& simulation) {
          simulation.read_checkpoint({.file = path, .accepts_other_setup = accepts_other_setup});
        });
      });
}

using CoupledCore = CoreOf<AnyCoupled>;

/// None, the name of a law, or β of a linear one.
AnyDrag drag_of(const py::object& drag) {
  if (drag.is_none()) return {};
  if (py::isinstance<py::float_>(drag)) {
    const double linear = drag.cast<double>();
    require_positive("Coupled: drag", linear);
    return {.linear = linear};
  }
  const std::string name = drag.cast<std::string>();
  const auto found = std::ranges::find(drag_laws, name, &NamedDrag::name);
  return {.is_named = true, .place = std::uint64_t(found - std::begin(drag_laws))};
}

/// Two simulations in one, and what each of them is then.
py::tuple join(Core& grains, Core& fluid, const Joint& joint) {
  Joined joined = grains.advance("run", [&](AnySimulation& of_grains) {
    return fluid.advance("run", [&](AnySimulation& of_fluid) {
      return of_grains.dimension() == 2 ? join<2>(of_grains, of_fluid, joint)
                                        : join<3>(of_grains, of_fluid, joint);
    });
  });
  const auto usage = std::make_shared<Usage>();
  return py::make_tuple(std::make_shared<CoupledCore>(std::move(joined.both), usage),
                        std::make_shared<Core>(std::move(joined.grains), usage),
                        std::make_shared<Core>(std::move(joined.fluid), usage));
}

}  // namespace
}  // namespace silt::python

PYBIND11_MODULE(_silt, module) {
  using namespace silt;
  using namespace silt::python;
  using namespace pybind11::literals;

  py::register_exception_translator(translate);
  module.attr("version") = std::to_string(SILT_VERSION_MAJOR) + "." +
                           std::to_string(SILT_VERSION_MINOR) + "." +
                           std::to_string(SILT_VERSION_PATCH);
  module.attr("max_walls") = max_walls;

  py::class_<VtkSeries>(module, "VtkSeries")
      .def(py::init<std::filesystem::path>())
      .def_property_readonly("frames", &VtkSeries::frames);
  py::class_<VtkWalls>(module, "VtkWalls")
      .def(py::init<std::filesystem::path>())
      .def_property_readonly("frames", [](const VtkWalls& frames) { return frames.frames(); });

  bind_core<AnySimulation>(module, "Core")
      .def_property_readonly("size", [](Core& core) { return core.use("size").size(); })
      .def_property_readonly("particles_lost",
                             [](Core& core) { return core.use("particles_lost").particles_lost(); })
      .def_property_readonly("ids",
                             [](Core& core) {
                               const auto ids = core.use("ids").ids();
                               return py::array_t<Id>(py::ssize_t(ids.size()), ids.data());
                             })
      .def_property_readonly("fields",
                             [](Core& core) {
                               std::vector<std::string> names;
                               for (const auto& field : core.use("fields").fields()) {
                                 names.push_back(field.name);
                               }
                               return names;
                             })
      .def("view", &Core::view)
      .def("snapshot", [](Core& core) { return dict_of(core.use("snapshot").snapshot()); })
      .def("remove",
           [](Core& core, const std::vector<Id>& ids) { core.change("remove").remove(ids); })
      .def("energies", [](Core& core) { return named_values(core.use("energies").energies()); })
      .def("set_wall_present",
           [](Core& core, Index wall, bool present) {
             core.use("set_wall_present").set_wall_present(wall, present);
           })
      .def("is_wall_present",
           [](Core& core, Index wall) { return core.use("is_wall_present").is_wall_present(wall); })
      .def("wall_load",
           [](Core& core, Index wall) {
             const Load load = core.use("wall_load").wall_load(wall);
             return std::pair{load.force, load.torque};
           })
      .def("body_count", [](Core& core) { return core.use("bodies").body_count(); })
      .def("body_state", [](Core& core, Index body) { return core.use("bodies").body_state(body); })
      .def("body_load",
           [](Core& core, Index body) {
             const Load load = core.use("body_load").body_load(body);
             return std::pair{load.force, load.torque};
           })
      .def("openings",
           [](Core& core) {
             const AnySimulation& simulation = core.use("openings");
             py::list all;
             for (Index k = 0; k < simulation.opening_count(); ++k) {
               const PassedOpening passed = simulation.passed_opening(k);
               all.append(py::make_tuple(passed.added, passed.removed, passed.volume));
             }
             return all;
           })
      .def("write_walls",
           [](Core& core, VtkWalls& frames) { core.use("write_walls").write_walls(frames); })
      .def("front",
           [](Core& core) {
             const Front front = core.use("front").front();
             return std::pair{front.x, front.height};
           })
      .def("wall_pressure",
           [](Core& core, const std::vector<double>& point, const std::vector<double>& normal) {
             return core.use("wall_pressure").wall_pressure(point, normal);
           });

  bind_core<AnyCoupled>(module, "CoupledCore")
      .def("energies",
           [](CoupledCore& core) { return named_values(core.use("energies").energies()); })
      .def("let_fluid_settle", [](CoupledCore& core, double tolerance, int max_steps) {
        return core.advance("let_fluid_settle", [&](AnyCoupled& both) {
          const Unlocked unlocked;
          return both.let_fluid_settle(tolerance, max_steps);
        });
      });
  py::list names;
  for (const NamedDrag& law : drag_laws) names.append(std::string(law.name));
  module.attr("drag_laws") = py::tuple(names);
  module.def("join", [](Core& grains, Core& fluid, const py::object& drag, double added_mass,
                        double lift, bool makes_room) {
    return join(grains, fluid,
                {.drag = drag_of(drag),
                 .coefficients = {.added_mass = added_mass, .lift = lift},
                 .makes_room = makes_room});
  });

  module.def("grains", [](const Doubles& x, const Doubles& u, const Doubles& R,
                          const Doubles& density, const py::object& law, const py::list& walls,
                          const Doubles& gravity, double damping, const py::object& box,
                          double steps_per_contact, double max_overlap) {
    const GrainArguments given{x,       u,       R,   density,           law,        walls,
                               gravity, damping, box, steps_per_contact, max_overlap};
    return std::make_shared<Core>(x.shape(1) == 2 ? grains<2>(given) : grains<3>(given));
  });
  module.def("flow", [](const Doubles& x, const Doubles& u, const std::vector<double>& tank,
                        bool lid, const Doubles& walls, const py::list& moving,
                        const py::list& bodies, bool removes_escaped, double spacing,
                        double density, double viscosity, double speed_scale,
                        const std::optional<Doubles>& gravity, const py::list& openings) {
    const FlowArguments given{x,
                              u,
                              {tank, lid, walls, moving, bodies},
                              removes_escaped,
                              spacing,
                              density,
                              viscosity,
                              speed_scale,
                              gravity,
                              openings};
    return std::make_shared<Core>(x.shape(1) == 2 ? flow<2>(given) : flow<3>(given));
  });
  module.def("fill", [](const std::vector<double>& inside, double level, double spacing,
                        const std::vector<double>& tank, bool lid, const Doubles& walls,
                        const py::list& moving, const py::list& bodies) {
    const WallArguments given{tank, lid, walls, moving, bodies};
    return inside.size() == 2 ? filling_of<2>(given, inside, level, spacing)
                              : filling_of<3>(given, inside, level, spacing);
  });
  module.def("lattice", [](const std::vector<double>& lower, const std::vector<double>& upper,
                           double spacing) {
    return lower.size() == 2 ? lattice_of<2>(lower, upper, spacing)
                             : lattice_of<3>(lower, upper, spacing);
  });
  module.def("without_inside", [](const Doubles& x, const Doubles& faces, double spacing) {
    return x.shape(1) == 2 ? without_inside<2>(x, faces, spacing)
                           : without_inside<3>(x, faces, spacing);
  });
  module.def("faces_of_box",
             [](const std::vector<double>& lower, const std::vector<double>& upper, bool open_top) {
               return lower.size() == 2 ? faces_of_box<2>(lower, upper, open_top)
                                        : faces_of_box<3>(lower, upper, open_top);
             });
  module.def("faces_of_disc", &faces_of_ball<2>);
  module.def("faces_of_sphere", &faces_of_ball<3>);
  module.def("use_threads", &use_threads);
  // The threads of OpenMP do not exist in a process that was forked.
  module.def("after_fork", [] {
    AtExit::forget_others();
    use_threads(1);
  });
  py::module_::import("atexit").attr("register")(py::cpp_function(&AtExit::stop_others));
}
