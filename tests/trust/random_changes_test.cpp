// SPDX-License-Identifier: MIT
// No particle is lost, doubled or mixed up with another: any sequence of changes of a container
// leaves what a plain model has.
#include <silt/io/archive.hpp>
#include <silt/search/ghosts.hpp>

#include "support/check.hpp"
#include "support/particle_model.hpp"
#include "support/warm_particles.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::random_changes_test {
namespace {

// All lengths are multiples of it [m], so that sums of them are exact.
constexpr double unit = 1.0 / 64;

template <class P>
class RandomChanges {
  static constexpr int dim = P::dimension;
  using Real = typename P::Real;
  using Vec = typename P::Vec;
  using Model = ParticleModel<P>;

 public:
  explicit RandomChanges(std::uint64_t seed) : random_(seed) {}

  /// Makes one change. Returns its name, for messages.
  std::string change() {
    const Row& row = table[random_() % std::size(table)];
    const std::uint64_t revision = particles_.revision();
    const std::uint64_t owned_revision = particles_.owned_revision();
    const Index total = particles_.total();
    const Effect effect = (this->*row.change)();
    if (effect == Effect::another) return row.name;
    const bool is_noted = effect == Effect::owned ? particles_.owned_revision() > owned_revision &&
                                                        particles_.revision() > revision
                                                  : particles_.owned_revision() == owned_revision;
    EXPECT_TRUE(is_noted) << "revision after: " << row.name;
    EXPECT_TRUE(particles_.total() == total || particles_.revision() > revision) << row.name;
    return row.name;
  }

  std::string difference() const { return model_.difference(particles_); }
  Index size() const { return particles_.size(); }
  Index number_added() const { return added_; }

 private:
  // What has changed: nothing or ghosts only; owned particles; the container is another one.
  enum class Effect { none, owned, another };

  bool any(unsigned of) { return random_() % of == 0; }
  Index index_below(Index n) { return static_cast<Index>(random_() % n); }
  int whole(int lower, int upper) {
    return lower + static_cast<int>(random_() % static_cast<unsigned>(upper - lower));
  }
  Vec any_point(int lower, int upper) {
    Vec x;
    for (int k = 0; k < dim; ++k) x[k] = Real(unit * whole(64 * lower, 64 * upper));
    return x;
  }
  template <class T>
  T any_value() {
    T value = zero_of<T>();
    auto* const bytes = reinterpret_cast<unsigned char*>(&value);
    for (std::size_t k = 0; k < sizeof value; ++k) {
      bytes[k] = static_cast<unsigned char>(random_() % 64);  // so that it is finite
    }
    return value;
  }

  // A new value of a field of particle i.
  template <class F>
  void set_field(F field, Index i) {
    using Value = value_of<F, dim, Real>;
    Value value = any_value<Value>();
    if constexpr (std::same_as<F, position_t>) value = any_point(-40, 40);
    particles_[field][i] = value;
    std::memcpy(model_.rows.at(model_.order[i]).data() + offset_in_row<P, F>(), &value,
                sizeof value);
  }

  Effect add() {
    // Rarely so many that they fill further chunks of a loop.
    const int number = any(2000) ? 3000 : size() < 40 || any(4) ? 1 : 0;
    for (int k = 0; k < number; ++k) {
      const Vec x = any_point(-40, 40);
      const Index i = particles_.add(x);
      ++added_;
      EXPECT_EQ(i, model_.order.size());
      EXPECT_EQ(particles_.id(i), model_.next_id) << "an id is never used again";
      Bytes row;
      particles_.for_each_field(
          [&]<class F>(auto, F) { append(row, std::vector{zero_of<value_of<F, dim, Real>>()}); });
      Model::set_position(row, x);
      model_.ghosts.clear();
      model_.order.push_back(model_.next_id);
      model_.rows.emplace(model_.next_id++, std::move(row));
      if (any(2)) {
        particles_.for_each_field([&](auto, auto field) { set_field(field, i); });
      }
    }
    return number > 0 ? Effect::owned : Effect::none;
  }

  Effect add_nowhere() {
    Vec x = any_point(-40, 40);
    x[whole(0, dim)] =
        any(2) ? std::numeric_limits<Real>::quiet_NaN() : std::numeric_limits<Real>::infinity();
    EXPECT_THROW(particles_.add(x), Error);
    return Effect::none;
  }

  Effect set() {
    if (size() == 0) return Effect::none;
    const Index i = index_below(size());
    particles_.for_each_field([&](auto, auto field) {
      if (any(2)) set_field(field, i);
    });
    return Effect::none;
  }

  Effect remove() {
    if (size() == 0) return Effect::none;
    const Id id = model_.order[index_below(size())];
    particles_.remove(id);
    std::erase(model_.order, id);
    model_.rows.erase(id);
    model_.ghosts.clear();
    return Effect::owned;
  }

  Effect remove_unknown() {
    const Id id = any(2) ? model_.next_id : random_() % (model_.next_id + 1);
    if (!model_.rows.contains(id)) {
      EXPECT_THROW(particles_.remove(id), Error);
    }
    return Effect::none;
  }

