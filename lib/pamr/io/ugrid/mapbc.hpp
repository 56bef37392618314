// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pamr/io/written_names.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// The boundary conditions that go with a UGRID file. Source: FUN3D manual (NASA), "Boundary Conditions"; lines as the
/// program refine (github.com/nasa/refine) reads them: number of the surface, condition, name.
namespace pamr::io::ugrid {

struct Conditions {
  bool is_there = false;                        ///< the file
  std::map<std::int64_t, mesh::Patch> patches;  ///< by the number of their surface
  std::int64_t n_more_lines = 0;                ///< with text, behind as many as the file announces
};

/// A file that is not there says nothing. Collective; throws the same `Error` on every rank, with the line.
Conditions read_mapbc(const par::Comm& comm, const std::filesystem::path& file);

/// What of these conditions has no place in a mesh, and surfaces of the mesh that they leave out, with counts and the
/// first of each. Local.
std::vector<std::string> remarks_of(const Conditions& conditions, const std::filesystem::path& file,
                                    const mesh::MeshInfo& info);

/// The kind of patch that a condition stands for, empty for those that have none.
std::string kind_of_condition(std::int64_t condition);
/// The condition for a kind: `axis` 0 to 2 for a patch in a plane of constant x, y or z, else -1. 0 for no kind.
std::int64_t condition_of_kind(const std::string& kind, int axis);

/// The text of a file: patches keep the condition that they came with unless they have got another kind. Those without
/// faces have no line. `number`, `axis` and `n_faces`: of each patch.
std::string mapbc_text(const mesh::MeshInfo& info, const std::vector<std::int64_t>& number,
                       const std::vector<int>& axis, const std::vector<std::int64_t>& n_faces, const Remark& remark);

}  // namespace pamr::io::ugrid
