// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/io/gmsh/gmsh_parts.hpp"

namespace pamr::io::gmsh {

/// Reads what follows `$MeshFormat` in a file of version 4.1, text or binary: the share of one rank. Local; throws
/// `Error`.
Parts read_parts_4(TextCursor& in, bool is_binary, Share share);

}  // namespace pamr::io::gmsh
