// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/setup.hpp"
#include "solvers/dsmc/run/flow_case.hpp"

namespace pamr::dsmc {

/// Everything in a case that shapes particles, random numbers, averages and history of a run, under the names that it
/// has in the case file; conditions by the patches of the mesh. A checkpoint carries it. Left out is what only says
/// when the run ends (`sampling`, `stop_error`) or what is read from the averages at the end (stations, lines, planes
/// of points), and the length of blocks, which `Averaging::resume` compares. The same on any number of ranks.
/// Collective: one reduction.
nlohmann::json facts_of(const par::Comm& comm, const Case& the_case, const Setup& setup, const mesh::DistMesh& mesh);

/// The vibration of a species as its case file states it, each mode of a degenerate one by itself. Local.
nlohmann::json facts_of(const Vibration& vibration);

/// Throws `Error` with the name and both values of each fact that differs unless a checkpoint with this header is one
/// of the case that has these facts. Local.
void require_same_case(const nlohmann::json& header, const nlohmann::json& facts);

/// The member of the header that holds the facts.
inline constexpr const char* facts_member = "case";

}  // namespace pamr::dsmc
