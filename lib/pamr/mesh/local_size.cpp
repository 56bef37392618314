// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/local_size.hpp"

#include <fmt/format.h>

#include "pamr/base/error.hpp"

namespace pamr::mesh {

void require_local_size(const par::Comm& comm, Exact<std::int64_t> n_cells, const std::string& what) {
  const auto most = comm.max(n_cells);
  if (most > max_local_cells)
    throw Error(fmt::format("{}: expected at most {} cells on a rank, found {}: use more than the {} ranks there are",
                            what, max_local_cells, most, comm.size()));
}

}  // namespace pamr::mesh
