// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/local_size.hpp"

#include "pamr/base/error.hpp"

namespace pamr::mesh {

void require_local_size(const par::Comm& comm, std::int64_t n_cells, const std::string& what) {
  const auto most = comm.max(n_cells);
  if (most > max_local_cells)
    throw Error(what + ": expected at most " + std::to_string(max_local_cells) + " cells on a rank, found " +
                std::to_string(most) + ": use more than the " + std::to_string(comm.size()) + " ranks there are");
}

}  // namespace pamr::mesh
