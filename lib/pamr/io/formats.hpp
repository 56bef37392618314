// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/io/gmsh/write_gmsh.hpp"
#include "pamr/io/native/format.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/second_order.hpp"
#include "pamr/par/comm.hpp"

/// Which ending of a name stands for which format of meshes, and who reads and writes it. The tools and the Python
/// package ask this table, and so do the messages that list endings.
namespace pamr::io {

/// Options of the readers. Each heeds those that its format has.
struct MeshReadOptions {
  Exact<bool> repair = true;                                   ///< see `ElementOptions`
  Exact<bool> split_prisms = false;                            ///< likewise
  Exact<bool> build_surfaces = true;                           ///< see `ReadOptions`, of native files
  std::function<void(const std::string& remark)> remark = {};  ///< likewise
  std::filesystem::path solution = {};                         ///< see `MeditOptions`
  std::vector<std::string> field_names = {};                   ///< likewise
};

/// Options of the writers. Each heeds those that its format has.
struct MeshWriteOptions {
  std::string provenance = {};                                 ///< see `WriteOptions`, of native files
  Exact<int> format = newest_format;                           ///< likewise
  std::function<void(const std::string& remark)> remark = {};  ///< likewise
  std::function<void(const std::string& note)> note = {};      ///< hears of what only native files have a place for
  GmshWriteOptions gmsh = {};                                  ///< the interfaces are for Medit, too
  const mesh::SecondOrder* second_order = nullptr;             ///< null for linear cells
  std::vector<std::string> patches = {};                       ///< see `write_boundary`
  std::vector<const mesh::Field*> kept = {};                   ///< fields that the caller writes elsewhere
};

struct Format {
  std::string_view name;                  ///< of the format, or of the program that it belongs to
  std::vector<std::string_view> endings;  ///< in lower case; that of a folder is empty
  /// Null for a format that is only written.
  ElementMesh (*read)(const par::Comm& comm, const std::filesystem::path& file, const MeshReadOptions& options);
  /// Null for a format that is only read.
  void (*write)(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                const MeshWriteOptions& options);
  std::string_view instead_of_reading = {};  ///< what was found and what to do, where that is known
  bool is_native = false;
  bool has_elements = false;  ///< read element by element (`mesh_of_elements`): of another program, of level 0
  bool is_surface = false;    ///< holds the boundary alone
  bool is_folder = false;
  bool wants_every_face = false;                          ///< has a place in a patch for each face of the boundary
  bool has_inner_patches = false;                         ///< has a place for patches of faces inside
  bool has_fields = false, has_regions = false;           ///< has a place for fields, for the field `region`
  bool has_names = true;                                  ///< of patches
  bool has_numbers = false;                               ///< of patches, as the user gave them
  bool has_region_names = false;                          ///< `mesh::Region::name`
  bool has_groups = false;                                ///< `mesh::Group`, of patches on the boundary
  bool has_groups_inside = false;                         ///< also of regions and of patches inside alone
  bool has_empty_patches = false;                         ///< keeps patches without faces
  bool has_untagged_name = false;                         ///< also that of faces without a tag, by its name
  std::vector<std::string_view> kinds = {};               ///< of patches on the boundary that it has a place for
  bool has_interfaces = false, has_second_order = false;  ///< can be written with these
  bool has_text = false;                                  ///< `GmshWriteOptions` hold
  bool has_solutions = false;                             ///< has fields in a `.sol` beside the mesh
  std::filesystem::path (*file_beside)(const std::filesystem::path& file) = nullptr;  ///< read or written as well
};

std::span<const Format> formats();

/// The format that the ending of a name says, null where it says none. Local.
const Format* find_format(const std::filesystem::path& file);

/// The same for a mesh to read. Throws `Error` that lists the endings of meshes that can be read. Local.
const Format& format_to_read(const std::filesystem::path& file);

/// The same for a mesh to write, or its boundary: OpenFOAM's also where a folder of that name exists. Throws `Error`
/// that lists the endings. Collective; the same on every rank.
const Format& format_to_write(const par::Comm& comm, const std::filesystem::path& file);

/// Whether a name ends as that of a mesh in another format than the native one does. Local.
bool is_foreign_name(const std::filesystem::path& file);

/// The endings of those formats that are chosen: ".msh, .mesh or .meshb"; `before_last` is " or " there.
std::string list_endings(const std::function<bool(const Format&)>& is_chosen, std::string_view before_last);
/// The same for one format.
std::string list_endings(const Format& format, std::string_view before_last);

/// Reads a mesh, and says what its reader had to change (`remarks_of` puts that into words). Collective; throws the
/// same `Error` on every rank.
ElementMesh read_mesh(const par::Comm& comm, const std::filesystem::path& file, const MeshReadOptions& options = {});

/// Writes a mesh. `options.remark` gets a sentence for fields, regions, conditions, names, kinds, groups and patches of
/// inner faces that the format has no place for, `options.note` one for levels, surfaces and the unit of lengths, and
/// one for boundary faces without a tag that the format wants in a patch. The bytes do not depend on the number of
/// ranks. Collective; throws the same `Error` on every rank, and leaves nothing behind then.
void write_mesh(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                const MeshWriteOptions& options = {});

}  // namespace pamr::io
