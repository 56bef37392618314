// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/base/types.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Values on the triangles of a surface.
struct SurfaceField {
  std::string name;
  int n_components = 1;
  bool is_integer = false;         ///< said to be of 64-bit integers; real otherwise
  std::vector<double> value = {};  ///< n_triangles x n_components; of a corner field n_triangles x 3, corner by corner
  std::string unit = {};           ///< written as VTK's key UNITS_LABEL of the array; empty: none
};

/// This rank's triangles of a surface, each on a face of a cell. Any rank may give any of them, none twice.
struct SurfaceTriangles {
  IdRange all_cells = 0;            ///< of the mesh, the same on every rank
  std::vector<GlobalId> cell = {};  ///< n_triangles; triangles are written in the order of their cells
  std::vector<std::array<geometry::Vec3, 3>> corner = {};  ///< n_triangles, in the unit in which they are written
  std::vector<SurfaceField> corner_fields = {};            ///< the same names in the same order on every rank
  std::vector<SurfaceField> fields = {};                   ///< likewise
};

/// How the file is printed.
struct SurfaceVtuOptions {
  Exact<bool> shares_points =
      true;  ///< equal corners become one point; corner fields need false: points of its own for each
  Exact<int> coordinate_digits = 17;  ///< 17 keep every bit; values of fields are printed with 9
  Exact<bool> names_scalars =
      false;  ///< the first field on points and the first on cells are what a viewer shows at first
  std::string attributes =
      {};  ///< of the element VTKFile, in addition to type and version: " byte_order=\"LittleEndian\""
};

/// Writes triangles with fields as one `.vtu` file (VTK XML unstructured grid, text): for surfaces that people look at
/// and scripts read. Volumes are `write_vtu`'s.
/// - Order: by cell; the triangles of one cell as given. Shared points by their first use. So the bytes are the same on
///   any number of ranks.
/// - Collective: four sparse exchanges and one with the ranks that share points. No rank holds the surface; each prints
///   the triangles at its canonical block of the cells.
/// - Throws the same `Error` on every rank, and leaves nothing behind then.
/// - Cost: O(triangles log triangles) a rank, about 25 bytes of text for each number.
///
///   io::SurfaceTriangles wall{.all_cells = mesh.info.cell_ids()};
///   for (const auto& face : faces) {
///     wall.cell.push_back(mesh.cell_global[at(face.cell)]);
///     wall.corner.push_back(face.corner);
///   }
///   wall.fields = {{.name = "p", .value = pressure}, {.name = "tau", .n_components = 3, .value = shear}};
///   io::write_surface_vtu(comm, "wall.vtu", wall);
///
/// Source of the format: VTK file formats, "XML file formats".
void write_surface_vtu(const par::Comm& comm, const std::filesystem::path& file, const SurfaceTriangles& triangles,
                       const SurfaceVtuOptions& options = {});

}  // namespace pamr::io
