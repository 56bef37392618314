// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pamr/par/comm.hpp"

namespace pamr::cli {

/// The text of a small file (a case, surfaces), read by rank 0 and given to all. Collective. Throws `Error` on every
/// rank when it cannot be read.
std::string read_text(const par::Comm& comm, const std::string& path);

}  // namespace pamr::cli
