// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "pamr/par/comm.hpp"

namespace pamr::fuzz {

/// What a reader is to be tried with; each format has a file of its own that defines these.
/// Good files to be damaged, by name.
int n_seed_files();
std::string seed_name(int i);
/// Writes them. For one rank.
void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder);
/// A damaged copy of a good one, always the same for the same seed: `mutate` where the format has no sums to be set
/// right again.
std::string damaged(const std::string& good, std::uint64_t seed);
/// Reads a file with the reader under test. For one rank. Any exception but `pamr::Error` is a failure.
void read_file(const par::Comm& comm, const std::filesystem::path& file);

}  // namespace pamr::fuzz
