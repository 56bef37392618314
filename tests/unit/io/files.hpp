// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/par/comm.hpp"

/// What the tests of the native file share.
namespace pamr::test {

/// A folder of its own for a test, the same on every rank, removed at the end. Collective.
class Folder {
 public:
  explicit Folder(const par::Comm& comm);
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  Folder(Folder&&) = delete;
  Folder& operator=(Folder&&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Number of files and folders in it.
  std::size_t n_entries() const;

 private:
  const par::Comm* comm_;
  std::filesystem::path path_;
};

/// A Kuhn cube of 6 n^3 cells on random ranks, with a field of every kind. Collective.
mesh::DistMesh mesh_with_fields(const par::Comm& comm, int n, std::uint64_t seed);

/// Cell `row` of three that the map of `mesh_with_level0` has.
mesh::Level0Cell level0_cell(GlobalId row);

/// `mesh_with_fields` of 48 cells with a map of level 0, made by hand: cells in rows 0, 1, 2 and none, over and over;
/// nodes without a key, of level 0, and in the middle of an edge. Collective.
mesh::DistMesh mesh_with_level0(const par::Comm& comm);

/// Runs `edit` on the first rank between two barriers.
void on_first_rank(const par::Comm& comm, const std::function<void()>& edit);

/// The message of the `Error` that reading throws, or its first remark, on every rank; "no error" when there is none.
/// Collective.
std::string error_of_reading(const par::Comm& comm, const std::filesystem::path& file);

/// A mesh of the unit cube's Kuhn tetrahedra with nothing but `/VTKHDF`, written without the library: 8 nodes, 6 cells.
void write_plain_vtkhdf(const std::filesystem::path& file, bool chunked);

}  // namespace pamr::test
