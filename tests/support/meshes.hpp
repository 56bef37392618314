// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/par/comm.hpp"

/// Meshes for tests. All small: some are made whole on every rank and cut into blocks.
namespace pamr::test {

/// The surfaces that a text describes.
geometry::SharedSurfaces surfaces_of(const std::string& toml);

/// The unit cube of `assemble::kuhn_cube`, its patches tied to no surface.
mesh::BlockMesh kuhn_cube(const par::Comm& comm, int n);

/// A Kuhn cube whose inner nodes are moved at random, all cells exactly positive, and which is then permuted. The same
/// mesh, with the same numbers, on any number of ranks. Neighbors are given.
mesh::BlockMesh random_mesh(const par::Comm& comm, std::uint64_t seed, int n);

/// A rank drawn for each cell of the block, by its global number.
std::vector<Rank> random_destinations(const par::Comm& comm, const mesh::BlockMesh& block, std::uint64_t seed);

/// The same mesh with nodes and cells renumbered and each regular cell's corners in another even order. Members of
/// closure families stay together and keep their corners, which their template fixes. Collective.
mesh::BlockMesh permute(const par::Comm& comm, const mesh::BlockMesh& block, std::uint64_t seed);

/// The same mesh without neighbors (they are to be built) and without patches.
mesh::BlockMesh without_neighbors(mesh::BlockMesh block);

/// The same mesh with cells and nodes numbered from `first_id` on instead.
mesh::BlockMesh numbered_from(GlobalId first_id, mesh::BlockMesh block);

/// The whole mesh on every rank, in one block. Collective.
mesh::BlockMesh gather(const par::Comm& comm, const mesh::BlockMesh& block);
/// The same from a distributed mesh: cells and nodes by global number.
mesh::BlockMesh gather(const par::Comm& comm, const mesh::DistMesh& mesh);

/// This rank's blocks of a mesh that every rank holds whole.
mesh::BlockMesh cut(const par::Comm& comm, const mesh::BlockMesh& whole);
/// The same with cells cut where told: rank r holds cells `begin[r] .. begin[r+1])`, the last rank those to the end.
mesh::BlockMesh cut(const par::Comm& comm, const mesh::BlockMesh& whole, const std::vector<GlobalId>& begin);

/// A mesh from nodes and cells given whole on every rank, one patch `wall`, neighbors to be built.
mesh::BlockMesh small_mesh(const par::Comm& comm, std::vector<geometry::Vec3> nodes,
                           std::vector<std::array<GlobalId, 4>> cells);

/// A cell split 1:2 on edge `index` (4 + 1 nodes, 2 cells) or 1:4 on face `index` (4 + 3 nodes, 4 cells), with its
/// lineage, whole on every rank in one block.
mesh::BlockMesh closure_family(mesh::FamilyKind kind, int index);

}  // namespace pamr::test
