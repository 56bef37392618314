// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "pamr/base/exact.hpp"
#include "pamr/io/native/format.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

struct WriteOptions {
  /// Text that says where the mesh comes from (version, options that change the result, name of the case); empty: what
  /// the mesh brought with it. Nothing that differs from run to run belongs here: equal meshes give equal files.
  std::string provenance = {};
  /// `mesh::fingerprint` of the mesh where the caller has it already.
  std::optional<std::uint64_t> fingerprint = {};
  /// Number of the format, at most: a mesh without a map of level 0 has the same file in formats 2 and 3. Formats 1 and
  /// 2 have no place for that map: it is dropped. Format 1 has none for closure families other than 1:2 and 1:4, which
  /// are refused, nor for the ancestors that cells know, which are dropped.
  Exact<int> format = newest_format;
  /// Largest piece that a rank writes at once, bytes; 2^30 at most. Of rows that travel it is a sixteenth of a rank's
  /// share of the file at most, but 2^16 bytes or more.
  Exact<std::size_t> slab_bytes = std::size_t{1} << 20U;
  /// Told what the format has no place for, on every rank alike. None: silence.
  std::function<void(const std::string& remark)> remark = {};
};

/// Writes a mesh in the native format (docs/file-format.md), in global order.
/// - The bytes of the file depend on the mesh alone, not on the number of ranks nor on which rank holds what; fields
///   are written in the order of their names.
/// - The file appears complete or not at all: it is written under a temporary name, flushed to the disk and renamed.
/// - Collective. Throws the same `Error` on every rank when it cannot be written (folder missing, no permission, disk
///   full, a value that does not fit the type of its field, cells that `validate::require_shapes` refuses); nothing is left behind then and an existing file stays as
///   it was.
/// - Communication: rows travel to the rank that writes their part of the file; none of cells where the ranks hold runs
///   of them in rank order. Memory: five slabs and 12 bytes a node.
void write_native(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                  const WriteOptions& options = {});

}  // namespace pamr::io
