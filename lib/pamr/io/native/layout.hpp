// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pamr/io/native/catalog.hpp"
#include "pamr/io/native/format.hpp"
#include "pamr/io/native/level0_table.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::io {

/// Datasets of the native format.
namespace path {
inline constexpr const char* n_points = "/VTKHDF/NumberOfPoints";
inline constexpr const char* n_cells = "/VTKHDF/NumberOfCells";
inline constexpr const char* n_connectivity = "/VTKHDF/NumberOfConnectivityIds";
inline constexpr const char* points = "/VTKHDF/Points";
inline constexpr const char* connectivity = "/VTKHDF/Connectivity";
inline constexpr const char* offsets = "/VTKHDF/Offsets";
inline constexpr const char* types = "/VTKHDF/Types";
inline constexpr const char* point_data = "/VTKHDF/PointData";
inline constexpr const char* cell_data = "/VTKHDF/CellData";
/// Of the base cell of each cell, for viewers: written from the lineage, and never read.
inline constexpr const char* level = "/VTKHDF/CellData/level";
inline constexpr const char* cell_to_cell = "/PAMR/cell_to_cell";
inline constexpr const char* lineage = "/PAMR/lineage";
inline constexpr const char* boundary = "/PAMR/boundary";
inline constexpr const char* boundary_triangles = "/PAMR/boundary/triangles";
inline constexpr const char* boundary_patch = "/PAMR/boundary/patch";
inline constexpr const char* patches = "/PAMR/patches";
inline constexpr const char* patch_names = "/PAMR/patches/names";
inline constexpr const char* patch_kinds = "/PAMR/patches/kinds";
inline constexpr const char* patch_surfaces = "/PAMR/patches/surfaces";
inline constexpr const char* patch_numbers = "/PAMR/patches/numbers";
inline constexpr const char* patch_conditions = "/PAMR/patches/conditions";
inline constexpr const char* patch_groups = "/PAMR/patches/groups";
inline constexpr const char* regions = "/PAMR/regions";
inline constexpr const char* region_numbers = "/PAMR/regions/numbers";
inline constexpr const char* region_names = "/PAMR/regions/names";
inline constexpr const char* region_groups = "/PAMR/regions/groups";
inline constexpr const char* surfaces = "/PAMR/surfaces";
inline constexpr const char* surface_data = "/PAMR/surface_data";
inline constexpr const char* level0 = "/PAMR/level0";
inline constexpr const char* provenance = "/PAMR/provenance";
inline constexpr const char* checksums = "/PAMR/checksums";
}  // namespace path

inline constexpr int tetrahedron = 10;            ///< VTK's number of the cell type
inline constexpr std::size_t max_regions = 4096;  ///< with a name
inline constexpr std::size_t max_patch_numbers = std::size_t{1} << 16U;
inline constexpr std::size_t max_fields = 4096;  ///< of nodes, and as many of cells
inline constexpr int max_components = 65536;     ///< of a field
/// Bytes of a name of a field or surface and of a unit: they are names or values of attributes, which hold 64 KiB.
inline constexpr std::size_t max_name_bytes = 60000;

struct FieldEntry {
  std::string path, name, unit;
  bool on_cells = true;
  mesh::StorageType type = mesh::StorageType::float64;
  int n_components = 1;
  bool is_flat = true;     ///< one dimension
  GlobalId first_row = 0;  ///< of the values that count: those of the last time step
};

/// A triangulated surface; datasets `points` and `triangles` in the group `path`.
struct TriangulationEntry {
  std::string path, name;
  GlobalId n_points = 0, n_triangles = 0;
  mesh::StorageType points_type{}, triangles_type{};
};

/// The table of the map of level 0.
struct Level0Entry {
  GlobalId n_rows = 0;  ///< 0: the file has no map
  std::array<mesh::StorageType, level0_columns.size()> type{};
};

/// What a file contains, after every claim of its catalog was compared with the others. `info` has no surfaces yet.
struct Layout {
  mesh::MeshInfo info;
  int format = newest_format;
  mesh::StorageType points_type{}, connectivity_type{}, offsets_type{}, types_type{}, neighbors_type{}, lineage_type{};
  bool has_neighbors = false, has_lineage = false;
  GlobalId n_triangles = 0;  ///< of the boundary, with their patches; 0: the file has none
  mesh::StorageType triangles_type{}, triangle_patch_type{};
  std::vector<FieldEntry> fields;
  std::vector<TriangulationEntry> triangulations;
  Level0Entry level0;
  std::vector<std::string> remarks;  ///< what is odd and does no harm, or is left out
  std::string surfaces_toml;
  std::vector<std::string> surface_of_patch;  ///< names, in the order of `info.patches`; empty: none
};

/// Throws `Error` with file, dataset, what was expected and what was found. Local; the same on every rank, because the
/// catalog is.
Layout check_catalog(const Catalog& catalog, const std::filesystem::path& file, bool verify_checksums);

/// The name of a dataset's entry in `/PAMR/checksums`: its path without the first slash.
std::string checksum_path(const std::string& dataset);

/// What a checksum that does not agree means, for the error.
std::string damaged_or_changed(const std::string& dataset);

}  // namespace pamr::io
