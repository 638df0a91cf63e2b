// SPDX-License-Identifier: MIT
// Messages of bytes between processes.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/world.hpp>

#include <mpi.h>

#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace silt::mpi {

/// Values one behind the other, as a Writer adds them.
using Bytes = std::vector<std::byte>;

/// Adds values to bytes, and takes them out in the same order. Values are copied as they lie in
/// memory: all processes must run on machines of one kind.
class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    const auto* const from = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof(T));
  }
  Bytes& bytes() { return bytes_; }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};
/// Takes values out of bytes. Throws if there are too few.
class Reader {
 public:
  /// From the first of the bytes on, which are not copied.
  explicit Reader(std::span<const std::byte> bytes) : left_(bytes) {}
  template <class T>
  void operator()(T& value) {
    if (left_.size() < sizeof(T)) fail("mpi: a message is too short; end the job");
    std::memcpy(static_cast<void*>(&value), left_.data(), sizeof(T));
    left_ = left_.subspan(sizeof(T));
  }
  /// Whether all have been taken out.
  bool is_at_end() const { return left_.empty(); }

 private:
  std::span<const std::byte> left_;
};

namespace detail {
inline int count_of(Index bytes) {
  if (bytes > Index(std::numeric_limits<int>::max())) {
    fail("mpi: a message of " + std::to_string(bytes) +
         " bytes is longer than 2 GB; use more processes");
  }
  return int(bytes);
}
}  // namespace detail

/// Bytes to and from another process.
struct Transfer {
  int process;
  Bytes to = {};
  Bytes from = {};
};

/// Does all transfers. To be called by all processes that take part, after an agreement; throws nothing
/// but errors of MPI if `requests` has memory for two of each.
inline void do_transfers(const World& world, std::span<Transfer> transfers,
                         std::vector<MPI_Request>& requests) {
  constexpr int tag = 1;
  const double begin = MPI_Wtime();
  requests.clear();
  for (Transfer& each : transfers) {
    if (each.from.empty()) continue;
    detail::check(MPI_Irecv(each.from.data(), int(each.from.size()), MPI_BYTE, each.process, tag,
                            world.communicator(), &requests.emplace_back()),
                  "MPI_Irecv");
  }
  for (const Transfer& each : transfers) {
    if (each.to.empty()) continue;
    ++world.traffic().messages;
    world.traffic().bytes += each.to.size();
    detail::check(MPI_Isend(each.to.data(), int(each.to.size()), MPI_BYTE, each.process, tag,
                            world.communicator(), &requests.emplace_back()),
                  "MPI_Isend");
  }
  detail::check(MPI_Waitall(int(requests.size()), requests.data(), MPI_STATUSES_IGNORE),
                "MPI_Waitall");
  world.traffic().seconds += MPI_Wtime() - begin;
}

/// Sends what was written for each process, and returns what others have written for this one: the
/// bytes `from` each process with which it exchanges any. To be called by all, also if nothing was
/// written. Throws in all if a process is out of memory.
inline std::vector<Transfer> exchange_messages(const World& world, const Agreement& agree,
                                               std::vector<Writer>& writers) {
  std::vector<int> sizes, received;
  agree([&] {
    received.resize(Index(world.size()));
    for (const Writer& each : writers) sizes.push_back(detail::count_of(each.bytes().size()));
    return Reduced();
  });
  detail::check(MPI_Alltoall(sizes.data(), 1, MPI_INT, received.data(), 1, MPI_INT,
                             world.communicator()),
                "MPI_Alltoall");
  std::vector<Transfer> messages;
  std::vector<MPI_Request> requests;
  agree([&] {
    for (Index process = 0; process < writers.size(); ++process) {
      if (sizes[process] == 0 && received[process] == 0) continue;
      messages.push_back({int(process), std::move(writers[process].bytes()),
                          Bytes(Index(received[process]))});
    }
    requests.reserve(2 * messages.size());
    return Reduced();
  });
  do_transfers(world, messages, requests);
  return messages;
}

}  // namespace silt::mpi
