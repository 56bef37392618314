// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pamr::par {

/// Name and version of the MPI library that this process has loaded: "Open MPI 4.1.4". Local; may be called before MPI
/// is initialized.
std::string mpi_version();

}  // namespace pamr::par
