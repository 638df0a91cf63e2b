// SPDX-License-Identifier: MIT
// The functions of the live page: one simulation at a time. No exception leaves them: those that
// may fail return false, or -1, and error() then has Silt's own sentence.
#include "scenes.hpp"

#include <exception>

namespace {

std::unique_ptr<live::Scene> scene;
std::array<double, 5> given_numbers{};
std::string message;
std::array<double, 3> curve_values{};

// f(), or `otherwise` if it throws.
template <class F, class Result>
Result attempt(F&& f, Result otherwise) {
  try {
    return f();
  } catch (const std::exception& error) {
    message = error.what();
  } catch (...) {
    message = "unknown error";
  }
  return otherwise;
}

}  // namespace

#define SILT_EXPORT(name) extern "C" __attribute__((export_name(#name)))

// Destructors of thread_local objects: the page never ends its only thread.
extern "C" int __cxa_thread_atexit(void (*)(void*), void*, void*) { return 0; }

/// Where start() reads its five numbers.
SILT_EXPORT(numbers) double* live_numbers() { return given_numbers.data(); }

/// Replaces the simulation. If it fails, the present one stays.
SILT_EXPORT(start) bool live_start(unsigned number) {
  return attempt([&] { return scene = live::make_scene(number, given_numbers), true; }, false);
}
/// Steps until this time [s], at most `most` of them; their number, or -1. A step that fails is
/// rolled back.
SILT_EXPORT(step_until) int live_step_until(double until, int most) {
  return attempt([&] { return scene->step_until(until, most); }, -1);
}
SILT_EXPORT(tilt) bool live_tilt(double angle) {
  return attempt([&] { return scene->tilt(angle), true; }, false);
}
/// Takes the state for picture(), walls() and curves().
SILT_EXPORT(observe) bool live_observe(int quantity) {
  return attempt([&] { return scene->observe(live::Quantity(quantity)), true; }, false);
}
SILT_EXPORT(picture) const float* live_picture() { return scene->picture().data(); }
SILT_EXPORT(picture_size) std::size_t live_picture_size() { return scene->picture().size(); }
SILT_EXPORT(walls) const float* live_walls() { return scene->walls().data(); }
SILT_EXPORT(walls_size) std::size_t live_walls_size() { return scene->walls().size(); }
/// Kinetic and potential energy [J/m] and pressure [Pa].
SILT_EXPORT(curves) const double* live_curves() {
  const live::Curves& curves = scene->curves();
  curve_values = {curves.kinetic, curves.potential, curves.pressure};
  return curve_values.data();
}
SILT_EXPORT(time) double live_time() { return scene->time(); }
SILT_EXPORT(time_step) double live_time_step() {
  return attempt([] { return scene->time_step(); }, 0.0);
}
SILT_EXPORT(size) std::size_t live_size() { return scene->size(); }
SILT_EXPORT(hash) std::uint64_t live_hash() {
  return attempt([] { return scene->hash(); }, std::uint64_t(0));
}
/// Text in UTF-8, ended by zero.
SILT_EXPORT(error) const char* live_error() { return message.c_str(); }
/// [s]; 0 for a scene that does not exist.
SILT_EXPORT(end_of_program) double live_end_of_program(unsigned number) {
  return number < live::ends.size() ? live::ends[number] : 0;
}
