// SPDX-License-Identifier: MIT
// Frames for ParaView and everything else that reads VTK's XML formats.
//
//   VtkSeries{"out/tower"}   out/tower.pvd                the frames and their times: open this one
//                            out/tower/tower_000000.vtu   one frame: points with every column
//
// A frame is an unstructured grid of single vertices. Its arrays are stored as they are in memory,
// one after the other behind the XML ("appended raw"), each after its number of bytes.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/io/file.hpp>

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

/// VTK's name of a number's type; none for what VTK cannot store.
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

/// Numbers to be written: `count` values of `size` bytes each, `stride` bytes apart.
struct VtkValues {
  const void* first;
  Index count;
  Index size;
  Index stride;
};

/// The appended arrays of a VTK file. Not a template over the type of the numbers, since compiling
/// it for every field takes longer than copying bytes costs.
class VtkArrays {
 public:
  /// Appends the values, filled up with zeros to `width` bytes each, and returns the XML that
  /// describes them.
  std::string add(std::string_view type, std::string_view name, int components,
                  const VtkValues& values, Index width) {
    std::string xml = "<DataArray type=\"" + std::string(type) + "\" Name=\"" + std::string(name) +
                      "\" NumberOfComponents=\"" + std::to_string(components) +
                      "\" format=\"appended\" offset=\"" + std::to_string(bytes_.size()) + "\"/>\n";
    const std::uint64_t length = values.count * width;
    const Index begin = bytes_.size() + sizeof length;
    bytes_.resize(begin + length);
    char* const to = bytes_.data() + begin;
    std::memcpy(to - sizeof length, &length, sizeof length);
    const auto* const from = static_cast<const char*>(values.first);
    for_each_chunk(values.count, [=](Chunk chunk) {
      for (Index i = chunk.first; i < chunk.last; ++i) {
        std::memcpy(to + i * width, from + i * values.stride, values.size);
      }
    });
    return xml;
  }
  template <class Number>
  std::string add(std::string_view name, std::span<const Number> values) {
    return add(vtk_type<Number>(), name, 1,
               {values.data(), values.size(), sizeof(Number), sizeof(Number)}, sizeof(Number));
  }

  const std::string& bytes() const noexcept { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace detail

/// One frame as the bytes of a .vtu file: positions as points; every other column of numbers or
/// vectors, and the ids, as point data named name_of<F>(). Vectors in 2D get a third
/// component 0. Columns of other types are left out. The same bits for the same particles.
template <class P>
std::string vtk_frame(const P& particles) {
  const Index n = particles.size();
  std::string points, point_data;
  detail::VtkArrays arrays;

  particles.for_each_field([&]<class Values, class F>(const Values& values, F) {
    using Value = typename Values::value_type;
    if constexpr (requires { typename Value::Scalar; Value::SizeAtCompileTime; }) {
      using Number = typename Value::Scalar;
      constexpr int size = Value::SizeAtCompileTime;
      if constexpr (size > 0 && vtk_type<Number>() != nullptr) {
        constexpr int components = size == 2 ? 3 : size;
        auto& xml = std::same_as<F, position_t> ? points : point_data;
        xml += arrays.add(vtk_type<Number>(), name_of<F>(), components,
                          {values.data(), n, size * sizeof(Number), sizeof(Value)},
                          components * sizeof(Number));
      }
    } else if constexpr (vtk_type<Value>() != nullptr) {
      point_data += arrays.add(name_of<F>(), std::span<const Value>(values));
    }
  });
  point_data += arrays.add("id", particles.ids());
  std::vector<std::int64_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), std::int64_t{0});
  std::string cells = arrays.add("connectivity", std::span<const std::int64_t>(numbers));
  for (std::int64_t& number : numbers) ++number;
  cells += arrays.add("offsets", std::span<const std::int64_t>(numbers));
  const std::vector<std::uint8_t> vertices(n, 1);  // VTK_VERTEX
  cells += arrays.add("types", std::span<const std::uint8_t>(vertices));

  const std::string order =
      std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  const std::string count = std::to_string(n);
  return "<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"" + order +
         "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"" + count +
         "\" NumberOfCells=\"" + count + "\">\n<Points>\n" + points + "</Points>\n<Cells>\n" +
         cells + "</Cells>\n<PointData>\n" + point_data + "</PointData>\n</Piece>\n"
         "</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_" + arrays.bytes() +
         "\n</AppendedData>\n</VTKFile>\n";
}

/// Observer that writes a frame at every output, and after it the list of all frames with their
/// times [s]. Fields are those of Simulation::snapshot(): all at one time. A second frame of the
/// same time, as of two runs that follow one another, replaces the first.
///
/// A resumed run goes on behind the frames that were written before the checkpoint, and replaces
/// later ones. If the series is not among the parts of the checkpoint, it goes on behind those of
/// earlier times in the list of the folder.
class VtkSeries {
 public:
  /// Frames go into the folder `path`, which is made, their list into `path`.pvd. Files of the same
  /// names are replaced when the first frame is written. Throws silt::Error if the folder cannot be
  /// made.
  explicit VtkSeries(std::filesystem::path path) : folder_(std::move(path)) {
    if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "tower/" is "tower"
    file::make_folder("VtkSeries", folder_);
  }

  /// Throws silt::Error if a file cannot be written.
  template <class Sim>
    requires requires(const Sim& simulation) {
      simulation.snapshot();
      simulation.time();
    }
  void operator()(const Sim& simulation) {
    const double time = double(simulation.time());
    if constexpr (requires { simulation.was_read(); }) {
      if (times_.empty() && simulation.was_read() && !was_read_) times_ = listed_before(time);
    }
    if (times_.empty() || times_.back() != time) times_.push_back(time);
    file::replace("VtkSeries", folder_ / frame_name(times_.size() - 1),
                  vtk_frame(simulation.snapshot()));

    std::string list;
    for (Index k = 0; k < times_.size(); ++k) {
      list += "<DataSet " + std::string(time_begins) + file::digits(times_[k]) + "\" file=\"" +
              folder_.filename().string() + "/" + frame_name(k) + "\"/>\n";
    }
    file::replace("VtkSeries", list_path(),
                  "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
                  "<Collection>\n" + list + "</Collection>\n</VTKFile>\n");
  }

  /// Frames written so far.
  Index frames() const noexcept { return times_.size(); }

  /// For a checkpoint: the times of the frames.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("times", times_);
    if constexpr (Archive::reads) was_read_ = true;
  }

 private:
  static constexpr std::string_view time_begins = "timestep=\"";

  std::filesystem::path list_path() const {
    std::filesystem::path path = folder_;
    path += ".pvd";
    return path;
  }
  std::string frame_name(Index k) const {
    std::string number = std::to_string(k);
    number.insert(0, number.size() < 6 ? 6 - number.size() : 0, '0');
    return folder_.filename().string() + "_" + number + ".vtu";
  }

  // The times of the frames that an earlier run listed, up to a time.
  std::vector<double> listed_before(double time) const {
    std::vector<double> times;
    if (!std::filesystem::exists(list_path())) return times;
    const std::string list = file::read("VtkSeries", list_path());
    for (auto at = list.find(time_begins); at != std::string::npos;
         at = list.find(time_begins, at)) {
      at += time_begins.size();
      const auto listed =
          file::number(std::string_view(list).substr(at, list.find('"', at) - at));
      if (!listed || !(*listed < time)) break;
      times.push_back(*listed);
    }
    return times;
  }

  std::filesystem::path folder_;
  std::vector<double> times_;  // of the frames [s]
  bool was_read_ = false;      // from a checkpoint
};

}  // namespace silt
