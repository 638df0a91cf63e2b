// SPDX-License-Identifier: MIT
// Fuzz target: an input is a sequence of changes of a valid checkpoint, which then gets the
// checksum of its bytes. What is read can be written and read again, with the same bits.
#include <silt/dem.hpp>
#include <silt/mps.hpp>

#include "fuzz/target.hpp"
#include "support/check.hpp"
#include "support/checkpoint_bytes.hpp"
#include "support/restarted_grains.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using namespace silt;
using fuzz::Choices;
using test::Entry;

// A checkpoint in pieces, of which each can be changed without damage to the others.
class Pieces {
 public:
  explicit Pieces(const std::string& text) {
    const auto entries = test::entries_of(text);
    head_ = text.substr(0, entries.front().begins_at);
    for (const Entry& entry : entries) {
      pieces_.push_back({text.substr(entry.begins_at, entry.count_at - entry.begins_at),
                         entry.count, text.substr(entry.values_at, entry.size), entry.value_size});
    }
  }

  std::string joined() const {
    std::string text = head_;
    for (const Piece& piece : pieces_) {
      text += piece.head;
      text.append(reinterpret_cast<const char*>(&piece.count), sizeof piece.count);
      text += piece.values;
    }
    return text;
  }

  void change(Choices& choices) {
    const Index number = place(choices, pieces_.size());
    Piece& piece = pieces_[number];
    switch (choices.below(8)) {
      case 0:
        put(choices, piece, choices.number(0));
        break;
      case 1:
        put(choices, piece, choices.count(0));
        break;
      case 2:
        put(choices, piece, choices.byte());
        break;
      case 3:
        piece.count = choices.count(piece.count + 1);
        break;
      case 4:
        resize(piece, choices.below(64));
        break;
      case 5:
        pieces_.insert(pieces_.begin() + std::ptrdiff_t(number), Piece(piece));
        break;
      case 6:
        if (pieces_.size() > 1) pieces_.erase(pieces_.begin() + std::ptrdiff_t(number));
        break;
      default: {
        const Piece& other = pieces_[place(choices, pieces_.size())];
        const Index size = std::min(piece.values.size(), other.values.size());
        std::copy_n(other.values.begin(), size, piece.values.begin());
      }
    }
  }

 private:
  struct Piece {
    std::string head;  // name and type
    std::uint64_t count;
    std::string values;
    Index value_size;
  };

  static Index place(Choices& choices, Index size) { return choices.raw<std::uint16_t>() % size; }

  template <class T>
  static void put(Choices& choices, Piece& piece, T value) {
    if (piece.values.size() < sizeof value) return;
    const Index at = place(choices, piece.values.size() / sizeof value) * sizeof value;
    std::memcpy(piece.values.data() + at, &value, sizeof value);
  }

  // All pieces with as many values, such as all fields of the particles, change alike.
  void resize(const Piece& piece, Index count) {
    const std::uint64_t before = piece.count;
    for (Piece& each : pieces_) {
      if (each.count != before || each.values.empty()) continue;
      each.count = count;
      const std::string last = each.values.substr(each.values.size() - each.value_size);
      each.values.resize(std::min(each.values.size(), count * each.value_size));
      while (each.values.size() < count * each.value_size) each.values += last;
    }
  }

  std::string head_;
  std::vector<Piece> pieces_;
};

std::string changed(const std::string& good, Choices& choices) {
  Pieces pieces(good);
  while (choices.are_left() && choices.byte() % 8 != 7) pieces.change(choices);
  std::string text = pieces.joined();
  // Bytes anywhere, also of names and types.
  while (choices.are_left() && !text.empty()) {
    const Index at = choices.raw<std::uint16_t>() % text.size();
    switch (choices.below(4)) {
      case 0:
        text[at] = static_cast<char>(choices.byte());
        break;
      case 1:
        text.insert(at, 1, static_cast<char>(choices.byte()));
        break;
      case 2:
        text.erase(at, 1 + choices.below(16));
        break;
      default:
        if (choices.below(16) == 0) text.resize(at + 1);
    }
  }
  return test::with_checksum(text);
}

template <class Run>
bool is_read(const std::string& text, Run& run) {
  bool is_read = false;
  fuzz::require_memory(4, text.size(), [&] {
    is_read = fuzz::accepts([&] {
      std::apply([&](auto&... part) { checkpoint::restore({.file = "file"}, text, run.simulation, part...); },
                 run.observers);
    });
  });
  return is_read;
}

template <class Run>
void read_changed(const Run& run, const std::string& good, Choices& choices) {
  Run target = run;
  const std::string text = changed(good, choices);
  if (!is_read(text, target)) {
    fuzz::require(test::written(target) == good, "a checkpoint that is refused changes the state");
    return;
  }
  const std::string read = test::written(target);
  Run again = run;
  fuzz::require(is_read(read, again), "a state that was read cannot be read again");
  const std::string other = test::first_difference(read, test::written(again));
  fuzz::require(other.empty(), "another state is read back: " + other);
  for (int step = 0; step < 2; ++step) {
    if (!fuzz::accepts([&] { test::restart::step(target); })) return;
  }
}

auto some_grains() {
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.5,
                               .friction_angle = 0.4};
  auto run = test::RestartedGrains<2>({3, 2}).make(law, NeighbourList<2>{});
  for (int step = 0; step < 3; ++step) test::restart::step(run);
  return run;
}

auto some_fluid() {
  const mps::Tank<2> tank{
      .column = {0.04, 0.04}, .size = {.length = 0.08, .height = 0.08}, .spacing = 0.02};
  test::RunWith run{Simulation{
      mps::make_tank(tank), UniformGrid<2>{},
      mps::Flow<mps::Case00>({.spacing = tank.spacing, .max_time_step = 1e-3}), SemiImplicit{}}};
  run.simulation.step();
  return run;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto grains = some_grains();
  static const auto fluid = some_fluid();
  static const std::string of_grains = test::written(grains);
  static const std::string of_fluid = test::written(fluid);
  Choices choices(data, size);
  if (choices.byte() % 4 == 3) {
    read_changed(fluid, of_fluid, choices);
  } else {
    read_changed(grains, of_grains, choices);
  }
  return 0;
}
