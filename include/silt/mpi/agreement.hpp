// SPDX-License-Identifier: MIT
// Processes that do something together: if one fails, all throw, and none waits for another.
//
// A process that fails leaves what it was doing and meets the others in their next agreement. Hence
// all agreements are reductions of one shape, and every other communication follows an agreement
// after which no process can fail before it.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/world.hpp>

#include <mpi.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace silt::mpi {

/// What an agreement reduces: some numbers to their largest, others to their sum.
struct Reduced {
  static constexpr Index count = 12;

  std::array<double, count> largest;
  std::array<double, count> sum{};

  Reduced() { largest.fill(-std::numeric_limits<double>::infinity()); }
};

class Agreement {
 public:
  explicit Agreement(const World& world) : world_(&world) {}

  /// f() returns a Reduced; returns that of all processes. Throws in all if f() does in one: there
  /// what f() threw, elsewhere an Error with its message. f() may contain other agreements.
  template <class F>
  Reduced operator()(F&& f) const {
    Reduced own;
    std::exception_ptr fault = std::exchange(world_->faults().reported, nullptr);
    world_->faults().have_all_thrown = false;
    if (!fault) {
      try {
        own = f();
      } catch (...) {
        if (world_->faults().have_all_thrown) throw;  // in an agreement within f()
        fault = std::current_exception();
      }
    }
    return agree(own, fault);
  }
  /// The same without numbers.
  void operator()() const {
    (*this)([] { return Reduced(); });
  }
  /// The next agreement throws.
  void report(std::exception_ptr fault) const {
    if (!world_->faults().reported) world_->faults().reported = std::move(fault);
  }

 private:
  // As it is reduced: first the largest, then the sums.
  struct Message {
    double failed = 0;  // number of processes, minus the rank, of the first one that failed
    double minus_stable_time_step = -std::numeric_limits<double>::infinity();  // the shortest [s]
    Reduced numbers;
  };
  static constexpr int numbers_of_message = 2 + 2 * int(Reduced::count);
  static_assert(sizeof(Message) == std::size_t(numbers_of_message) * sizeof(double));

  Reduced agree(const Reduced& own, const std::exception_ptr& fault) const {
    Message sent, received;
    sent.numbers = own;
    if (fault) {
      sent.failed = world_->size() - world_->rank();
      if (const auto stable = stable_time_step_of(fault)) sent.minus_stable_time_step = -*stable;
    }
    ++world_->traffic().reductions;
    const Operation operation;
    const double begin = MPI_Wtime();
    detail::check(MPI_Allreduce(&sent, &received, 1, operation.type, operation.reduce,
                                world_->communicator()),
                  "MPI_Allreduce");
    world_->traffic().seconds += MPI_Wtime() - begin;
    if (received.failed > 0) {
      world_->faults().have_all_thrown = true;
      rethrow(fault, world_->size() - int(received.failed), -received.minus_stable_time_step);
    }
    return received.numbers;
  }

  // Made for each reduction, which takes no time to speak of, so that none is left at the end.
  struct Operation {
    MPI_Datatype type = MPI_DATATYPE_NULL;
    MPI_Op reduce = MPI_OP_NULL;

    Operation() {
      MPI_Type_contiguous(numbers_of_message, MPI_DOUBLE, &type);
      MPI_Type_commit(&type);
      MPI_Op_create(
          [](void* from, void* into, int* length, MPI_Datatype*) {
            const auto* const in = static_cast<const Message*>(from);
            auto* const out = static_cast<Message*>(into);
            for (int k = 0; k < *length; ++k) add(in[k], out[k]);
          },
          1, &reduce);
    }
    Operation(const Operation&) = delete;
    Operation& operator=(const Operation&) = delete;
    ~Operation() {
      MPI_Op_free(&reduce);
      MPI_Type_free(&type);
    }
  };
  // NaN if one is, so that the order does not matter.
  static void raise(double& to, double more) {
    if (std::isnan(more) || more > to) to = more;
  }
  static void add(const Message& more, Message& to) {
    raise(to.failed, more.failed);
    raise(to.minus_stable_time_step, more.minus_stable_time_step);
    for (Index k = 0; k < Reduced::count; ++k) {
      raise(to.numbers.largest[k], more.numbers.largest[k]);
      to.numbers.sum[k] += more.numbers.sum[k];
    }
  }

  static std::optional<double> stable_time_step_of(const std::exception_ptr& fault) {
    try {
      std::rethrow_exception(fault);
    } catch (const Error& error) {
      return error.stable_time_step();
    } catch (...) {
      return std::nullopt;
    }
  }
  [[noreturn]] void rethrow(const std::exception_ptr& fault, int first, double stable) const {
    std::string message;
    bool has_stable = false;
    try {
      if (fault) std::rethrow_exception(fault);
    } catch (const Error& error) {
      message = error.what();
      has_stable = error.stable_time_step().has_value();
    } catch (const std::exception& error) {
      message = error.what();
    } catch (...) {
      message = "an exception of an unknown type";
    }
    std::array<std::uint64_t, 2> header{message.size(), std::uint64_t(has_stable)};
    MPI_Bcast(header.data(), 2, MPI_UINT64_T, first, world_->communicator());
    message.resize(header[0]);
    MPI_Bcast(message.data(), int(message.size()), MPI_CHAR, first, world_->communicator());
    const auto common = header[1] != 0 ? std::optional(stable) : std::nullopt;
    if (fault) {
      try {
        std::rethrow_exception(fault);
      } catch (const Error& error) {
        throw error.with_stable_time_step(common);
      }
    }
    throw Error("process " + std::to_string(first) + ": " + message, {}, common);
  }

  const World* world_;
};

}  // namespace silt::mpi