  Effect remove_if() {
    const unsigned share = any(20) ? 1 : size() > 100 ? 3 : 10;
    std::vector<char> is_gone(size());
    for (char& each : is_gone) each = any(share) ? 1 : 0;
    std::vector<Id> left;
    for (Index i = 0; i < is_gone.size(); ++i) {
      if (is_gone[i] == 0) left.push_back(model_.order[i]);
      if (is_gone[i] != 0) model_.rows.erase(model_.order[i]);
    }
    const Index removed = particles_.remove_if([&](Index i) { return is_gone[i] != 0; });
    EXPECT_EQ(removed, model_.order.size() - left.size());
    model_.order = std::move(left);
    model_.ghosts.clear();
    return removed > 0 ? Effect::owned : Effect::none;
  }

  Effect reorder() {
    std::vector<Index> order(size());
    for (Index i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random_);
    particles_.reorder(order);
    const std::vector<Id> before = model_.order;
    for (Index i = 0; i < order.size(); ++i) model_.order[i] = before[order[i]];
    model_.ghosts.clear();
    return Effect::owned;
  }

  Effect reorder_wrongly() {
    if (size() == 0) return Effect::none;
    std::vector<Index> order(size(), 0);
    if (size() == 1) order[0] = 1;
    EXPECT_THROW(particles_.reorder(order), Error);
    model_.ghosts.clear();
    return Effect::none;
  }

  Effect add_ghost() {
    if (size() == 0) return Effect::none;
    const Index source = index_below(particles_.total());
    const Vec shift = any_point(-8, 8);
    particles_.add_ghost(source, shift);
    typename Model::Ghost ghost{};
    if (source < size()) {
      ghost = {model_.order[source], shift, model_.rows.at(model_.order[source])};
    } else {
      ghost = model_.ghosts[source - size()];
      ghost.shift += shift;
    }
    Model::set_position(ghost.row, model_.position_of(ghost.row) + shift);
    model_.ghosts.push_back(ghost);
    return Effect::none;
  }

  Effect clear_ghosts() {
    particles_.clear_ghosts();
    model_.ghosts.clear();
    return Effect::none;
  }

  Effect refresh_ghosts() {
    if (any(2)) {
      particles_.refresh_ghosts(position, colour);
      model_.refresh(position);
      model_.refresh(colour);
    } else {
      particles_.refresh_ghosts(velocity, temperature);
      model_.refresh(velocity);
      model_.refresh(temperature);
    }
    return Effect::none;
  }

  Effect set_box() {
    Box<dim, Real> box;
    for (int k = 0; k < dim; ++k) {
      box.lower[k] = Real(whole(-20, 0));
      box.upper[k] = Real(whole(10, 20));
      box.periodic[Index(k)] = any(2);
    }
    particles_.set_box(box);
    model_.box = box;
    model_.ghosts.clear();
    box.upper[0] = box.lower[0];
    EXPECT_THROW(particles_.set_box(box), Error);
    return Effect::owned;
  }

  // Every image of every particle that is within `depth` of the box, and no other.
  Effect make_ghosts() {
    const Real depth = Real(unit * whole(1, 300));
    silt::make_ghosts(particles_, depth);
    const auto& box = model_.box;
    const auto side = [&](int k) { return box.upper[k] - box.lower[k]; };
    if (box.any_periodic()) {
      for (auto& [id, row] : model_.rows) {
        Vec x = model_.position_of(row);
        for (int k = 0; k < dim; ++k) {
          if (!box.periodic[Index(k)]) continue;
          while (x[k] < box.lower[k]) x[k] += side(k);
          while (x[k] >= box.upper[k]) x[k] -= side(k);
        }
        Model::set_position(row, x);
      }
    }
    using Image = std::pair<Id, std::vector<Real>>;
    const auto image_of = [&](Id id, const Vec& shift) {
      return Image(id, std::vector<Real>(shift.data(), shift.data() + dim));
    };
    std::vector<Image> expected;
    for (const auto& [id, row] : model_.rows) {
      const Vec x = model_.position_of(row);
      for (int number = 0; number < (dim == 2 ? 9 : 27); ++number) {
        Vec shift = Vec::Zero();
        bool is_image = number != 0;
        for (int k = 0, rest = number; k < dim; ++k, rest /= 3) {
          const int times = rest % 3 == 2 ? -1 : rest % 3;
          if (times == 0) continue;
          shift[k] = Real(times) * side(k);
          is_image = is_image && box.periodic[Index(k)] &&
                     x[k] + shift[k] >= box.lower[k] - depth &&
                     x[k] + shift[k] <= box.upper[k] + depth;
        }
        if (is_image) expected.push_back(image_of(id, shift));
      }
    }
    std::vector<Image> found;
    model_.ghosts.clear();
    for (Index g = particles_.size(); g < particles_.total(); ++g) {
      const Id id = particles_.id(g);
      Bytes row = model_.rows.at(id);
      const Vec shift = particles_.with_ghosts(position)[g] - model_.position_of(row);
      Model::set_position(row, model_.position_of(row) + shift);
      model_.ghosts.push_back({id, shift, row});
      found.push_back(image_of(id, shift));
    }
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_TRUE(found == expected) << found.size() << " ghosts, not " << expected.size();
    return Effect::none;
  }

