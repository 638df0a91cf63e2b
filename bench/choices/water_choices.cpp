// SPDX-License-Identifier: MIT
// Each choice of the default scheme for water, switched alone, in seven flows in 2D. Prints a
// Markdown table; docs/theory_mps.md has it, and says how far single runs can be trusted.
//
//   water_choices                        all: a quarter of an hour on one thread
//   water_choices jet "no friction"      only cases and choices of these names
#include "support/dam_break.hpp"
#include "support/water_cases.hpp"

#include <silt/mps.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <string>
#include <tuple>
#include <vector>

namespace {

using namespace silt;
using namespace silt::mps;

using Default = Recommended;
using WithWallParticles = RecommendedForWallParticles;

// --- the choices ---------------------------------------------------------------------------------

struct ImagesApart09 : Default {
  KeepApart collision{.image_distance = 0.9};
};
struct ImagesApart05 : Default {
  KeepApart collision{.image_distance = 0.5};
};
struct Apart08 : Default {
  KeepApart collision{.distance = 0.8, .image_distance = 0.7};
};
struct PapersCollision : Default {
  Collision collision{.distance = 1.0, .restitution = 0.2};
};
struct SurfaceAtCentres : Default {
  BothConditions surface{.first = {.beta = 0.9}, .second = {}};
};
struct SurfaceAtCentresImages09 : SurfaceAtCentres {
  KeepApart collision{.image_distance = 0.9};
};
struct SurfaceBeta097 : Default {
  OuterSurface<BothConditions> surface{.criterion = {.first = {.beta = 0.97}, .second = {}}};
};
struct WithoutFriction : Default {
  NoFriction friction{};
};
struct MoreFriction : Default {
  PairFriction friction{.rate = 1};
};
struct Kernel3c : Default {
  CubicKernel kernel{};
};
struct Gradient4 : Default {
  MinimumGradient gradient{};
};
struct Gradient18 : Default {
  ConservingGradient gradient{};
};
struct Laplacian2 : Default {
  HigherOrderLaplacian laplacian{};
};
struct Source16 : Default {
  DivergenceSource source{};
};
struct SourceHS : Default {
  HigherOrderSource source{};
};
struct Gamma0003 : Default {
  BalancedSource source{.gamma = 0.003};
};
struct WithoutShifting : Default {
  NoShifting shifting{};
};
struct ParticlesAsWalls : Default {
  SmoothWalls walls{};
};

template <class S>
struct Choice {
  using Scheme = S;
  std::string name;
};
const std::tuple choices{
    Choice<Default>{"default"},
    Choice<ImagesApart09>{"distance to images 0.9"},
    Choice<ImagesApart05>{"distance to images 0.5"},
    Choice<Apart08>{"distance 0.8"},
    Choice<PapersCollision>{"collision (1.0, 0.2)"},
    Choice<SurfaceAtCentres>{"surface at centres"},
    Choice<SurfaceAtCentresImages09>{"surface at centres, distance to images 0.9"},
    Choice<SurfaceBeta097>{"surface with β = 0.97"},
    Choice<WithoutFriction>{"no friction"},
    Choice<MoreFriction>{"friction of rate 1"},
    Choice<Kernel3c>{"kernel (3c)"},
    Choice<Gradient4>{"gradient (4)"},
    Choice<Gradient18>{"gradient (18)"},
    Choice<Laplacian2>{"higher-order Laplacian"},
    Choice<Source16>{"source (16)"},
    Choice<SourceHS>{"source HS"},
    Choice<Gamma0003>{"γ = 0.003"},
    Choice<WithoutShifting>{"no shifting"},
    Choice<ParticlesAsWalls>{"walls of particles"},
    Choice<WithWallParticles>{"the scheme for wall particles"},
};

// --- the cases -----------------------------------------------------------------------------------

std::string text(const char* format, double value) {
  if (!std::isfinite(value)) return "–";
  std::array<char, 32> digits;
  std::snprintf(digits.data(), digits.size(), format, value);
  return digits.data();
}
std::string percent(const char* format, double share) { return text(format, 100 * share); }

using Cells = std::vector<std::string>;

struct Jet {
  static constexpr const char* name = "jet";
  static Cells heads() {
    return {"jet, three runs: pressure; change of momentum [% of ρ U² b]", "largest rise [%]"};
  }
  template <class Scheme>
  static Cells cells() {
    constexpr int runs = 3;
    double pressure = 0, momentum = 0, rise = 0;
    for (int k = 0; k < runs; ++k) {
      const auto jet = test::jet_force<Scheme>(0.01, 1e-4 * k);
      pressure += jet.pressure / runs, momentum += jet.momentum / runs;
      rise = std::max(rise, jet.rise);
    }
    return {percent("%.1f", pressure) + "; " + percent("%.1f", momentum), percent("%.2f", rise)};
  }
};
// Six runs that differ by a ten-thousandth of a spacing, because impacts are chaotic.
struct Dam {
  static constexpr const char* name = "dam";
  static Cells heads() {
    return {"dam break, six runs: pressure from momentum's in 0.4–0.5 s; in 0.5–0.8 s [%]",
            "largest rise to 2 s [%]", "lost"};
  }
  template <class Scheme>
  static Cells cells() {
    constexpr int runs = 6;
    double sum = 0, squares = 0, later = 0, rise = 0;
    Index lost = 0;
    for (int k = 0; k < runs; ++k) {
      const auto dam = test::impact_of_a_dam<Scheme>(0.02, 2, 1e-4 * k);
      const auto& d = dam.deviations;
      sum += d[0], squares += d[0] * d[0], later += (d[1] + d[2] + d[3]) / 3;
      rise = std::max(rise, dam.rise);
      lost += dam.lost;
    }
    const double mean = sum / runs, variance = (squares - runs * mean * mean) / (runs - 1);
    return {percent("%+.0f", mean) + " ± " + percent("%.0f", std::sqrt(variance)) + "; " +
                percent("%+.0f", later / runs),
            percent("%.2f", rise), std::to_string(lost)};
  }
};
struct Obstacle {
  static constexpr const char* name = "obstacle";
  static Cells heads() {
    return {"obstacle: pressure from momentum's in 0.45–0.6 s; in 0.6–1.2 s [%]",
            "pressure on its face: highest row; farthest of the others [%]"};
  }
  template <class Scheme>
  static Cells cells() {
    const auto found = test::load_of_an_obstacle<Scheme>(0.02);
    double farthest = 0;
    for (std::size_t k = 0; k + 1 < found.rows.size(); ++k) {
      if (std::abs(found.rows[k] - 1) > std::abs(farthest)) farthest = found.rows[k] - 1;
    }
    return {percent("%+.0f", found.impact) + "; " + percent("%+.0f", found.later),
            percent("%+.0f", found.rows.back() - 1) + "; " + percent("%+.0f", farthest)};
  }
};
struct UTube {
  static constexpr const char* name = "u_tube";
  static Cells heads() {
    return {"U-tube: second, fourth maximum of the first [%]", "n/n0", "rise [%]"};
  }
  template <class Scheme>
  static Cells cells() {
    const auto found = test::swings_of_a_u_tube<Scheme>(0.01);
    const auto of_first = [&](std::size_t k) {
      return k < found.maxima.size() ? percent("%.0f", found.maxima[k] / found.maxima[0]) : "–";
    };
    return {of_first(1) + ", " + of_first(3), text("%.3f", found.density),
            percent("%.2f", found.rise)};
  }
};
struct JitteredTank {
  static constexpr const char* name = "jittered";
  static Cells heads() {
    return {"tank begun off the lattice: median; largest speed [mm/s]", "pressure on its wall [%]"};
  }
  template <class Scheme>
  static Cells cells() {
    const auto found = test::rest_of_a_tank<Scheme>(0.02);
    return {text("%.1f", 1000 * found.median) + "; " + text("%.0f", 1000 * found.largest),
            percent("%+.1f", found.load - 1)};
  }
};
struct Still {
  static constexpr const char* name = "still";
  static Cells heads() { return {"still water around a block: largest speed [mm/s]"}; }
  template <class Scheme>
  static Cells cells() {
    return {text("%.2g", 1000 * test::speed_around_a_block<Scheme>(0.02, 4))};
  }
};
// Three runs that differ by a ten-thousandth of a spacing: a few particles make the edge.
struct Front {
  static constexpr const char* name = "front";
  static Cells heads() {
    return {"potential flow: edge, three runs; height, mean [rms, %]"};
  }
  template <class Scheme>
  static Cells cells() {
    constexpr double l0 = 0.01;
    std::string edges;
    double height = 0;
    for (int k = 0; k < 3; ++k) {
      const test::WaterScene scene{.spacing = l0,
                                   .water = {{{0, 0}, {0.4, 0.8}}},
                                   .walls = polyline({{0, 1.6}, {0, 0}, {1.6, 0}, {1.6, 1.6}}),
                                   .room = {{{0, 0}, {1.6, 1.6}}},
                                   .jitter = 1e-4 * k};
      auto sim = scene.simulation<Scheme>();
      test::DamBreak record;
      test::run_water(sim, 0.4, [&](const auto& water, double) {
        record.time.push_back(sim.time());
        const auto front = find_front(water, sim.search(), {.spacing = l0}, [&](Index i) {
          return water[kind][i] == Kind::fluid;
        });
        record.front.push_back(front.x / test::column_width);
        record.height.push_back(front.height / test::column_height);
      });
      const auto deviations = test::from_potential_flow(record);
      edges += (k > 0 ? ", " : "") + percent("%.1f", deviations.edge);
      height += deviations.height / 3;
    }
    return {edges + "; " + percent("%.1f", height)};
  }
};

const std::tuple cases{Jet{}, Dam{}, Obstacle{}, UTube{}, JitteredTank{}, Still{}, Front{}};

// --- the table -----------------------------------------------------------------------------------

template <class Tuple, class F>
void for_each_of(const Tuple& tuple, F&& f) {
  std::apply([&](const auto&... one) { (f(one), ...); }, tuple);
}

// What the command line names; all of a kind of which it names none.
class Selection {
 public:
  explicit Selection(const std::vector<std::string>& wanted) : wanted_(wanted) {
    std::vector<std::string> known_choices, known_cases;
    for_each_of(choices, [&](const auto& choice) { known_choices.push_back(choice.name); });
    for_each_of(cases, [&](const auto& one) { known_cases.emplace_back(one.name); });
    for (const auto& name : wanted) {
      const bool is_choice = std::ranges::find(known_choices, name) != known_choices.end();
      if (!is_choice && std::ranges::find(known_cases, name) == known_cases.end()) {
        std::string names;
        for (const auto& known : known_cases) names += "\n  " + known;
        for (const auto& known : known_choices) names += "\n  \"" + known + '"';
        fail("water_choices: no choice or case has the name \"" + name + "\"; there are" + names);
      }
      (is_choice ? all_choices_ : all_cases_) = false;
    }
  }
  bool has_choice(const std::string& name) const { return all_choices_ || is_wanted(name); }
  bool has_case(const std::string& name) const { return all_cases_ || is_wanted(name); }

