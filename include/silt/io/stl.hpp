// SPDX-License-Identifier: MIT
// Triangulated surfaces as STL files, binary or text, as exported by CAD programs.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/triangle.hpp>
#include <silt/core/types.hpp>
#include <silt/io/file.hpp>
#include <silt/io/replace_file.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace silt {

/// How numbers are stored in an STL file.
enum class StlFormat {
  binary,  ///< 50 bytes for each triangle
  text,    ///< a line for each corner
};

/// How read_stl() understands the numbers of a file.
struct StlSettings {
  double scale = 1;  ///< length unit of the file [m], e.g. 1e-3 for mm; STL does not define one
};

namespace detail {

inline constexpr Index stl_header = 84;    // 80 characters and the number of triangles
inline constexpr Index stl_triangle = 50;  // 12 floats and two unused bytes

inline std::uint32_t stl_word(std::string_view bytes, Index offset) {
  std::uint32_t word = 0;
  for (Index k = 4; k-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[offset + k]);
  return word;
}

inline std::vector<Triangle<double>> binary_stl(const std::string& file, std::string_view bytes,
                                                double scale) {
  if (bytes.size() < stl_header) {
    fail({"read_stl: ", file, " is not an STL file: it has ", bytes.size(),
          " bytes and does not begin with \"solid\"; check the path"});
  }
  const Index count = stl_word(bytes, stl_header - 4);
  const Index whole = (bytes.size() - stl_header) / stl_triangle;
  if (whole < count) {
    fail({"read_stl: ", file, " is truncated in triangle ", whole, " of ", count,
          ", or is not an STL file; export it again"});
  }
  if (whole > count) {
    fail({"read_stl: ", file, " says that it has ", count, " triangles, but has the bytes of ",
          whole, "; export it again"});
  }
  std::vector<Triangle<double>> triangles(count);
  for (Index t = 0; t < count; ++t) {
    Index offset = stl_header + t * stl_triangle + 12;  // after the normal
    for (auto& corner : triangles[t].corners) {
      for (int k = 0; k < 3; ++k, offset += 4) {
        corner[k] = scale * double(std::bit_cast<float>(stl_word(bytes, offset)));
      }
    }
  }
  return triangles;
}

template <class Real>
double largest_coordinate(const std::vector<Triangle<Real>>& triangles) {
  double largest = 0;
  for (const Triangle<Real>& triangle : triangles) {
    for (const auto& corner : triangle.corners) {
      largest = std::max(largest, double(max_norm(corner)));
    }
  }
  return largest;
}
// The largest coordinate is in [m].
inline void require_in_binary_stl(Index triangles, double largest) {
  if (triangles > std::numeric_limits<std::uint32_t>::max()) {
    fail({"write_stl: number of triangles = ", triangles,
          " is not below 2^32; write several files"});
  }
  if (largest > double(std::numeric_limits<float>::max())) {
    fail({"write_stl: a coordinate of ", largest,
          " m is beyond single precision; write StlFormat::text"});
  }
}

// Splits a text into words in lower case.
class StlWords {
 public:
  StlWords(const std::string& file, std::string_view text) : file_(file), text_(text) {}

  /// Empty at the end.
  std::string next() {
    while (!text_.empty() && is_blank(text_.front())) drop();
    std::string word;
    while (!text_.empty() && !is_blank(text_.front())) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(text_.front())));
      drop();
    }
    return word;
  }
  void skip_line() {
    while (!text_.empty() && text_.front() != '\n') drop();
  }
  void expect(std::string_view wanted) {
    const std::string word = next();
    if (word != wanted) reject(wanted, word);
  }
  double number() {
    const std::string word = next();
    const auto value = file::number(word);
    if (!value) reject("a number", word);
    return *value;
  }
  [[noreturn]] void reject(std::string_view wanted, const std::string& word) const {
    fail({"read_stl: ", file_, ", line ", line_, ", triangle ", triangles, ": ",
          (word.empty() ? std::string("the file ends") : "\"" + word + "\" is found"), " where ",
          wanted, " is expected; correct it, or export it again"});
  }

  Index triangles = 0;  ///< read so far

 private:
  static bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
  void drop() {
    line_ += text_.front() == '\n';
    text_.remove_prefix(1);
  }

  const std::string& file_;
  std::string_view text_;
  Index line_ = 1;
};

