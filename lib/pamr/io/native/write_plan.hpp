// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/native/row_transport.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// A dataset of numbers to be written.
struct ArrayPlan {
  std::string path;
  mesh::StorageType type{};
  hdf5::Shape shape{};
  /// Its rows on this rank; one of them may stand for several rows of a flat dataset.
  HeldRows rows;
  /// Set instead of `rows.fill` where a row's one value follows from its number: writes those from `first` on.
  std::function<void(GlobalId first, std::span<std::uint64_t> values)> formula = {};
  bool has_checksum = true;
  std::string unit = {};
};

/// Bytes of the dataset in the file.
inline std::uint64_t bytes_of(const ArrayPlan& plan) {
  return static_cast<std::uint64_t>(plan.shape.rows * plan.shape.width) * hdf5::size_of(plan.type);
}

/// A dataset of text to be written, the same on every rank: one text, or a list.
struct TextPlan {
  std::string path;
  std::vector<std::string> texts;
  bool is_list = false;
};

/// All the datasets of a mesh in the order in which they are written. Refers to the mesh, which must outlive it.
struct WritePlan {
  /// Cells are written by the ranks that hold them where these hold runs, by canonical blocks elsewhere. Of the
  /// triangulated surfaces, which every rank has whole, each gives its part. Collective.
  WritePlan(const par::Comm& comm, const mesh::DistMesh& mesh, int format, const std::string& provenance);
  WritePlan(const WritePlan&) = delete;
  WritePlan& operator=(const WritePlan&) = delete;
  WritePlan(WritePlan&&) = delete;
  WritePlan& operator=(WritePlan&&) = delete;
  ~WritePlan() = default;

  std::vector<std::string> groups;  ///< those that only some meshes have
  std::vector<ArrayPlan> arrays;
  std::vector<TextPlan> texts;
  std::uint64_t data_bytes = 0;  ///< of all datasets together
  int file_format;               ///< that of the file

 private:
  void add_mesh(int format);
  void add_field(const mesh::Field& field, bool on_cells);
  void add_level();
  /// One number of each patch, if any has one.
  void add_patch_numbers(const char* path, std::int64_t mesh::Patch::*number);
  /// The groups of each patch or region, if any is in several.
  template <class Part>
  void add_groups(const char* path, const std::vector<Part>& parts);
  void add_regions();
  void add_level0(const mesh::Level0Map& map);
  void add_texts(const std::string& provenance);
  void add_triangulation(const par::Comm& comm, const geometry::Triangulation& surface);
  template <class FillRow>
  HeldRows cell_rows(std::size_t width, FillRow fill_row) const;
  template <class FillRow>
  HeldRows node_rows(std::size_t width, FillRow fill_row) const;

  const mesh::DistMesh* mesh_;
  std::vector<GlobalId> cell_run_;            ///< as `mesh::cell_runs` has it
  std::vector<std::uint32_t> node_order_;     ///< nodes in the order of their global ids
  std::vector<GlobalId> node_id_;             ///< those ids
  std::deque<std::vector<GlobalId>> row_id_;  ///< rows given of datasets that are neither of cells nor of nodes
};

/// Whether a file of this format has a place for the map of level 0, and the mesh has one. Without, the fields of the
/// map are not written either.
bool writes_level0(const mesh::DistMesh& mesh, int format);

/// Throws `Error` when names of fields or patches could not be read back, and when the format has no place for a cell's
/// lineage. Local.
void require_writable(const mesh::DistMesh& mesh, int format);

}  // namespace pamr::io
