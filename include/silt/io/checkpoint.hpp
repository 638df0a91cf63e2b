// SPDX-License-Identifier: MIT
// Resumes a stopped run, bitwise identical to an uninterrupted one.
//
//   write_checkpoint("run.silt", simulation, rain);
//   …
//   Simulation simulation{…};  dem::Inflow rain{…};      set up again by the same program
//   read_checkpoint("run.silt", simulation, rain);
//   simulation.run({.until = …}, rain);
//
// The file format is defined in io/archive.hpp; entries are in the order of the transfer() calls.
#pragma once

#include <silt/core/processes.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/io/archive.hpp>
#include <silt/io/file.hpp>
#include <silt/io/replace_file.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

namespace silt {

/// Which checkpoint read_checkpoint() reads.
struct CheckpointToRead {
  std::filesystem::path file;  ///< made by write_checkpoint()
  /// Read it although it is of other laws, walls or settings.
  bool accepts_other_setup = false;
};

namespace checkpoint {

/// Lists the state of a simulation and of further parts, as they are in a file.
template <class Archive, class Sim, class... Parts>
void transfer_all(Archive& archive, Sim& simulation, Parts&... parts) {
  archive.within("simulation", [&] { simulation.transfer(archive); });
  Index number = 0;
  (archive.within("part " + std::to_string(number++), [&] { parts.transfer(archive); }), ...);
}

/// Restores the state from the bytes of a file, see read_checkpoint().
template <class Sim, class... Parts>
void restore(const CheckpointToRead& from, std::string_view bytes, Sim& simulation,
             Parts&... parts) {
  Reader reader(from.file.string(), bytes, from.accepts_other_setup);
  std::tuple<Sim, Parts...> copies(simulation, parts...);
  reader.read_all(
      [&] { std::apply([&](auto&... each) { transfer_all(reader, each...); }, copies); });
  std::tie(simulation, parts...) = std::move(copies);
}

}  // namespace checkpoint

/// Writes the whole state of the simulation and of further parts of the run, such as an inflow, to
/// resume from. The file is written atomically. Throws silt::Error if it cannot be written. Of
/// particles that processes share, the first process writes all: any number of processes, also one,
/// reads the file.
template <class Sim, class... Parts>
void write_checkpoint(const std::filesystem::path& path, const Sim& simulation,
                      const Parts&... parts) {
  detail::together(simulation.particles(), [&] {
    checkpoint::Writer writer;
    std::tuple<Sim, Parts...> copies(simulation, parts...);
    std::apply([&](auto&... each) { checkpoint::transfer_all(writer, each...); }, copies);
    if (process_of(simulation.particles()).rank == 0) {
      file::replace("write_checkpoint", path, std::move(writer).finish(),
                    file::Outlasts::power_failure);
    }
    return Largest{};
  });
}

/// Restores the state of a simulation and of further parts from a checkpoint. They must have been
/// set up with the same parameters as those that were written: the file restores state only. Throws
/// silt::Error, and changes nothing, if the file cannot be read, is damaged, or was written with
/// another dimension, precision or list of fields, or, unless that is accepted, with another law
/// or wall, or another spacing or density of a flow.
template <class Sim, class... Parts>
void read_checkpoint(const CheckpointToRead& from, Sim& simulation, Parts&... parts) {
  detail::together(simulation.particles(), [&] {
    checkpoint::restore(from, file::read("read_checkpoint", from.file), simulation, parts...);
    return Largest{};
  });
}
template <class Sim, class... Parts>
void read_checkpoint(const std::filesystem::path& path, Sim& simulation, Parts&... parts) {
  read_checkpoint(CheckpointToRead{.file = path}, simulation, parts...);
}

}  // namespace silt
