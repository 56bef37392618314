// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/io/native/layout.hpp"
#include "pamr/io/native/slab_reader.hpp"
#include "pamr/mesh/block_mesh.hpp"

namespace pamr::io {

/// Gives a block the map of level 0, where the file has one: this rank's block of its rows. Every number is verified,
/// those of the two fields that name rows and nodes of level 0 too. `cells`, `nodes`: rows of the block. Its patches
/// lie on their surfaces, its fields are there. Collective; throws the same `Error` on every rank.
void read_level0(SlabReader& reader, const Layout& layout, Rows cells, Rows nodes, mesh::BlockMesh& block);

}  // namespace pamr::io
