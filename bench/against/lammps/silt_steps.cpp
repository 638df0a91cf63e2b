// SPDX-License-Identifier: MIT
// Silt's part of the comparison with LAMMPS; called by compare.py.
//   silt_steps make SCENE N                          creates the file of the state, prints its name
//   silt_steps run SCENE N LAW WARM STEPS FINAL      WARM steps, then STEPS timed ones; prints time
//                                                    and results, and writes FINAL
#include "../../states.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

using namespace bench;

Scene scene_of(std::string_view name) {
  for (const Scene scene : {Scene::bed, Scene::gas, Scene::chute}) {
    if (name == name_of(scene)) return scene;
  }
  throw std::runtime_error("silt_steps: no scene " + std::string(name));
}

template <class Simulation>
void run(Simulation simulation, int warm, int steps, const char* final_file) {
  for (int step = 0; step < warm; ++step) simulation.step(time_step);
  const auto rebuilds = simulation.search().rebuilds();
  const auto begin = std::chrono::steady_clock::now();
  for (int step = 0; step < steps; ++step) simulation.step(time_step);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;

  const auto rebuilt = simulation.search().rebuilds() - rebuilds;
  const auto [grains, interaction] = simulation.state();
  Index pairs = 0, at_wall = 0;
  contacts_of(interaction).for_each_contact(grains, [&](Index, Index j, const auto&, const auto&) {
    ++(j == silt::no_index ? at_wall : pairs);
  });
  const auto n = double(grains.size());
  std::printf("{\"seconds\": %.6g, \"contacts\": %.6g, \"at_wall\": %.6g, \"rebuilds\": %d}\n",
              seconds.count(), 2 * double(pairs) / n, double(at_wall) / n, int(rebuilt));

  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(final_file, "w"),
                                                             std::fclose);
  if (!file) throw std::runtime_error(std::string("silt_steps: cannot write ") + final_file);
  for (const auto& [x, v, w, diameter] : bodies_of(grains)) {
    std::fprintf(file.get(), "%.15g %.15g %.15g %.15g %.15g %.15g %.15g %.15g %.15g\n", x[0], x[1],
                 x[2], v[0], v[1], v[2], w[0], w[1], w[2]);
  }
}

template <class Law>
void run(Scene scene, Index n, Law law, int warm, int steps, const char* final_file) {
  const State state = state_of(scene, n);
  if (scene == Scene::gas) {
    run(in_space(state, law), warm, steps, final_file);
  } else {
    run(on_floor(state, scene, law), warm, steps, final_file);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "make" && argc == 4) {
    const Scene scene = scene_of(argv[2]);
    const auto n = static_cast<Index>(std::atol(argv[3]));
    static_cast<void>(state_of(scene, n));
    std::printf("%s\n", file_of(scene, n).c_str());
    return 0;
  }
  if (what == "run" && argc == 8) {
    const Scene scene = scene_of(argv[2]);
    const auto n = static_cast<Index>(std::atol(argv[3]));
    const int warm = std::atoi(argv[5]), steps = std::atoi(argv[6]);
    if (std::string_view(argv[4]) == "cundall_strack") {
      run(scene, n, cundall_strack(), warm, steps, argv[7]);
    } else {
      run(scene, n, hooke_history, warm, steps, argv[7]);
    }
    return 0;
  }
  std::fprintf(stderr, "usage: see the beginning of silt_steps.cpp\n");
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