  // A copy shares nothing with the original: either may be changed and put back.
  Effect copy() {
    if (others_.size() < 3) {
      others_.emplace_back(particles_, model_);
      return Effect::none;
    }
    auto& other = others_[index_below(others_.size())];
    EXPECT_EQ(other.second.difference(other.first), "");
    if (any(2)) {
      std::swap(other.first, particles_);
      std::swap(other.second, model_);
    } else {
      particles_ = other.first;
      model_ = other.second;
    }
    if (any(8)) others_.clear();
    return Effect::another;
  }

  Effect copy_to_itself() {
    const P& same = particles_;
    particles_ = same;
    return Effect::none;
  }

  Effect move() {
    P moved = std::move(particles_);
    particles_ = P();
    if (any(2)) particles_.add(any_point(-40, 40));
    particles_ = std::move(moved);
    return Effect::none;
  }

  Effect reserve() {
    particles_.reserve(index_below(100));
    return Effect::none;
  }

  // As a step of a simulation: some fields are changed in place, others in further memory, and the
  // step may be rolled back.
  Effect step() {
    const Model before = model_;
    particles_.save();
    const bool keeps = any(2);
    if (keeps) {
      particles_.keep(temperature);
      for (Index i = 0; i < size(); ++i) set_field(temperature, i);
    }
    const auto advance = [&]<class F>(F field) {
      const auto next = particles_.advance(field).after;
      for (Index i = 0; i < size(); ++i) {
        using Value = value_of<F, dim, Real>;
        const Value value = any_value<Value>();
        next[i] = value;
        std::memcpy(model_.rows.at(model_.order[i]).data() + offset_in_row<P, F>(), &value,
                    sizeof value);
      }
    };
    // Only finished: the values of a step that was not are left to the next one.
    advance(velocity);
    if (any(2)) advance(spin);
    particles_.finish_advance();
    if (any(2)) return Effect::none;
    particles_.restore();
    model_ = before;
    return Effect::none;
  }

  Effect write_and_read() {
    checkpoint::Writer writer;
    P(particles_).transfer(writer);
    const std::string text = std::move(writer).finish();
    P read;
    if (any(2)) read.add(any_point(-40, 40));
    checkpoint::Reader reader("file", text);
    reader.read_all([&] { read.transfer(reader); });
    particles_ = std::move(read);
    model_.ghosts.clear();
    return Effect::another;
  }

  struct Row {
    const char* name;
    Effect (RandomChanges::*change)();
  };
  // A change that is listed several times is more frequent.
  using Changes = RandomChanges;
  static constexpr Row table[] = {
      {"add", &Changes::add},
      {"add", &Changes::add},
      {"add", &Changes::add},
      {"add", &Changes::add},
      {"add nowhere", &Changes::add_nowhere},
      {"set fields", &Changes::set},
      {"set fields", &Changes::set},
      {"remove", &Changes::remove},
      {"remove", &Changes::remove},
      {"remove an unknown id", &Changes::remove_unknown},
      {"remove_if", &Changes::remove_if},
      {"reorder", &Changes::reorder},
      {"reorder, not a permutation", &Changes::reorder_wrongly},
      {"add_ghost", &Changes::add_ghost},
      {"add_ghost", &Changes::add_ghost},
      {"add_ghost", &Changes::add_ghost},
      {"clear_ghosts", &Changes::clear_ghosts},
      {"refresh_ghosts", &Changes::refresh_ghosts},
      {"make_ghosts", &Changes::make_ghosts},
      {"set_box", &Changes::set_box},
      {"copy", &Changes::copy},
      {"copy to itself", &Changes::copy_to_itself},
      {"move", &Changes::move},
      {"reserve", &Changes::reserve},
      {"step", &Changes::step},
      {"step", &Changes::step},
      {"write and read", &Changes::write_and_read},
  };

  std::mt19937_64 random_;
  P particles_;
  Model model_;
  std::vector<std::pair<P, Model>> others_;
  Index added_ = 0;
};

template <class P>
void expect_as_modelled(int changes) {
  constexpr std::uint64_t seed = 1;
  RandomChanges<P> random(seed);
  for (int k = 0; k < changes; ++k) {
    const std::string name = random.change();
    // Comparing is most of the work.
    if (random.size() > 200 && k % 16 != 0) continue;
    const std::string different = random.difference();
    EXPECT_EQ(different, "") << "seed " << seed << ", change " << k << ": " << name;
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(random.number_added(), static_cast<Index>(changes / 20));
}

template <class P>
class ParticlesAndModel : public ::testing::Test {};
TYPED_TEST_SUITE(ParticlesAndModel, WarmKinds);

TYPED_TEST(ParticlesAndModel, AreTheSameAfterAnyChange) { expect_as_modelled<TypeParam>(20'000); }
TYPED_TEST(ParticlesAndModel, AreTheSameAfterAMillionChangesSlow) {
  expect_as_modelled<TypeParam>(1'000'000);
}

}  // namespace
}  // namespace silt::test::random_changes_test
