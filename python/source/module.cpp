// SPDX-License-Identifier: MIT
// The extension module silt._silt, on which the package silt is built. It guarantees that
//
// - no step is made, and no particle added, removed or reordered, while an array refers to the
//   memory of the particles;
// - caches of the simulation notice whatever was written through an array, because the access that
//   they notice is repeated when the array is deleted, which is before the next step;
// - no other thread has access during a step or run.
#include <silt/core/error.hpp>
#include <silt/core/lattice.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/run.hpp>
#include <silt/core/types.hpp>

#include "any_simulation.hpp"
#include "any_wall.hpp"
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::python {
namespace {

namespace py = pybind11;

// --- arrays --------------------------------------------------------------------------------------

py::dtype dtype_of(const FieldInfo& field) {
  std::string name = field.number;
  for (char& letter : name) letter = char(std::tolower(static_cast<unsigned char>(letter)));
  return py::dtype(name);
}

// An array of this memory, which `owner` keeps.
py::array array_of(const ColumnMemory& memory, const py::handle& owner) {
  const py::dtype number = dtype_of(memory.field);
  std::vector<py::ssize_t> shape{py::ssize_t(memory.size)}, strides{memory.stride};
  if (memory.field.components > 0) {
    shape.push_back(memory.field.components);
    strides.push_back(number.itemsize());
  }
  return py::array(number, shape, strides, memory.first, owner);
}

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

Rows rows_of(const Doubles& array) {
  return {{array.data(), array.data() + array.size()}, Index(array.shape(1))};
}
std::vector<double> numbers_of(const Doubles& array) {
  return {array.data(), array.data() + array.size()};
}

// --- the lock of the interpreter -----------------------------------------------------------------

// A thread that asks for the lock while the interpreter ends is ended by it, whose destructors then
// end the process as an error. At the end of the interpreter, the runs of other threads therefore
// stop for good before they ask for it.
class AtExit {
 public:
  /// Called by the interpreter, with its lock.
  static void stop_others() {
    const py::gil_scoped_release unlocked;
    thread_ = PyThread_get_thread_ident();
    is_ending_ = true;
    while (unlocked_ > stopped_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  /// To be called without the lock. Does not return if this thread must stop.
  static void stop_here() {
    if (!is_ending_ || thread_ == PyThread_get_thread_ident()) return;
    ++stopped_;
    while (true) std::this_thread::sleep_for(std::chrono::hours(1));
  }

 private:
  friend class Unlocked;
  friend class LockedAgain;

  inline static std::atomic<bool> is_ending_ = false;
  inline static std::atomic<unsigned long> thread_ = 0;  // that ends the interpreter
  inline static std::atomic<int> unlocked_ = 0;          // threads without the lock
  inline static std::atomic<int> stopped_ = 0;           // of them
};

/// Releases the lock for a step or run.
class Unlocked {
 public:
  Unlocked() {
    ++AtExit::unlocked_;
    release_.emplace();
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;
  ~Unlocked() {
    AtExit::stop_here();
    release_.reset();
    --AtExit::unlocked_;
  }

 private:
  std::optional<py::gil_scoped_release> release_;
};

/// Takes the lock within a step or run.
class LockedAgain {
 public:
  LockedAgain() {
    AtExit::stop_here();
    acquire_.emplace();
    --AtExit::unlocked_;
  }
  LockedAgain(const LockedAgain&) = delete;
  LockedAgain& operator=(const LockedAgain&) = delete;
  ~LockedAgain() {
    ++AtExit::unlocked_;
    acquire_.reset();
  }

 private:
  std::optional<py::gil_scoped_acquire> acquire_;
};

// --- simulations ---------------------------------------------------------------------------------

// A simulation, and who uses it. All members are read and written with the interpreter's lock,
// except the simulation itself during a step or run.
class Core : public std::enable_shared_from_this<Core> {
 public:
  explicit Core(std::unique_ptr<AnySimulation> simulation) : simulation_(std::move(simulation)) {}

  /// To read it, or to change it between steps.
  AnySimulation& use(const std::string& function) {
    if (runner_ && !(is_in_observer_ && *runner_ == this_thread())) {
      fail("Simulation." + function +
           ": a step or run is in progress in another thread; wait for its end");
    }
    // The measures may cache what is written to these.
    for (const Loan& loan : loans_) note_written(loan);
    return *simulation_;
  }

  /// To change particles so that their memory may be moved.
  AnySimulation& change(const std::string& function) {
    AnySimulation& simulation = use(function);
    require_no_views("Simulation." + function);
    return simulation;
  }

  py::array view(const std::string& field, bool is_written) {
    AnySimulation& simulation = use("view");
    const ColumnMemory memory = simulation.column(field, is_written);
    auto borrower =
        std::make_unique<Borrower>(shared_from_this(), Loan{field, is_written, simulation.steps()});
    const py::capsule owner(borrower.get(),
                            [](void* pointer) { delete static_cast<Borrower*>(pointer); });
    static_cast<void>(borrower.release());
    py::array array = array_of(memory, owner);
    if (!is_written) array.attr("flags").attr("writeable") = false;
    return array;
  }

  void read_checkpoint(const std::filesystem::path& path) {
    const Running running(*this, "read_checkpoint");
    simulation_->read_checkpoint(path);
  }

  void step(std::uint64_t count, std::optional<double> time_step) {
    const Running running(*this, "step");
    Interrupts hooks;
    {
      const Unlocked unlocked;
      for (std::uint64_t k = 0; k < count && !hooks.stop_requested(); ++k) {
        time_step ? simulation_->step(*time_step) : simulation_->step();
      }
    }
    hooks.rethrow();
  }

  void run(const Run& run, const py::object& observer) {
    const Running running(*this, "run");
    Observers hooks(*this, observer);
    {
      const Unlocked unlocked;
      simulation_->run(run, hooks);
    }
    hooks.rethrow();
  }

 private:
  /// An array that refers to the memory of a field.
  struct Loan {
    std::string field;
    bool is_written;
    std::uint64_t step;
  };

  /// Belongs to such an array, and ends with it and all that refer to it.
  class Borrower {
   public:
    Borrower(std::shared_ptr<Core> core, Loan loan)
        : core_(std::move(core)),
          loan_(core_->loans_.insert(core_->loans_.end(), std::move(loan))) {}
    Borrower(const Borrower&) = delete;
    Borrower& operator=(const Borrower&) = delete;
    ~Borrower() {
      core_->note_written(*loan_);
      core_->loans_.erase(loan_);
    }

   private:
    std::shared_ptr<Core> core_;
    std::list<Loan>::iterator loan_;
  };

  /// A step, run or other change of the time, as long as it lasts.
  class Running {
   public:
    Running(Core& core, const std::string& function) : core_(core) {
      if (core.runner_ && *core.runner_ == this_thread()) {
        fail("Simulation." + function +
             ": an observer must not advance or replace the simulation that calls it; do this "
             "after the run");
      }
      core.change(function);
      core.runner_ = this_thread();
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;
    ~Running() { core_.runner_.reset(); }

   private:
    Core& core_;
  };

  // Ends a run after Ctrl-C; the signal handlers of Python run only when they are asked for.
  class Interrupts : public Hooks {
   public:
    void make_output() override {}
    bool stop_requested() override {
      AtExit::stop_here();
      const auto now = std::chrono::steady_clock::now();
      if (now - last_ < std::chrono::milliseconds(50)) return false;
      last_ = now;
      const LockedAgain locked;
      if (PyErr_CheckSignals() == 0) return false;
      error_.emplace();
      return true;
    }
    /// With the interpreter's lock.
    void rethrow() {
      if (error_) throw py::error_already_set(*error_);
    }

   private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
    std::optional<py::error_already_set> error_;
  };

  class Observers : public Interrupts {
   public:
    Observers(Core& core, const py::object& observer) : core_(core), observer_(observer) {}
    void make_output() override {
      const LockedAgain locked;
      core_.is_in_observer_ = true;
      try {
        observer_();
      } catch (...) {
        core_.is_in_observer_ = false;
        throw;
      }
      core_.is_in_observer_ = false;
      core_.require_no_views("Simulation.run: after an observer was called");
    }

   private:
    Core& core_;
    const py::object& observer_;
  };

  static unsigned long this_thread() { return PyThread_get_thread_ident(); }

  void require_no_views(const std::string& where) const {
    if (loans_.empty()) return;
    const Loan& first = loans_.front();
    fail(where + ": an array still refers to the memory of the field \"" + first.field +
         "\", which a step may change or move; it was taken by view() at step " +
         std::to_string(first.step) +
         (loans_.size() > 1 ? ", and so do " + std::to_string(loans_.size() - 1) + " more" : "") +
         ". Delete the array and all slices of it, or use a copy, simulation[\"" + first.field +
         "\"][:]");
  }
  void note_written(const Loan& loan) {
    if (loan.is_written) static_cast<void>(simulation_->column(loan.field, true));
  }

  std::unique_ptr<AnySimulation> simulation_;
  std::list<Loan> loans_;
  std::optional<unsigned long> runner_;  // thread of the step or run
  bool is_in_observer_ = false;
};

// --- setup ---------------------------------------------------------------------------------------

// Arguments are objects of the package, whose attributes are numbers and tuples of numbers.

double number(const py::handle& object, const char* name) {
  return object.attr(name).cast<double>();
}
std::string type_of(const py::handle& object) {
  return py::type::of(object).attr("__name__").cast<std::string>();
}
template <int Dim>
Vec<Dim> vector(const py::handle& object, const char* name) {
  return to_vector<Dim>(type_of(object) + ": " + name,
                        object.attr(name).cast<std::vector<double>>());
}
dem::Side side(const py::handle& object) {
  return object.attr("grains").cast<std::string>() == "inside" ? dem::Side::inside
                                                               : dem::Side::outside;
}

template <int Dim>
Box<Dim> box_of(const py::handle& object) {
  Box<Dim> box;
  if (object.is_none()) return box;
  box.lower = vector<Dim>(object, "lower");
  box.upper = vector<Dim>(object, "upper");
  const Vec<Dim> periodic = vector<Dim>(object, "periodic");
  for (int k = 0; k < Dim; ++k) box.periodic[Index(k)] = periodic[k] != 0;
  if (object.attr("on_escape").cast<std::string>() == "remove") box.on_escape = OnEscape::remove;
  return box;
}

template <int Dim>
AnyWall<Dim> wall_of(const py::handle& object, Index place) {
  const std::string type = type_of(object);
  if (type == "Plane") {
    return {dem::Plane<Dim>{.point = vector<Dim>(object, "point"),
                            .normal = vector<Dim>(object, "normal")}};
  }
  if (type == "BoxWall") {
    const Box<Dim> box{.lower = vector<Dim>(object, "lower"),
                       .upper = vector<Dim>(object, "upper")};
    return {dem::BoxWall<Dim>{.box = box, .grains = side(object)}};
  }
  if constexpr (Dim == 2) {
    if (type == "Circle") {
      return {dem::Circle<>{.centre = vector<2>(object, "centre"),
                            .radius = number(object, "radius"),
                            .grains = side(object)}};
    }
    if (type == "Segment") {
      return {dem::Segment<>{.from = vector<2>(object, "start"), .to = vector<2>(object, "end")}};
    }
    if (type == "Polyline") {
      dem::Polyline<> line{.points = {}, .closed = object.attr("closed").cast<bool>()};
      const Rows points = rows_of(object.attr("points").cast<Doubles>());
      for (Index i = 0; i < points.size(); ++i) line.points.push_back(points.vector<2>(i));
      return {line};
    }
  } else {
    if (type == "Cylinder") {
      return {dem::Cylinder<>{.from = vector<3>(object, "start"),
                              .to = vector<3>(object, "end"),
                              .radius = number(object, "radius"),
                              .grains = side(object),
                              .ends = object.attr("ends").cast<bool>()}};
    }
    if (type == "MeshWall") {
      std::vector<Triangle<>> triangles;
      const Rows corners = rows_of(object.attr("corners").cast<Doubles>());
      for (Index i = 0; i + 2 < corners.size(); i += 3) {
        triangles.push_back(
            {{corners.vector<3>(i), corners.vector<3>(i + 1), corners.vector<3>(i + 2)}});
      }
      return {dem::MeshWall<>(triangles)};
    }
  }
  fail("grain_simulation: wall " + std::to_string(place) + " is a " + type +
       ", which is no wall in " + std::to_string(Dim) + "D; give a Plane, a BoxWall or " +
       (Dim == 2 ? "a Circle, Segment or Polyline" : "a Cylinder or MeshWall"));
}

template <int Dim>
std::unique_ptr<AnySimulation> grains(const py::handle& law, const GrainSetup<Dim>& setup) {
  const std::string type = type_of(law);
  if (type == "CundallStrack") {
    return make_grain_simulation(
        setup, dem::CundallStrack{.normal_stiffness = number(law, "normal_stiffness"),
                                  .tangential_stiffness = number(law, "tangential_stiffness"),
                                  .restitution = number(law, "restitution"),
                                  .friction_angle = number(law, "friction_angle")});
  }
  if (type == "LinearSpringDashpot") {
    return make_grain_simulation(
        setup,
        LinearLaw(dem::LinearSpringDashpot{.normal_stiffness = number(law, "normal_stiffness"),
                                           .restitution = number(law, "restitution")},
                  dem::LinearFriction{.tangential_stiffness = number(law, "tangential_stiffness"),
                                      .friction_angle = number(law, "friction_angle")}));
  }
  if (type == "HertzMindlin") {
    const dem::Elastic elastic{.young_modulus = number(law, "young_modulus"),
                               .poisson_ratio = number(law, "poisson_ratio")};
    return make_grain_simulation(
        setup,
        HertzMindlin(
            dem::Hertz{.elastic = elastic, .restitution = number(law, "restitution")},
            dem::Mindlin{.elastic = elastic, .friction_angle = number(law, "friction_angle")}));
  }
  fail("grain_simulation: law is a " + type +
       "; give a CundallStrack, a LinearSpringDashpot or a HertzMindlin");
}

// The arrays have been checked by the package.
struct GrainArguments {
  Doubles position, velocity, radius, density;
  py::object law;
  py::list walls;
  Doubles gravity;
  double damping;
  py::object box;
  double steps_per_contact;
  double max_overlap;
};

template <int Dim>
std::unique_ptr<AnySimulation> grains(const GrainArguments& given) {
  GrainSetup<Dim> setup{
      .positions = rows_of(given.position),
      .velocities = rows_of(given.velocity),
      .radii = numbers_of(given.radius),
      .densities = numbers_of(given.density),
      .walls = {},
      .gravity = to_vector<Dim>("grain_simulation: gravity", numbers_of(given.gravity)),
      .damping = given.damping,
      .box = box_of<Dim>(given.box),
      .settings = {.steps_per_contact = given.steps_per_contact, .max_overlap = given.max_overlap}};
  for (const auto wall : given.walls) {
    setup.walls.push_back(wall_of<Dim>(wall, setup.walls.size()));
  }
  return grains(given.law, setup);
}

template <int Dim>
std::unique_ptr<AnySimulation> flow(FlowSetup<Dim> setup, const std::optional<Doubles>& gravity) {
  if (gravity) setup.gravity = to_vector<Dim>("flow_simulation: gravity", numbers_of(*gravity));
  return make_flow_simulation(setup);
}

template <int Dim>
py::array lattice_of(const std::vector<double>& lower, const std::vector<double>& upper,
                     double spacing) {
  const auto points = lattice<Dim>({.lower = to_vector<Dim>("lattice: lower", lower),
                                    .upper = to_vector<Dim>("lattice: upper", upper)},
                                   spacing);
  py::array_t<double> array({py::ssize_t(points.size()), py::ssize_t(Dim)});
  double* to = array.mutable_data();
  for (const Vec<Dim>& x : points) to = std::copy(x.begin(), x.end(), to);
  return array;
}

py::dict dict_of(const std::vector<ColumnCopy>& columns) {
  py::dict all;
  for (const ColumnCopy& column : columns) {
    const py::dtype number = dtype_of(column.field);
    std::vector<py::ssize_t> shape{py::ssize_t(column.size)};
    if (column.field.components > 0) shape.push_back(column.field.components);
    py::array array(number, shape);
    if (!column.bytes.empty()) {
      std::memcpy(array.mutable_data(), column.bytes.data(), column.bytes.size());
    }
    all[py::str(column.field.name)] = std::move(array);
  }
  return all;
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const py::object type = py::module_::import("silt.error").attr("Error");
    const py::object made = type(error.what());
    const Where& where = error.where();
    made.attr("id") = where.id;
    made.attr("step") = where.step;
    made.attr("time") = where.time;
    PyErr_SetObject(type.ptr(), made.ptr());
  }
}

}  // namespace
}  // namespace silt::python

PYBIND11_MODULE(_silt, module) {
  using namespace silt;
  using namespace silt::python;
  using namespace pybind11::literals;

  py::register_exception_translator(translate);
  module.attr("version") = SILT_VERSION;
  module.attr("max_walls") = max_walls;

  py::class_<VtkSeries>(module, "VtkSeries")
      .def(py::init<std::filesystem::path>())
      .def_property_readonly("frames", &VtkSeries::frames);

  py::class_<Core, std::shared_ptr<Core>>(module, "Core")
      .def_property_readonly("dimension",
                             [](Core& core) { return core.use("dimension").dimension(); })
      .def_property_readonly("size", [](Core& core) { return core.use("size").size(); })
      .def_property_readonly("time", [](Core& core) { return core.use("time").time(); })
      .def_property_readonly("steps", [](Core& core) { return core.use("steps").steps(); })
      .def_property_readonly("last_time_step",
                             [](Core& core) { return core.use("last_time_step").last_time_step(); })
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
      .def("time_step", [](Core& core) { return core.use("time_step").time_step(); })
      .def("step", &Core::step)
      .def("run",
           [](Core& core, double until, double output_every, std::optional<double> time_step,
              bool end_exactly, const py::object& observer) {
             core.run({.until = until,
                       .output_every = output_every,
                       .time_step = time_step,
                       .end_exactly = end_exactly},
                      observer);
           })
      .def("remove",
           [](Core& core, const std::vector<Id>& ids) { core.change("remove").remove(ids); })
      .def("energies",
           [](Core& core) {
             py::dict all;
             for (const auto& [name, value] : core.use("energies").energies()) {
               all[py::str(name)] = value;
             }
             return all;
           })
      .def("write_frame",
           [](Core& core, VtkSeries& frames) { core.use("write_frame").write_frame(frames); })
      .def("write_checkpoint",
           [](Core& core, const std::filesystem::path& path) {
             core.use("write_checkpoint").write_checkpoint(path);
           })
      .def("read_checkpoint",
           [](Core& core, const std::filesystem::path& path) { core.read_checkpoint(path); })
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
      .def("front",
           [](Core& core) {
             const Front front = core.use("front").front();
             return std::pair{front.x, front.height};
           })
      .def("wall_pressure",
           [](Core& core, const std::vector<double>& point, const std::vector<double>& normal) {
             return core.use("wall_pressure").wall_pressure(point, normal);
           });

  module.def("grains", [](const Doubles& x, const Doubles& u, const Doubles& R,
                          const Doubles& density, const py::object& law, const py::list& walls,
                          const Doubles& gravity, double damping, const py::object& box,
                          double steps_per_contact, double max_overlap) {
    const GrainArguments given{x,       u,       R,   density,           law,        walls,
                               gravity, damping, box, steps_per_contact, max_overlap};
    return std::make_shared<Core>(x.shape(1) == 2 ? grains<2>(given) : grains<3>(given));
  });
  module.def(
      "flow", [](const Doubles& x, const Doubles& u, const std::vector<double>& tank, bool lid,
                 bool removes_escaped, double spacing, double density, double viscosity,
                 double speed_scale, const std::optional<Doubles>& gravity) {
        const auto make = [&]<int Dim>(std::integral_constant<int, Dim>) {
          return flow<Dim>({.positions = rows_of(x),
                            .velocities = rows_of(u),
                            .tank = tank,
                            .lid = lid,
                            .on_escape = removes_escaped ? OnEscape::remove : OnEscape::refuse,
                            .spacing = spacing,
                            .density = density,
                            .viscosity = viscosity,
                            .speed_scale = speed_scale},
                           gravity);
        };
        return std::make_shared<Core>(x.shape(1) == 2 ? make(std::integral_constant<int, 2>())
                                                      : make(std::integral_constant<int, 3>()));
      });
  module.def("lattice", [](const std::vector<double>& lower, const std::vector<double>& upper,
                           double spacing) {
    return lower.size() == 2 ? lattice_of<2>(lower, upper, spacing)
                             : lattice_of<3>(lower, upper, spacing);
  });
  module.def("use_threads", &use_threads);
  py::module_::import("atexit").attr("register")(py::cpp_function(&AtExit::stop_others));
}
