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

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace silt::mpi {

/// What an agreement reduces: some numbers to their largest, others to their sum.
struct Reduced {
  static constexpr Index count = 12;  ///< [-] of each kind

  std::array<double, count> largest;
  std::array<double, count> sum{};

  Reduced() { largest.fill(-std::numeric_limits<double>::infinity()); }
};

/// What all processes are doing in an agreement.
enum class Doing {
  communication,  ///< values of others are received
  step,           ///< a step is made, or a file is read or written
  state,          ///< snapshot() or state() is asked for
  sum,            ///< a sum of all processes is formed, as by measures
  largest,        ///< the largest value of all processes is found, as by measures
};

/// Reductions over all processes of a World, in which all learn whether one has failed.
class Agreement {
 public:
  /// The World must exist as long as it is used.
  explicit Agreement(const World& world) : world_(&world) {}

  /// f() returns a Reduced; returns that of all processes. Throws in all if f() does in one: there
  /// what f() threw, elsewhere an Error with its message. f() may contain other agreements.
  template <class F>
  Reduced operator()(F&& f, Doing doing = Doing::communication) const {
    Reduced own;
    std::exception_ptr fault = std::exchange(world_->faults().reported, nullptr);
    if (!fault) {
      try {
        own = f();
      } catch (...) {
        fault = std::current_exception();
        if (have_all_thrown(fault)) throw;  // in an agreement within f()
      }
    }
    return agree(own, fault, doing);
  }
  /// The same without numbers.
  void operator()() const {
    (*this)([] { return Reduced(); });
  }
  /// The sums of numbers of all processes.
  template <std::size_t N>
  std::array<double, N> sum(const std::array<double, N>& own) const {
    return reduce(&Reduced::sum, own, Doing::sum);
  }
  /// Of each of the numbers the largest of all processes.
  template <std::size_t N>
  std::array<double, N> largest(const std::array<double, N>& own) const {
    return reduce(&Reduced::largest, own, Doing::largest);
  }
  /// Whether all processes have thrown when this one did.
  bool have_all_thrown(const std::exception_ptr& fault) const {
    if (fault == world_->faults().of_all) return true;
    try {
      std::rethrow_exception(fault);
    } catch (const Error& error) {
      return error.is_of_all();
    } catch (...) {
      return false;
    }
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
    // Last and first of what the processes do that did not fail.
    double doing = -std::numeric_limits<double>::infinity();
    double minus_doing = -std::numeric_limits<double>::infinity();
    Reduced numbers;
  };
  static constexpr int numbers_of_message = 4 + 2 * int(Reduced::count);
  static_assert(sizeof(Message) == std::size_t(numbers_of_message) * sizeof(double));

  template <std::size_t N>
    requires(N <= Reduced::count)
  std::array<double, N> reduce(std::array<double, Reduced::count> Reduced::*numbers,
                               const std::array<double, N>& own, Doing doing) const {
    const auto of_this_process = [&] {
      Reduced reduced;
      std::ranges::copy(own, (reduced.*numbers).begin());
      return reduced;
    };
    const Reduced all = (*this)(of_this_process, doing);
    std::array<double, N> result;
    std::copy_n((all.*numbers).begin(), N, result.begin());
    return result;
  }

  Reduced agree(const Reduced& own, const std::exception_ptr& fault, Doing doing) const {
    Message sent, received;
    sent.numbers = own;
    if (fault) {
      sent.failed = world_->size() - world_->rank();
      if (const auto stable = stable_time_step_of(fault)) sent.minus_stable_time_step = -*stable;
    } else {
      sent.doing = double(doing);
      sent.minus_doing = -sent.doing;
    }
    ++world_->traffic().reductions;
    const Operation operation;
    const double begin = MPI_Wtime();
    detail::check(MPI_Allreduce(&sent, &received, 1, operation.type, operation.reduce,
                                world_->communicator()),
                  "MPI_Allreduce");
    world_->traffic().seconds += MPI_Wtime() - begin;
    const bool has_failed = received.failed > 0;
    if (!has_failed && received.doing == -received.minus_doing) return received.numbers;
    try {
      if (!has_failed) fail_in_different(Doing(int(-received.minus_doing)), Doing(int(received.doing)));
      rethrow(fault, world_->size() - int(received.failed), -received.minus_stable_time_step);
    } catch (...) {
      world_->faults().of_all = std::current_exception();
      throw;
    }
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
    raise(to.doing, more.doing);
    raise(to.minus_doing, more.minus_doing);
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
  [[noreturn]] static void fail_in_different(Doing first, Doing last) {
    const auto name = [](Doing doing) -> std::string {
      switch (doing) {
        case Doing::communication: return "receives values of others";
        case Doing::step: return "makes a step, or reads or writes a file";
        case Doing::state: return "asks for snapshot() or state()";
        case Doing::sum: return "forms a sum of all processes, as measures do";
        case Doing::largest: return "finds the largest value of all processes, as measures do";
      }
      return "does something else";
    };
    throw Error("mpi: one process " + name(first) + ", while another " + name(last) +
                "; call step(), run(), snapshot() and measures in all processes, in the same order")
        .of_all({});
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
        throw error.of_all(common);
      }
    }
    throw Error("process " + std::to_string(first) + ": " + message).of_all(common);
  }

  const World* world_;
};

inline double World::sum(double value) const { return Agreement(*this).sum(std::array{value})[0]; }
inline double World::max(double value) const {
  return Agreement(*this).largest(std::array{value})[0];
}
inline std::uint64_t World::sum(std::uint64_t value) const {
  // Of halves, whose sums are exact.
  constexpr std::uint64_t half = std::uint64_t(1) << 32;
  const auto all =
      Agreement(*this).sum(std::array{double(value / half), double(value % half)});
  return std::uint64_t(all[0]) * half + std::uint64_t(all[1]);
}

}  // namespace silt::mpi
