// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

namespace pamr::io::ugrid {

/// Numbers of things in a file, in the order of its head.
struct Counts {
  std::int64_t nodes = 0, triangles = 0, quadrangles = 0, tetrahedra = 0, pyramids = 0, prisms = 0, hexahedra = 0;
};

/// Where the parts of a binary file of reals of 8 and integers of 4 bytes begin. Source: UG_IO documentation, "UGRID 3D
/// Grid File Type" (simcenter.msstate.edu).
struct Layout {
  static constexpr std::int64_t head = std::int64_t{7} * 4;
  std::int64_t triangles = 0, quadrangles = 0, references = 0, tetrahedra = 0, pyramids = 0, prisms = 0;
  std::int64_t bytes = 0;  ///< without what may follow the cells
};
constexpr Layout layout_of(const Counts& n) {
  Layout layout;
  layout.triangles = Layout::head + 24 * n.nodes;
  layout.quadrangles = layout.triangles + 12 * n.triangles;
  layout.references = layout.quadrangles + 16 * n.quadrangles;
  layout.tetrahedra = layout.references + 4 * (n.triangles + n.quadrangles);
  layout.pyramids = layout.tetrahedra + 16 * n.tetrahedra;
  layout.prisms = layout.pyramids + 20 * n.pyramids;
  layout.bytes = layout.prisms + 24 * n.prisms + 32 * n.hexahedra;
  return layout;
}

/// Whether the name says that the greatest byte comes first: `.b8.ugrid`; `.lb8.ugrid` has the least first. Throws
/// `Error` for other kinds of UGRID files.
bool is_big_endian(const std::filesystem::path& file);

/// The file of boundary conditions that goes with a grid: `part.mapbc` for `part.lb8.ugrid`.
std::filesystem::path mapbc_of(const std::filesystem::path& file);

}  // namespace pamr::io::ugrid
