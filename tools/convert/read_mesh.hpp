// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/session.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::convert {

struct ReadRequest {
  std::string file;
  bool strict = false;                   ///< what would be reported is an error
  bool split_prisms = false;             ///< `io::ElementOptions::split_prisms`
  bool build_surfaces = false;           ///< of a native file
  std::string solution;                  ///< .sol or .solb beside a Medit mesh; empty: none
  std::vector<std::string> field_names;  ///< of its fields
};

struct ReadMesh {
  mesh::DistMesh mesh;
  std::vector<std::string> warnings, notes;  ///< what the reader had to change, to be said of a valid mesh
};

/// Reads a mesh of any format; `report` says, too, what the reader had to change. Throws `Error` on every rank.
/// Collective.
ReadMesh read_mesh(cli::Session& session, const ReadRequest& request, nlohmann::json& report);

/// Multiplies the coordinates and, if somebody `needs_surfaces`, what they are made of; else these stay as they are.
/// Throws `Error` for surfaces that cannot be scaled, and for coordinates beyond the range of numbers. Collective.
void scale_mesh(const par::Comm& comm, mesh::DistMesh& mesh, double factor, bool needs_surfaces);

/// Gives patches their kinds: each pair is PATCH=KIND. Throws `Error` for patches that are not there and for kinds that
/// are not known.
void set_kinds(const std::vector<std::string>& pairs, mesh::DistMesh& mesh);

}  // namespace pamr::convert
