// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/toml_table.hpp"

namespace pamr {

/// One case file serves every tool. These are the top-level tables that the tools know; each tool reads its own,
/// ignores those of the others, and refuses tables that are not listed here. A tool that learns a new table adds it.
inline constexpr std::array<std::string_view, 27> case_tables{
    // surfaces (pamr-mesh, pamr-convert) and level-0 meshes (pamr-mesh)
    "surface", "mesh",
    // rarefied gas (pamr-dsmc); [boundary] is also read by pamr-pb
    "adapt", "boundary", "collisions", "domain", "gas", "initial", "line", "particles", "plane", "reference", "run",
    "species", "station", "stream", "time",
    // Poisson-Boltzmann equation (pamr-pb)
    "body", "electrolyte", "equation", "estimator", "force", "lengths", "pair", "plate", "solver", "sphere"};

/// `parse_toml` of a case file: its `finish` accepts the tables of all tools.
TomlTable parse_case(std::string_view text, const std::string& where);

/// The files that a case file of this text names, for whatever tool: surfaces and species. Their names are taken as
/// beside the case file `where`. Throws `Error` for what is no TOML; a table that its tool will refuse names no file.
/// Local.
std::vector<std::string> files_of_case(std::string_view text, const std::string& where);

}  // namespace pamr
