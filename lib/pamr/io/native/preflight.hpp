// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "pamr/io/native/catalog.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// The contents of a file: what `inspect` lists on rank 0. A damaged file may kill HDF5 1.10 there
/// (docs/file-format.md, *Damaged files*). Collective; the same catalog or `Error` on every rank.
Catalog catalog_of(const par::Comm& comm, const std::filesystem::path& file);

/// Whether there is the mark with which HDF5 files begin, at one of the places where HDF5 looks for it. Local.
bool has_hdf5_signature(const std::filesystem::path& file);

/// Reads, and drops, what HDF5 1.10 may not survive in a damaged file: the structure, and the datasets in chunks, each
/// after a call of `before_dataset` with its bytes. For a process that may die of it, without MPI: one more reading of
/// such datasets is the price. Throws `Error` for a bad file. Local.
void try_reading(const std::filesystem::path& file, const std::function<void(std::uint64_t bytes)>& before_dataset);

}  // namespace pamr::io
