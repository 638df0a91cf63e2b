// SPDX-License-Identifier: MIT
// Frames for ParaView and other programs that read VTK's XML formats.
//
//   VtkSeries{"out/tower"}   out/tower.pvd                list of frames and times: open this file
//                            out/tower/tower_000000.vtu   one frame: particles with their fields
//
// Of several simulations in one, such as coupled::Coupled, each writes a file of a frame,
// out/lake/lake_grains_000000.vtu and out/lake/lake_fluid_000000.vtu, which the list names
// together.
//
// Several processes write a piece of a frame each, out/tower/tower_000000_3.vtu, and the first one
// out/tower/tower_000000.pvtu, which names them.
//
// A frame is an unstructured grid of vertices. Each array is stored in its XML element, in base64
// and preceded by its size in bytes. Raw bytes after the XML ("appended") would need 3/4 of the
// space, but some programs cannot read them, such as ParaView 5.11 of Debian 12 (its VTK with its
// expat).
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/field_view.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/io/file.hpp>
#include <silt/io/replace_file.hpp>

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

/// VTK's name of a number type; nullptr if VTK cannot store it.
template <class Number>
constexpr const char* vtk_type() {
  if constexpr (std::is_enum_v<Number>) {
    return vtk_type<std::underlying_type_t<Number>>();
  } else if constexpr (std::floating_point<Number>) {
    return sizeof(Number) == 4 ? "Float32" : sizeof(Number) == 8 ? "Float64" : nullptr;
  } else if constexpr (std::integral<Number>) {
    constexpr const char* types[] = {"UInt8", "UInt16", "UInt32", "UInt64",
                                     "Int8",  "Int16",  "Int32",  "Int64"};
    return types[std::countr_zero(sizeof(Number)) + (std::is_signed_v<Number> ? 4 : 0)];
  } else {
    return nullptr;
  }
}

namespace detail {

/// How VTK stores values of a type; `type` is nullptr if it cannot.
struct VtkType {
  const char* type;
  int components;
  Index size;   ///< of a value [bytes]
  Index width;  ///< of a value in the file, where zeros follow it [bytes]
};
template <class Value>
inline constexpr VtkType vtk_type_of = [] {
  if constexpr (requires { typename Value::Scalar; Value::SizeAtCompileTime; }) {
    using Number = typename Value::Scalar;
    constexpr int size = Value::SizeAtCompileTime, components = size == 2 ? 3 : size;
    return VtkType{size > 0 ? vtk_type<Number>() : nullptr, components, size * sizeof(Number),
                   components * sizeof(Number)};
  } else {
    return VtkType{vtk_type<Value>(), 1, sizeof(Value), sizeof(Value)};
  }
}();

/// A named array of `count` values, `stride` bytes apart.
struct VtkArray {
  std::string_view name;
  const VtkType* values;
  const void* first;
  Index count;
  Index stride;
};
template <class Value>
VtkArray vtk_array(std::string_view name, std::span<const Value> values) {
  return {name, &vtk_type_of<Value>, values.data(), values.size(), sizeof(Value)};
}

/// Bytes in base64: four characters for every three bytes.
[[gnu::cold]] inline std::string base64(const std::string& bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const Index groups = (bytes.size() + 2) / 3;
  std::string text(4 * groups, '=');
  for_each_chunk(groups, [&](Chunk chunk) {
    for (Index group = chunk.first; group < chunk.last; ++group) {
      const Index count = std::min<Index>(3, bytes.size() - 3 * group);
      std::uint32_t bits = 0;
      for (Index k = 0; k < count; ++k) {
        bits |= std::uint32_t(static_cast<unsigned char>(bytes[3 * group + k])) << (16 - 8 * k);
      }
      for (Index k = 0; k <= count; ++k) text[4 * group + k] = digits[(bits >> (18 - 6 * k)) & 63];
    }
  });
  return text;
}

/// Of fields, which have as many values as there are ids. Not inlined for every field.
[[gnu::noinline, gnu::cold]] inline void add_vtk_array(Buffer<VtkArray>& arrays,
                                                       std::string_view name, const VtkType& values,
                                                       const void* first, Index stride) {
  arrays.push_back({name, &values, first, 0, stride});
}

/// The XML element of an array.
[[gnu::cold]] inline std::string xml_of(const VtkArray& array) {
  const VtkType& values = *array.values;
  const std::uint64_t length = array.count * values.width;
  std::string bytes(sizeof length + length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  for_each_chunk(array.count, [&, to = bytes.data() + sizeof length](Chunk chunk) {
    const auto* const from = static_cast<const char*>(array.first);
    for (Index i = chunk.first; i < chunk.last; ++i) {
      std::memcpy(to + i * values.width, from + i * array.stride, values.size);
    }
  });
  return message_of({"<DataArray type=\"", values.type, "\" Name=\"", array.name,
                     "\" NumberOfComponents=\"", values.components, "\" format=\"binary\">",
                     base64(bytes), "</DataArray>\n"});
}

/// A frame of n points in m cells, from the elements of its parts.
[[gnu::cold]] inline std::string vtk_file(Index n, Index m, const std::string& points,
                                          const std::string& cells, const std::string& point_data,
                                          const std::string& cell_data) {
  const char* const order =
      std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  return message_of(
      {"<?xml version=\"1.0\"?>\n"
       "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"",
       order, "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"", n,
       "\" NumberOfCells=\"", m, "\">\n<Points>\n", points, "</Points>\n<Cells>\n", cells,
       "</Cells>\n<PointData>\n", point_data, "</PointData>\n", cell_data,
       "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"});
}

/// A frame of the positions, as points, and the other fields.
[[gnu::cold]] inline std::string vtk_frame(std::span<const Id> ids, std::span<VtkArray> fields) {
  const Index n = ids.size();
  Buffer<std::int64_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), std::int64_t{0});
  std::string cells = xml_of(vtk_array<std::int64_t>("connectivity", numbers));
  for (std::int64_t& number : numbers) ++number;
  cells += xml_of(vtk_array<std::int64_t>("offsets", numbers));
  const Buffer<std::uint8_t> vertices(n, 1);  // VTK_VERTEX
  cells += xml_of(vtk_array<std::uint8_t>("types", vertices));

