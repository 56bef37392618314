// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/io/gmsh/gmsh_parts.hpp"

namespace pamr::io::gmsh {

/// Reads what follows `$MeshFormat` in a file of version 2.2, text or binary: the share of one rank. Local; throws
/// `Error`.
Parts read_parts_2(TextCursor& in, bool is_binary, Share share);

}  // namespace pamr::io::gmsh
