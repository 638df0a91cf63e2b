// SPDX-License-Identifier: MIT
// The processes of a program.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <string>
#include <thread>

namespace silt::mpi {

namespace detail {
/// Throws if a call of MPI failed.
inline void check(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  MPI_Error_string(code, text, &length);
  fail(std::string("mpi: ") + call + " failed: " + text + "; end the job and start it again");
}
}  // namespace detail

/// All processes that mpirun has started. One object, declared first in main(), which calls MPI_Init
/// unless that was done, and MPI_Finalize at its end. What it is given to must not outlive it.
class World {
 public:
  World() : World(MPI_COMM_WORLD) {}
  /// Those of a communicator of the program. Other than that of all processes, it can only be given
  /// after MPI_Init. Throws if MPI has ended, or was initialised for a single thread.
  explicit World(MPI_Comm processes) {
    int is_initialised = 0;
    MPI_Initialized(&is_initialised);
    int is_finalised = 0;
    MPI_Finalized(&is_finalised);
    if (is_finalised != 0) fail("mpi::World: MPI has ended; make one World, at the beginning of main()");
    if (is_initialised == 0) {
      int level = 0;
      detail::check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level),
                    "MPI_Init_thread");
      finalizes_ = true;
    }
    int level = 0;
    MPI_Query_thread(&level);
    if (level < MPI_THREAD_FUNNELED) {
      fail("mpi::World: MPI was initialised for a single thread; call MPI_Init_thread with "
           "MPI_THREAD_FUNNELED, or leave it to mpi::World");
    }
    // Own messages, apart from those of the program.
    detail::check(MPI_Comm_dup(processes, &communicator_), "MPI_Comm_dup");
    MPI_Comm_set_errhandler(communicator_, MPI_ERRORS_RETURN);
    MPI_Comm_rank(communicator_, &rank_);
    MPI_Comm_size(communicator_, &size_);
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  ~World() {
    // With an exception that the others do not have, they do not come here.
    if (std::uncaught_exceptions() > 0 && !all_processes_end()) return;
    MPI_Comm_free(&communicator_);
    if (finalizes_) MPI_Finalize();
  }

  int rank() const noexcept { return rank_; }  ///< of this process, from 0 on
  int size() const noexcept { return size_; }  ///< number of processes
  /// Whether this is the process that writes files and messages: the first.
  bool is_first() const noexcept { return rank_ == 0; }
  /// For calls of MPI: a duplicate of the communicator given.
  MPI_Comm communicator() const noexcept { return communicator_; }

  /// What this process has sent so far to others in steps: `messages` of so many `bytes`, and
  /// `reductions` of all processes.
  struct Traffic {
    std::uint64_t messages = 0;
    std::uint64_t bytes = 0;
    std::uint64_t reductions = 0;
    double seconds = 0;  ///< taken by these, with waiting for others [s]
  };
  Traffic& traffic() const noexcept { return traffic_; }

  /// Of the agreements of its processes, see agreement.hpp.
  struct Faults {
    std::exception_ptr reported;  ///< which the next agreement throws in all
    std::exception_ptr of_all;    ///< the last one that all processes have thrown
  };
  Faults& faults() const noexcept { return faults_; }

  // Of the values of all processes, in all processes. To be called by all; they throw in all if one has
  // failed in a run or a step. Defined in agreement.hpp.

  /// Sum of the values of all processes.
  double sum(double value) const;
  /// The largest of the values of all processes.
  double max(double value) const;
  /// The smallest of the values of all processes.
  double min(double value) const { return -max(-value); }
  /// Modulo 2⁶⁴.
  std::uint64_t sum(std::uint64_t value) const;

 private:
  bool all_processes_end() const {
    MPI_Request request;
    if (MPI_Ibarrier(communicator_, &request) != MPI_SUCCESS) return false;
    int is_done = 0;
    for (int k = 0; k < 200 && is_done == 0; ++k) {
      MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
      if (is_done == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return is_done != 0;
  }

  MPI_Comm communicator_ = MPI_COMM_NULL;
  int rank_ = 0;
  int size_ = 1;
  bool finalizes_ = false;
  mutable Faults faults_;
  mutable Traffic traffic_;
};

}  // namespace silt::mpi

#include <silt/mpi/agreement.hpp>