  std::string points;
  std::string point_data = xml_of(vtk_array("id", ids));
  for (VtkArray& field : fields) {
    field.count = n;
    if (field.values->type)
      (field.name == name_of<position_t>() ? points : point_data) += xml_of(field);
  }

  return vtk_file(n, n, points, cells, point_data, "");
}

/// The arrays of a part of a frame, as a .pvtu file declares them.
[[gnu::cold]] inline std::string declared_in_pieces(std::string_view frame, std::string_view part) {
  const auto first = frame.find(message_of({"<", part, ">"}));
  const auto last = frame.find(message_of({"</", part, ">"}));
  std::string text = message_of({"<P", part, ">\n"});
  for (auto from = frame.find("<DataArray", first); from < last;
       from = frame.find("<DataArray", from + 1)) {
    const auto length = frame.find(" format=", from) - from;
    text += message_of({"<P", frame.substr(from + 1, length - 1), "/>\n"});
  }
  return text + message_of({"</P", part, ">\n"});
}

}  // namespace detail

/// One frame, as the bytes of a .vtu file: positions as points; every other numeric or vector field
/// F, and the ids, as point data named name_of<F>(). Vectors in 2D get a third component 0. Fields
/// of other types are omitted. The bytes depend on the particles only.
template <class P>
[[gnu::cold]] std::string vtk_frame(const P& particles) {
  Buffer<detail::VtkArray> fields;
  particles.for_each_field([&]<class Values, class F>(const Values& values, F) {
    using Value = typename Values::value_type;
    detail::add_vtk_array(fields, name_of<F>(), detail::vtk_type_of<Value>,
                          values.empty() ? nullptr : &values.front(), stride_of(values));
  });
  return detail::vtk_frame(particles.ids(), fields);
}

/// The bytes of a .pvtu file: a frame that consists of files with such frames.
[[gnu::cold]] inline std::string vtk_frame_of_pieces(const std::string& frame,
                                       const std::vector<std::string>& files) {
  std::string text = frame.substr(0, frame.find("<UnstructuredGrid>"));
  text.replace(text.find("UnstructuredGrid"), 0, "P");
  text += message_of({"<PUnstructuredGrid>\n", detail::declared_in_pieces(frame, "Points"),
                      detail::declared_in_pieces(frame, "PointData")});
  for (const std::string& file : files) text += message_of({"<Piece Source=\"", file, "\"/>\n"});
  return text += "</PUnstructuredGrid>\n</VTKFile>\n";
}

/// Observer that writes a frame at every output, followed by the list of all frames with their
/// times [s]. The fields are those of Simulation::snapshot(), all at the same time. A second frame
/// at the same time, e.g. at the beginning of a second run, replaces the first.
///
/// A resumed run continues after the frames written before the checkpoint and replaces later ones.
/// If the series is not a part of the checkpoint, it continues after the frames in the existing
/// list with earlier times.
class VtkSeries {
 public:
  /// Frames are written to the folder `path`, which is created, and their list to `path`.pvd.
  /// Existing files of the same names are replaced from the first frame on. Further frames of an
  /// earlier, longer run remain in the folder: read those in the list, or delete the folder before
  /// a run. Throws silt::Error if the folder cannot be created.
  explicit VtkSeries(std::filesystem::path path) : folder_(std::move(path)) {
    if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "tower/" is "tower"
    file::create_folder("VtkSeries", folder_);
  }