inline std::vector<Triangle<double>> text_stl(const std::string& file, std::string_view text,
                                              double scale) {
  std::vector<Triangle<double>> triangles;
  StlWords words(file, text);
  std::string word = words.next();
  while (!word.empty()) {
    if (word != "solid") words.reject("solid", word);
    words.skip_line();  // its name
    for (word = words.next(); word == "facet"; word = words.next()) {
      words.expect("normal");
      for (int k = 0; k < 3; ++k) words.next();  // it follows from the corners
      words.expect("outer");
      words.expect("loop");
      Triangle<double> triangle;
      for (auto& corner : triangle.corners) {
        words.expect("vertex");
        for (int k = 0; k < 3; ++k) corner[k] = scale * words.number();
      }
      words.expect("endloop");
      words.expect("endfacet");
      triangles.push_back(triangle);
      words.triangles = triangles.size();
    }
    if (word != "endsolid") words.reject("facet or endsolid", word);
    words.skip_line();
    word = words.next();
  }
  return triangles;
}

// Binary files may also begin with "solid"; they are recognised by their size.
inline bool is_text_stl(std::string_view bytes) {
  if (bytes.size() >= stl_header &&
      bytes.size() == stl_header + stl_triangle * stl_word(bytes, stl_header - 4)) {
    return false;
  }
  const auto letter = std::ranges::find_if(
      bytes, [](char c) { return std::isspace(static_cast<unsigned char>(c)) == 0; });
  std::string begin(bytes.substr(static_cast<Index>(letter - bytes.begin()), 5));
  std::ranges::transform(begin, begin.begin(), [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return begin == "solid" && bytes.substr(0, 512).find('\0') == std::string_view::npos;
}

}  // namespace detail

/// Reads the triangles of a binary or text file, in the order of the file. Normals and attributes
/// are ignored: normals follow from the corners. Throws silt::Error, naming file and triangle, if
/// the file cannot be read, has fewer or more triangles than it says, is not STL, has no triangles,
/// or contains a triangle without area or a number that is not finite.
inline std::vector<Triangle<double>> read_stl(const std::filesystem::path& path,
                                              const StlSettings& settings = {}) {
  require_positive("StlSettings: scale", settings.scale);
  require_between("StlSettings: scale", settings.scale, {1e-30, 1e30});
  const std::string bytes = file::read("read_stl", path);
  const std::string name = path.string();
  const auto triangles = detail::is_text_stl(bytes)
                             ? detail::text_stl(name, bytes, settings.scale)
                             : detail::binary_stl(name, bytes, settings.scale);
  if (triangles.empty()) fail({"read_stl: ", name, " has no triangles; check how it was exported"});
  for (Index t = 0; t < triangles.size(); ++t) {
    require_area("read_stl: " + name + ": triangle " + std::to_string(t), triangles[t]);
  }
  return triangles;
}

/// Writes triangles [m]; binary files are in single precision. Throws silt::Error if the file
/// cannot be written, or if a binary one cannot hold the number of triangles or a coordinate.
template <class Real>
void write_stl(const std::filesystem::path& path, const std::vector<Triangle<Real>>& triangles,
               StlFormat format = StlFormat::binary) {
  std::string bytes = format == StlFormat::binary ? std::string(detail::stl_header - 4, ' ')
                                                  : std::string("solid silt\n");
  const auto put = [&](std::uint32_t word) {
    for (int k = 0; k < 4; ++k) bytes += static_cast<char>(word >> (8 * k) & 0xff);
  };
  if (format == StlFormat::binary) {
    detail::require_in_binary_stl(triangles.size(), detail::largest_coordinate(triangles));
    put(static_cast<std::uint32_t>(triangles.size()));
  }
  for (const Triangle<Real>& triangle : triangles) {
    const auto& [a, b, c] = triangle.corners;
    const Vec<3, Real> normal = cross(Vec<3, Real>(b - a), Vec<3, Real>(c - a)).normalized();
    if (format == StlFormat::binary) {
      for (const auto& vector : {normal, a, b, c}) {
        for (const Real value : vector) put(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
      }
      bytes += std::string(2, '\0');
    } else {
      const auto numbers = [](const Vec<3, Real>& x) {
        std::string text;
        for (const Real value : x) text += " " + file::digits(value);
        return text + "\n";
      };
      bytes += "facet normal" + numbers(normal) + "outer loop\n";
      for (const auto& corner : triangle.corners) bytes += "vertex" + numbers(corner);
      bytes += "endloop\nendfacet\n";
    }
  }
  if (format == StlFormat::text) bytes += "endsolid silt\n";
  file::replace("write_stl", path, bytes);
}

}  // namespace silt
