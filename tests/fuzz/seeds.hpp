// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "pamr/par/comm.hpp"

namespace pamr::fuzz {

/// Good files to be damaged: 0 a Kuhn cube with fields and patches as the library writes it; 1 a closure family; 2 the
/// `/VTKHDF` part alone in HDF5's oldest layout; 3 the same chunked and compressed, with texts of variable length; 4
/// all parts in the oldest layout and without checksums, so that damage reaches the values.
inline constexpr int n_seed_files = 5;
std::string seed_name(int i);
/// Writes them. For one rank.
void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder);

}  // namespace pamr::fuzz
