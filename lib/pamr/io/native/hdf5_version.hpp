// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pamr::io {

/// Version of the HDF5 library that this process has loaded: "1.10.8". Local.
std::string hdf5_version();

}  // namespace pamr::io
