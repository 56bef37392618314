// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pamr/adapt/parent_data.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// Data of a solver that belongs to cells and is no field, in a file beside that of the mesh: a coupled run is saved
/// with `io::write_native` and `write_cell_rows`, and goes on, on any number of ranks, with `io::read_native` and
/// `read_cell_rows`. The format: docs/file-format-checksums.md.
namespace pamr::adapt {

namespace detail {
/// The same for items of a size that shows when the program runs.
void write_cell_rows(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                     const ByteRows& rows, const std::string& description);
std::pair<CellRows<std::byte>, std::string> read_cell_rows(const par::Comm& comm, const std::filesystem::path& file,
                                                           const mesh::DistMesh& mesh, std::size_t item_bytes);
}  // namespace detail

/// Longest description of what the rows are, bytes.
inline constexpr std::size_t max_rows_description = 64;

/// Writes a row for each cell of the mesh; the same bytes on any number of ranks, where T has no padding. The file gets
/// its name when it is complete. `description` comes back from reading (the name and version of the data, say).
/// Collective. Throws the same `Error` on every rank.
template <class T>
void write_cell_rows(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                     const CellRows<T>& rows, const std::string& description = {}) {
  detail::write_cell_rows(comm, file, mesh, detail::bytes_of(rows), description);
}

/// What `read_cell_rows` gives.
template <class T>
struct SavedRows {
  CellRows<T> rows;  ///< of this rank's cells
  std::string description;
};

/// The rows of this rank's cells of the mesh that they were written with, which may lie on the ranks in any way and on
/// other ranks than it was written by. Nothing in the file is trusted. Collective. Throws the same `Error` on every
/// rank for a damaged file, items of another size than T, and another mesh or numbering of it.
template <class T>
SavedRows<T> read_cell_rows(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh) {
  static_assert(std::is_trivially_copyable_v<T>);
  auto [rows, description] = detail::read_cell_rows(comm, file, mesh, sizeof(T));
  SavedRows<T> result{{std::move(rows.offset), std::vector<T>(rows.value.size() / sizeof(T))}, std::move(description)};
  if (!rows.value.empty()) std::memcpy(result.rows.value.data(), rows.value.data(), rows.value.size());
  return result;
}

}  // namespace pamr::adapt