 private:
  bool is_wanted(const std::string& name) const {
    return std::ranges::find(wanted_, name) != wanted_.end();
  }

  std::vector<std::string> wanted_;
  bool all_choices_ = true, all_cases_ = true;
};

template <class Scheme, class Case>
Cells cells_or_stop() {
  try {
    return Case::template cells<Scheme>();
  } catch (const Error& error) {
    Cells cells(Case::heads().size(), "–");
    cells[0] = "stopped: at " + text("%.2f", error.where().time.value_or(0)) + " s";
    std::fprintf(stderr, "%s\n", error.what());
    return cells;
  }
}

void print(const Cells& cells) {
  for (const auto& cell : cells) std::printf(" %s |", cell.c_str());
  std::fflush(stdout);
}

void print_table(const Selection& selection) {
  Cells heads{"choice"};
  for_each_of(cases, [&](const auto& one) {
    if (!selection.has_case(one.name)) return;
    for (const auto& head : one.heads()) heads.push_back(head);
  });
  std::printf("|");
  print(heads);
  std::printf("\n|");
  for (std::size_t k = 0; k < heads.size(); ++k) std::printf("---|");
  std::printf("\n");
  for_each_of(choices, [&]<class S>(const Choice<S>& choice) {
    if (!selection.has_choice(choice.name)) return;
    std::printf("| %s |", choice.name.c_str());
    for_each_of(cases, [&]<class C>(const C& one) {
      if (selection.has_case(one.name)) print(cells_or_stop<S, C>());
    });
    std::printf("\n");
  });
}

}  // namespace

int main(int argc, char** argv) {
  try {
    print_table(Selection({argv + 1, argv + argc}));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