  /// Throws silt::Error if a file cannot be written.
  template <class Sim>
    requires requires(const Sim& simulation) {
      simulation.snapshot();
      simulation.time();
    }
  [[gnu::cold]] void operator()(const Sim& simulation) {
    bool was_read = false;
    if constexpr (requires { simulation.was_read(); }) was_read = simulation.was_read();
    const auto particles = simulation.snapshot();
    write(double(simulation.time()), was_read, process_of(particles), vtk_frame(particles));
  }
  /// The same of several simulations in one.
  template <class Sim>
    requires ConsistsOfSimulations<Sim>
  [[gnu::cold]] void operator()(const Sim& simulation) {
    std::vector<Part> parts;
    simulation.for_each_simulation([&](std::string_view name, const auto& each) {
      parts.push_back({std::string(name), vtk_frame(each.snapshot())});
    });
    write(double(simulation.time()), simulation.was_read(), Process{}, parts);
  }

  /// Number of frames written so far.
  Index frames() const noexcept { return times_.size(); }

  /// For a checkpoint: the times of the frames.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("times", times_);
    is_in_pieces_.clear();
    if constexpr (Archive::reads) was_read_ = true;
  }

 protected:
  /// One of the files of a frame.
  struct Part {
    std::string name;   // empty if it is the only one
    std::string frame;  // bytes
  };
  /// Writes the next frame [s]. Like all that runs once for a frame, it is compiled for a small
  /// program. Throws silt::Error if a file cannot be written.
  [[gnu::cold]] void write(double time, bool is_resumed, const Process& process,
                           const std::string& frame) {
    write(time, is_resumed, process, std::vector<Part>{{"", frame}});
  }
  /// The same in several files. Those that processes share are in one.
  [[gnu::cold]] void write(double time, bool is_resumed, const Process& process,
                           const std::vector<Part>& parts) {
    if (times_.empty() && is_resumed && !was_read_) times_ = listed_before(time);
    if (times_.empty() || times_.back() != time) times_.push_back(time);
    const Index number = times_.size() - 1;
    for (const Part& part : parts) {
      const std::string name = frame_name(number, part.name);
      const auto piece = [&](int rank) { return message_of({name, "_", rank, of_one}); };
      if (process.count > 1) {
        file::replace("VtkSeries", folder_ / piece(process.rank), part.frame);
        if (process.rank > 0) return;
        std::vector<std::string> pieces;
        for (int rank = 0; rank < process.count; ++rank) pieces.push_back(piece(rank));
        file::replace("VtkSeries", folder_ / (name + of_pieces),
                      vtk_frame_of_pieces(part.frame, pieces));
      } else {
        file::replace("VtkSeries", folder_ / (name + of_one), part.frame);
      }
      // Of an earlier run, on another number of processes.
      std::error_code ignored;
      std::filesystem::remove(folder_ / (name + (process.count > 1 ? of_one : of_pieces)), ignored);
    }

    while (is_in_pieces_.size() < times_.size()) {
      const auto name = frame_name(is_in_pieces_.size(), parts.front().name);
      is_in_pieces_.push_back(file::exists("VtkSeries", folder_ / (name + of_pieces)));
    }
    is_in_pieces_[number] = process.count > 1;

    std::string list;
    for (Index k = 0; k < times_.size(); ++k) {
      for (Index n = 0; n < parts.size(); ++n) {
        list += message_of({"<DataSet ", time_begins, file::digits(times_[k]), "\""});
        if (parts.size() > 1) list += message_of({" part=\"", n, "\""});
        list +=
            message_of({" file=\"", folder_.filename().string(), "/", frame_name(k, parts[n].name),
                        is_in_pieces_[k] ? of_pieces : of_one, "\"/>\n"});
      }
    }
    file::replace(
        "VtkSeries", list_path(),
        message_of({"<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
                    "<Collection>\n",
                    list, "</Collection>\n</VTKFile>\n"}));
  }

 private:
  static constexpr std::string_view time_begins = "timestep=\"";
  static constexpr const char* of_one = ".vtu";
  static constexpr const char* of_pieces = ".pvtu";

  [[gnu::cold]] std::filesystem::path list_path() const {
    std::filesystem::path path = folder_;
    path += ".pvd";
    return path;
  }
  [[gnu::cold]] std::string frame_name(Index k, const std::string& part) const {
    std::string number = std::to_string(k);
    number.insert(0, number.size() < 6 ? 6 - number.size() : 0, '0');
    return message_of({folder_.filename().string(), part.empty() ? "" : "_", part, "_", number});
  }

  // The times of the listed frames of an earlier run before `time`.
  [[gnu::cold]] std::vector<double> listed_before(double time) const {
    std::vector<double> times;
    if (!file::exists("VtkSeries", list_path())) return times;
    const std::string list = file::read("VtkSeries", list_path());
    for (auto from = list.find(time_begins); from != std::string::npos;
         from = list.find(time_begins, from)) {
      from += time_begins.size();
      const auto listed =
          file::number(std::string_view(list).substr(from, list.find('"', from) - from));
      if (!listed || !(*listed < time)) break;
      if (times.empty() || times.back() < *listed) times.push_back(*listed);
    }
    return times;
  }

  std::filesystem::path folder_;
  std::vector<double> times_;  // of the frames [s]
  std::vector<bool> is_in_pieces_;  // by frame; or fewer
  bool was_read_ = false;      // from a checkpoint
};

}  // namespace silt
