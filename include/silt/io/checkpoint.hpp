// SPDX-License-Identifier: MIT
// A run that was stopped goes on, bit by bit, as if it had not been.
//
//   write_checkpoint("run.silt", simulation, rain);
//   …
//   Simulation simulation{…};  dem::Inflow rain{…};      the same program builds them again
//   read_checkpoint("run.silt", simulation, rain);
//   simulation.run({.until = …}, rain);
//
// The file is that of io/archive.hpp, in the order in which the parts name their state.
#pragma once

#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/io/archive.hpp>
#include <silt/io/file.hpp>

#include <filesystem>
#include <string>
#include <tuple>
#include <utility>

namespace silt {

namespace checkpoint {

template <class Archive, class Sim, class... Parts>
void transfer_all(Archive& archive, Sim& simulation, Parts&... parts) {
  archive.within("simulation", [&] { simulation.transfer(archive); });
  Index number = 0;
  (archive.within("part " + std::to_string(number++), [&] { parts.transfer(archive); }), ...);
}

}  // namespace checkpoint

/// Writes all that the simulation, and further parts such as an inflow, go on from. The file is
/// there whole or not at all. Throws silt::Error if it cannot be written.
template <class Sim, class... Parts>
void write_checkpoint(const std::filesystem::path& path, const Sim& simulation,
                      const Parts&... parts) {
  checkpoint::Writer writer;
  std::tuple<Sim, Parts...> copies(simulation, parts...);
  std::apply([&](auto&... each) { checkpoint::transfer_all(writer, each...); }, copies);
  file::replace("write_checkpoint", path, std::move(writer).finish());
}

/// Brings a simulation, and further parts, to where those were that were written. They are built as
/// those were, with the same parameters: the file holds state alone. Throws silt::Error, and leaves
/// all as it was, if the file cannot be read, is damaged, or belongs to another dimension,
/// precision, list of fields or law.
template <class Sim, class... Parts>
void read_checkpoint(const std::filesystem::path& path, Sim& simulation, Parts&... parts) {
  const std::string bytes = file::read("read_checkpoint", path);
  checkpoint::Reader reader(path.string(), bytes);
  std::tuple<Sim, Parts...> copies(simulation, parts...);
  std::apply([&](auto&... each) { checkpoint::transfer_all(reader, each...); }, copies);
  reader.finish();
  std::tie(simulation, parts...) = std::move(copies);
}

}  // namespace silt
