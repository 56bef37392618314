// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// One way in which two meshes differ.
struct Difference {
  std::string what;                 ///< of what kind: "cells", "nodes", "patches", "lineage", "field NAME", ...
  std::string text;                 ///< the whole sentence
  std::int64_t count = 0;           ///< how many things differ
  GlobalId first = invalid_global;  ///< the smallest of their numbers
  double largest = 0;               ///< largest difference of numbers, where numbers were compared
};

struct Comparison {
  std::vector<Difference> differences;  ///< the most basic first; empty: the same mesh and fields
  std::vector<std::string> notes;       ///< what differs but is neither mesh nor field: units, surfaces, storage types
  std::vector<std::string> fields;      ///< fields that both have and that were compared
};

/// Compares two valid meshes and their fields, whatever the order of nodes and cells and of the corners in a cell, and
/// however they lie on the ranks. Nodes are matched by their coordinates, each within `tolerance` (length unit), cells
/// by their nodes, boundary faces by the names of their patches, closure cells by kind and level. Field values may
/// differ by `tolerance` times max(1, |a|, |b|). Tolerance 0: all must be equal.
/// Collective. O(n log n) time, and memory for both meshes and all their fields once more.
Comparison compare_meshes(const par::Comm& comm, const mesh::DistMesh& a, const mesh::DistMesh& b, double tolerance);

}  // namespace pamr::check
