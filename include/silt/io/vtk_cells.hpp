// SPDX-License-Identifier: MIT
// Frames of faces for ParaView: lines in 2D, triangles in 3D.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/io/vtk.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace silt::detail {

/// The XML element of an array.
template <class Values>
std::string vtk_xml(std::string_view name, const Values& values) {
  return xml_of(vtk_array<typename Values::value_type>(name, values));
}

/// One frame, as the bytes of a .vtu file, of lines or triangles with these corners [m], two or
/// three of each; `data` are the XML elements of what belongs to each.
template <int Dim>
[[gnu::cold]] std::string vtk_frame_of_cells(const Buffer<Vec<Dim>>& corners, Index corners_of_each,
                                             const std::string& data) {
  const Index cells = corners.size() / corners_of_each;
  Buffer<std::int64_t> numbers(corners.size()), ends(cells);
  for (Index k = 0; k < numbers.size(); ++k) numbers[k] = std::int64_t(k);
  for (Index k = 0; k < cells; ++k) ends[k] = std::int64_t((k + 1) * corners_of_each);
  const Buffer<std::uint8_t> types(cells, corners_of_each == 2 ? 3 : 5);  // VTK_LINE, VTK_TRIANGLE
  return vtk_file(
      corners.size(), cells, vtk_xml("position", corners),
      vtk_xml("connectivity", numbers) + vtk_xml("offsets", ends) + vtk_xml("types", types), "",
      "<CellData>\n" + data + "</CellData>\n");
}

}  // namespace silt::detail
