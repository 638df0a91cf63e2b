// SPDX-License-Identifier: MIT
// Processes that do something together: if one fails, all throw, and none waits for another.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/world.hpp>

#include <mpi.h>

#include <algorithm>
#include <array>
#include <exception>
#include <limits>
#include <new>
#include <optional>
#include <string>

namespace silt::mpi {

/// All reductions have one shape, so that a process which fails meets the others in the next one.
template <Index N>
class Agreement {
 public:
  explicit Agreement(const World& world) : world_(&world) {}

  /// f() returns N numbers; returns the largest of all processes. Throws in all if f() does in one:
  /// there what f() threw, elsewhere an Error with its message.
  template <class F>
  std::array<double, N> operator()(F&& f) {
    std::array<double, N> own;
    own.fill(-std::numeric_limits<double>::infinity());
    std::exception_ptr fault = std::exchange(reported_, nullptr);
    is_agreed_ = false;
    if (!fault) {
      try {
        own = f();
      } catch (...) {
        if (is_agreed_) throw;  // by an agreement within f()
        fault = std::current_exception();
      }
    }
    return agree(own, fault);
  }
  /// The next agreement throws.
  void report(std::exception_ptr fault) {
    if (!reported_) reported_ = fault;
  }

 private:
  std::array<double, N> agree(const std::array<double, N>& own, const std::exception_ptr& fault) {
    // The first process that failed, and the shortest of their stable time steps.
    std::array<double, N + 2> sent, received;
    std::copy(own.begin(), own.end(), sent.begin());
    const std::optional<double> stable = stable_time_step_of(fault);
    sent[N] = fault ? world_->size() - world_->rank() : 0;
    sent[N + 1] = stable ? -*stable : -std::numeric_limits<double>::infinity();
    detail::check(MPI_Allreduce(sent.data(), received.data(), int(N + 2), MPI_DOUBLE, MPI_MAX,
                                world_->communicator()),
                  "MPI_Allreduce");
    if (received[N] > 0) {
      is_agreed_ = true;
      rethrow(fault, world_->size() - int(received[N]), -received[N + 1]);
    }
    std::array<double, N> largest;
    std::copy_n(received.begin(), N, largest.begin());
    return largest;
  }

  static std::optional<double> stable_time_step_of(const std::exception_ptr& fault) {
    try {
      if (fault) std::rethrow_exception(fault);
    } catch (const Error& error) {
      return error.stable_time_step();
    } catch (...) {
    }
    return std::nullopt;
  }
  [[noreturn]] void rethrow(const std::exception_ptr& fault, int first, double stable) const {
    std::string message;
    int has_stable = 0;
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
  std::exception_ptr reported_;
  bool is_agreed_ = false;
};

}  // namespace silt::mpi
