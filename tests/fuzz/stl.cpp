// SPDX-License-Identifier: MIT
// Fuzz target: any bytes as an STL file, and a mesh wall of the triangles that are read.
#include <silt/core/triangle.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>
#include <silt/io/stl.hpp>

#include "fuzz/target.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace {

using namespace silt;
using Triangles = std::vector<Triangle<double>>;

void require_same(const Triangles& a, const Triangles& b) {
  fuzz::require(a.size() == b.size(), "another number of triangles is read back");
  for (Index t = 0; t < a.size(); ++t) {
    fuzz::require(a[t].corners == b[t].corners, "another triangle is read back");
  }
}

void use_as_wall(const Triangles& triangles) {
  fuzz::accepts([&] {
    const dem::MeshWall wall(triangles);
    const Vec<3> x = triangles.front().corners[0];
    for (Index element = 0; element < wall.element_count(); ++element) {
      (void)wall.nearest(element, x);
    }
    wall.for_each_element_near(x, 1e-3, [](Index) {});
  });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile file;
  file.write(fuzz::as_text(data, size));
  Triangles triangles;
  fuzz::require_memory(4, size, [&] { fuzz::accepts([&] { triangles = read_stl(file.path()); }); });
  if (triangles.empty()) return 0;
  for (const auto& triangle : triangles) {
    for (const auto& corner : triangle.corners) {
      fuzz::require(is_finite(corner), "a corner that is not finite is read");
    }
  }
  use_as_wall(triangles);
  write_stl(file.path(), triangles, StlFormat::text);
  require_same(read_stl(file.path()), triangles);
  return 0;
}
