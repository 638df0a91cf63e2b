// SPDX-License-Identifier: MIT
// Which rows of particles a process sends to others, and which it receives from them.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/messages.hpp>
#include <silt/mpi/world.hpp>

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace silt::mpi {

/// The rows of a halo, and of the particles that it has copies of, process by process.
class HaloRows {
 public:
  /// A process with particles near some of ours.
  struct Partner {
    int process;
    std::vector<std::uint32_t> sent;  ///< rows of ours, in its halo
    Index first_received = 0;         ///< row of our halo
    Index received = 0;               ///< number of rows of our halo
  };

  /// There are no partners yet.
  HaloRows(const World& world, const Agreement& agree) : world_(&world), agree_(agree) {}

  /// The processes with which rows are exchanged.
  std::vector<Partner>& partners() noexcept { return partners_; }
  const std::vector<Partner>& partners() const noexcept { return partners_; }
  /// The partner with this process; a new one, without rows, if there is none.
  Partner& partner_with(int process) {
    for (Partner& each : partners_) {
      if (each.process == process) return each;
    }
    return partners_.emplace_back(Partner{process, {}});
  }
  /// After the rows order[i] have become the rows i.
  void reorder(std::span<const Index> order) {
    std::vector<std::uint32_t> now(order.size());
    for (Index i = 0; i < order.size(); ++i) now[order[i]] = std::uint32_t(i);
    for (Partner& each : partners_) {
      for (std::uint32_t& i : each.sent) i = now[i];
    }
  }

  /// Gives get(i), a T, of own rows to the processes in whose halo they are: set(row, value). check() may
  /// throw, in one process or several.
  template <class T, class Get, class Set, class Check>
  void exchange(const Get& get, const Set& set, const Check& check) const {
    exchange<T>(OwnRows{}, RowsOfHalo{}, get, set, check);
  }
  /// Gives get(row) of rows of the halo to the processes that own them: set(i, value).
  template <class T, class Get, class Set, class Check>
  void exchange_back(const Get& get, const Set& set, const Check& check) const {
    exchange<T>(RowsOfHalo{}, OwnRows{}, get, set, check);
  }

  /// Exchanges elements of vectors, for which all memory is there.
  class ElementExchange {
   public:
    /// Gives the elements of own rows to the elements of the halo of others. After an agreement; throws
    /// nothing but errors of MPI.
    void operator()(std::vector<double>& x) {
      for (Index k = 0; k < partners_.size(); ++k) {
        std::byte* to = transfers_[k].to.data();
        for (const Index place : partners_[k].sent) {
          std::memcpy(to, &x[place], sizeof(double));
          to += sizeof(double);
        }
      }
      do_transfers(*world_, transfers_, requests_);
      for (Index k = 0; k < partners_.size(); ++k) {
        const std::byte* from = transfers_[k].from.data();
        for (const Index place : partners_[k].received) {
          std::memcpy(&x[place], from, sizeof(double));
          from += sizeof(double);
        }
      }
    }

   private:
    friend class HaloRows;
    struct Places {
      std::vector<Index> sent, received;
    };

    const World* world_ = nullptr;
    std::vector<Places> partners_;
    std::vector<Transfer> transfers_;
    std::vector<MPI_Request> requests_;
  };
  /// For vectors in which place_of(row) is the element of a row, own or of the halo, or no_index, in all
  /// processes that have it.
  template <class PlaceOf>
  ElementExchange elements(const PlaceOf& place_of) const {
    ElementExchange exchange;
    exchange.world_ = world_;
    agree_([&] {
      for (const Partner& each : partners_) {
        const auto places = [&](const auto& rows) {
          std::vector<Index> found;
          for (Index k = 0; k < rows.count(each); ++k) {
            const Index place = place_of(rows.row(each, k));
            if (place != no_index) found.push_back(place);
          }
          return found;
        };
        const auto& all =
            exchange.partners_.emplace_back(typename ElementExchange::Places{
                places(OwnRows{}), places(RowsOfHalo{})});
        const int to = detail::count_of(all.sent.size() * sizeof(double));
        const int from = detail::count_of(all.received.size() * sizeof(double));
        exchange.transfers_.push_back({each.process, Bytes(Index(to)), Bytes(Index(from))});
      }
      exchange.requests_.reserve(2 * partners_.size());
      return Reduced();
    });
    return exchange;
  }

  /// Memory for refresh(), with so many bytes for each row.
  void prepare_refresh(Index bytes) {
    transfers_ = transfers(OwnRows{}, RowsOfHalo{}, bytes);
    requests_.reserve(2 * partners_.size());
  }
  /// write(to, rows) writes the bytes of own rows, read(from, partner) those received from a partner.
  /// After an agreement; throws nothing but errors of MPI.
  template <class Write, class Read>
  void refresh(const Write& write, const Read& read) {
    for (Index k = 0; k < partners_.size(); ++k) write(transfers_[k].to.data(), partners_[k].sent);
    do_transfers(*world_, transfers_, requests_);
    for (Index k = 0; k < partners_.size(); ++k) read(transfers_[k].from, partners_[k]);
  }

 private:
  struct OwnRows {
    Index count(const Partner& each) const { return each.sent.size(); }
    Index row(const Partner& each, Index k) const { return each.sent[k]; }
  };
  struct RowsOfHalo {
    Index count(const Partner& each) const { return each.received; }
    Index row(const Partner& each, Index k) const { return each.first_received + k; }
  };

  template <class Sent, class Received>
  std::vector<Transfer> transfers(const Sent& sent, const Received& received, Index bytes) const {
    std::vector<Transfer> all;
    for (const Partner& each : partners_) {
      const int to = detail::count_of(sent.count(each) * bytes);
      const int from = detail::count_of(received.count(each) * bytes);
      all.push_back({each.process, Bytes(Index(to)), Bytes(Index(from))});
    }
    return all;
  }

  template <class T, class Sent, class Received, class Get, class Set, class Check>
  void exchange(const Sent& sent, const Received& received, const Get& get, const Set& set,
                const Check& check) const {
    std::vector<Transfer> all;
    std::vector<MPI_Request> requests;
    agree_([&] {
      check();
      all = transfers(sent, received, sizeof(T));
      requests.reserve(2 * partners_.size());
      return Reduced();
    });
    for (Index k = 0; k < partners_.size(); ++k) {
      std::byte* to = all[k].to.data();
      for (Index n = 0; n < sent.count(partners_[k]); ++n, to += sizeof(T)) {
        const T value = get(sent.row(partners_[k], n));
        std::memcpy(to, static_cast<const void*>(&value), sizeof(T));
      }
    }
    do_transfers(*world_, all, requests);
    for (Index k = 0; k < partners_.size(); ++k) {
      const std::byte* from = all[k].from.data();
      for (Index n = 0; n < received.count(partners_[k]); ++n, from += sizeof(T)) {
        T value;
        std::memcpy(static_cast<void*>(&value), from, sizeof(T));
        set(received.row(partners_[k], n), value);
      }
    }
  }

  const World* world_;
  Agreement agree_;
  std::vector<Partner> partners_;
  std::vector<Transfer> transfers_;  // of refresh()
  std::vector<MPI_Request> requests_;
};

}  // namespace silt::mpi
