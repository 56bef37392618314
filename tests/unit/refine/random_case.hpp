// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "support/dice.hpp"
#include "support/places.hpp"

/// Random refinements: how many, what is marked, and how results are brought together.
namespace pamr::test {

/// How many cases of each property: few by default, many where the environment says PAMR_TEST_LEVEL=full.
bool is_full_level();
inline std::uint64_t n_cases(std::uint64_t quick, std::uint64_t full) { return is_full_level() ? full : quick; }

/// The same, where `full` are those on 1, 2, 3 and 4 ranks together: a half, a quarter, three and one sixteenth of them. Many ranks wait
/// for each other on few cores: on more than four at most 40.
std::uint64_t n_cases_on(const par::Comm& world, std::uint64_t quick, std::uint64_t full);

/// Seeds of the cases that this rank goes through alone: 50 (full: 1,000) on one rank; 7 (full: 40) others on more
/// ranks, shared out among them.
std::vector<std::uint64_t> seeds_alone(const par::Comm& world);

/// How many cases all ranks go through together: 50 on one rank, 24 on up to four, 10 on more (full: 1,000 on one rank, as many on two
/// to four, 40 on more).
std::uint64_t n_cases_together(const par::Comm& world);

/// What is marked: some cells by lot, those cut by a sphere, or those in a corner. By coordinates only, so that marks
/// depend neither on the numbering nor on the distribution.
enum class Law { random, sphere, corner };
inline Law law_of(std::uint64_t seed) { return static_cast<Law>(seed % 3); }

std::vector<std::uint8_t> mark(const mesh::DistMesh& mesh, Law law, std::uint64_t seed);
std::vector<std::uint8_t> mark(const mesh::BlockMesh& whole, Law law, std::uint64_t seed);

/// The whole mesh and its field `parent` on one rank, cells and nodes by number; nothing on the others. Collective.
mesh::BlockMesh gather_on(const par::Comm& comm, const mesh::DistMesh& mesh, Rank root);

/// An array, byte after byte, behind its length.
template <class T>
void append_bytes(const std::vector<T>& values, std::string& bytes) {
  bytes += std::to_string(values.size()) + ":";
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// All that a mesh is, byte after byte, but for its cell fields.
std::string bytes_of(const mesh::BlockMesh& whole);

/// Moves a third of the nodes at random as far as all cells stay positive. Parents of families may turn over by that.
void shake(mesh::BlockMesh& whole, std::uint64_t seed);

/// Distributes a mesh that every rank holds whole: every cell's rank drawn by lot, or in blocks where `seed` is a
/// multiple of four. Collective.
mesh::DistMesh scatter(const par::Comm& comm, const mesh::BlockMesh& whole, std::uint64_t seed);

/// The whole mesh of one rank on all ranks. Collective.
mesh::BlockMesh broadcast(const par::Comm& comm, const mesh::BlockMesh& whole, Rank root);

/// Some of the cells whose base cell is not among those to be reached; the first of them, so that it goes on.
std::vector<std::uint8_t> flag_some(const mesh::BlockMesh& whole, const Places& reached, Dice& dice);

}  // namespace pamr::test
