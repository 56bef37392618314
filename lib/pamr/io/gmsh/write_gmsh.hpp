// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

#include "pamr/base/exact.hpp"
#include "pamr/io/interfaces.hpp"
#include "pamr/io/written_names.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/second_order.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

enum class GmshVersion : std::uint8_t { v2_2, v4_1 };

struct GmshWriteOptions {
  GmshVersion version = GmshVersion::v4_1;
  Exact<bool> binary = true;
  Interfaces interfaces = Interfaces::patches;
  Remark remark = {};  ///< hears of names that the format cannot have
};

/// Writes nodes, boundary triangles and tetrahedra in Gmsh's format: patches become physical surfaces of their
/// names and numbers (`patch_numbers`; faces between regions, where asked for, have free ones), values of an integer cell field `region`
/// physical volumes of these numbers with the names they have (volume 1 without the field; regions 0 and below get the
/// lowest free numbers and the names `region_N`, which `read_gmsh` knows). Double quotes in names become single ones. Nodes are numbered from 1 in global order,
/// and so are the elements: triangles patch by patch, then cells (4.1: region by region). Fields are left out. Text has
/// 17 digits, which read back as the same numbers. The same bytes on any number of ranks. With `second_order` cells and
/// triangles are of second order (Gmsh's types 11 and 9). A name is what Gmsh reads back: `'` stands for `"`, and what
/// goes beyond 127 bytes is cut.
///
/// Collective; throws the same `Error` on every rank (where two names would become one; in 2.2 binary also for more than 2^31 nodes or elements, which
/// that format cannot number) and leaves nothing behind then.
void write_gmsh(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                const GmshWriteOptions& options = {}, const mesh::SecondOrder* second_order = nullptr);

}  // namespace pamr::io
