// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Reads a CGNS file on HDF5 of one unstructured zone of tetrahedra, without CGNS's library. Triangles belong to the
/// boundary condition (or its family) that names them by elements, or else to their section: these become patches, with
/// kinds by the type of the condition. Solutions at vertices and cell centers become fields, those named vX, vY and vZ one of three
/// components; an integer field `region` has the regions.
///
/// Rank 0 reads the file as a whole. Collective. Throws the same `Error` on every rank for what is no such file, for
/// several bases or zones and structured ones, for cells or triangles of equal numbers, and for what `mesh_of_elements`
/// refuses.
ElementMesh read_cgns(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options = {});

/// Reads, and drops, all that `read_cgns` does, each array after a call of `before_read` with its bytes in memory: for
/// a process that may die of a damaged file, without MPI. Local.
void try_reading_cgns(const std::filesystem::path& file, const std::function<void(std::uint64_t bytes)>& before_read);

}  // namespace pamr::io
