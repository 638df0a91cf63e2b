// SPDX-License-Identifier: MIT
// A simulation, as Python uses it, or two in one. It guarantees that
//
// - no step is made, and no particle added, removed or reordered, while an array refers to the
//   memory of the particles;
// - caches of the simulation notice whatever was written through an array, because the access that
//   they notice is repeated when the array is deleted, which is before the next step;
// - no other thread has access during a step or run.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/run.hpp>
#include <silt/core/types.hpp>
#include <silt/io/checkpoint.hpp>

#include "any_simulation.hpp"
#include "arrays.hpp"
#include "interpreter_lock.hpp"
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <chrono>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace silt::python {

namespace py = pybind11;

/// An array that refers to the memory of a field.
struct Loan {
  AnySimulation* simulation;
  std::string field;
  bool is_written;
  std::uint64_t step;
};

/// Who uses a simulation; two in one and their parts have it in common.
struct Usage {
  std::list<Loan> loans;
  std::optional<unsigned long> runner;  ///< thread of the step or run
  bool is_in_observer = false;
};

// A simulation, and who uses it. All members are read and written with the interpreter's lock,
// except the simulation itself during a step or run. `Any` is an AnyAdvancing.
template <class Any>
class CoreOf : public std::enable_shared_from_this<CoreOf<Any>> {
 public:
  explicit CoreOf(std::unique_ptr<Any> simulation,
                  std::shared_ptr<Usage> usage = std::make_shared<Usage>())
      : simulation_(std::move(simulation)), usage_(std::move(usage)) {}

  /// To read it, or to change it between steps.
  Any& use(const std::string& function) {
    const auto& runner = usage_->runner;
    if (runner && *runner == this_thread() && !usage_->is_in_observer) {
      fail(full_name(function) +
           ": a motion or a load must not use the simulation whose step calls it; it is a function "
           "of its arguments alone");
    }
    if (runner && *runner != this_thread()) {
      fail(full_name(function) +
           ": a step or run is in progress in another thread; wait for its end");
    }
    // The measures may cache what is written to these.
    for (const Loan& loan : usage_->loans) note_written(loan);
    return *simulation_;
  }

  /// To change particles so that their memory may be moved.
  Any& change(const std::string& function) {
    Any& simulation = use(function);
    require_no_views(full_name(function));
    return simulation;
  }

  /// call(simulation), in which the time may change, or the simulation becomes another one.
  template <class Call>
  auto advance(const std::string& function, Call&& call) {
    const Running running(*this, function);
    return call(*simulation_);
  }

  py::array view(const std::string& field, bool is_written) {
    AnySimulation& simulation = use("view");
    const ColumnMemory memory = simulation.column(field, is_written);
    auto borrower = std::make_unique<Borrower>(
        this->shared_from_this(), Loan{&simulation, field, is_written, simulation.steps()});
    const py::capsule owner(borrower.get(),
                            [](void* pointer) { delete static_cast<Borrower*>(pointer); });
    static_cast<void>(borrower.release());
    py::array array = array_of(memory, owner);
    if (!is_written) array.attr("flags").attr("writeable") = false;
    return array;
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
  /// Belongs to such an array, and ends with it and all that refer to it.
  class Borrower {
   public:
    Borrower(std::shared_ptr<CoreOf> core, Loan loan)
        : core_(std::move(core)), loan_(loans().insert(loans().end(), std::move(loan))) {}
    Borrower(const Borrower&) = delete;
    Borrower& operator=(const Borrower&) = delete;
    ~Borrower() {
      note_written(*loan_);
      loans().erase(loan_);
    }

   private:
    std::list<Loan>& loans() const { return core_->usage_->loans; }

    std::shared_ptr<CoreOf> core_;
    std::list<Loan>::iterator loan_;
  };

  /// A step, run or other change of the time, as long as it lasts.
  class Running {
   public:
    Running(CoreOf& core, const std::string& function) : runner_(core.usage_->runner) {
      if (runner_ && *runner_ == this_thread()) {
        fail(full_name(function) +
             ": an observer must not advance or replace the simulation that calls it; do this "
             "after the run");
      }
      core.change(function);
      runner_ = this_thread();
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;
    ~Running() { runner_.reset(); }

   private:
    std::optional<unsigned long>& runner_;
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
    Observers(CoreOf& core, const py::object& observer) : core_(core), observer_(observer) {}
    void make_output() override {
      with_lock([&] {
        core_.usage_->is_in_observer = true;
        PyObject* const result = PyObject_CallNoArgs(observer_.ptr());
        core_.usage_->is_in_observer = false;
        if (result == nullptr) throw py::error_already_set();
        Py_DECREF(result);
        core_.require_no_views(full_name("run") + ": after an observer was called");
      });
    }

   private:
    CoreOf& core_;
    const py::object& observer_;
  };

  static unsigned long this_thread() { return PyThread_get_thread_ident(); }
  static std::string full_name(const std::string& function) {
    return std::string(Any::class_name) + "." + function;
  }

  void require_no_views(const std::string& where) const {
    const auto& loans = usage_->loans;
    if (loans.empty()) return;
    const Loan& first = loans.front();
    fail(where + ": an array still refers to the memory of the field \"" + first.field +
         "\", which a step may change or move; it was taken by view() at step " +
         std::to_string(first.step) +
         (loans.size() > 1 ? ", and so do " + std::to_string(loans.size() - 1) + " more" : "") +
         ". Delete the array and all slices of it, or use a copy, simulation[\"" + first.field +
         "\"][:]");
  }
  static void note_written(const Loan& loan) {
    if (loan.is_written) static_cast<void>(loan.simulation->column(loan.field, true));
  }

  std::unique_ptr<Any> simulation_;
  std::shared_ptr<Usage> usage_;
};

using Core = CoreOf<AnySimulation>;

}  // namespace silt::python
