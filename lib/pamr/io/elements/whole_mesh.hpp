// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Contents of a file that one rank reads alone, before they become a mesh.
struct WholeMesh {
  std::vector<geometry::Vec3> point;
  std::vector<std::array<std::int64_t, 4>> cell;      ///< rows of the points, any order of corners
  std::vector<std::array<std::int64_t, 3>> triangle;  ///< rows of the points
  std::vector<std::int64_t> tag;                      ///< of the triangles; empty: they have none and are left out
  std::vector<std::int64_t> region;                   ///< of the cells; empty: none
  std::map<std::int64_t, mesh::Patch> patch_of_tag;   ///< `patch_N` where a tag is not in it
  std::map<std::int64_t, std::string> name_of_region;
  std::map<std::int64_t, std::vector<mesh::Group>> groups_of_region;  ///< of those with a name that are in several
  std::vector<mesh::Field> cell_fields, node_fields;
  std::vector<GroupOverlap> overlaps;
  std::vector<std::string> remarks;              ///< what else the reader has changed or left out, in one line each
  std::vector<std::string> notes;                ///< as in `ElementMesh`
  std::map<std::string, std::int64_t> left_out;  ///< as in `ElementParts`
  std::map<int, std::int64_t> refused, cut;      ///< as in `ElementParts`
};

/// Makes a mesh of what the first rank reads, as `mesh_of_elements` does: `read` is called on that rank. Its `Error`
/// gets the name of the file unless it begins with that. Throws `Error` for names that cannot stand in a mesh.
/// Collective.
ElementMesh mesh_of_whole(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options,
                          const std::function<WholeMesh()>& read);

}  // namespace pamr::io
