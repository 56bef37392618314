// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/cell_runs.hpp"

namespace pamr::mesh {

std::vector<GlobalId> cell_runs(const par::Comm& comm, const DistMesh& mesh) {
  auto run = comm.all_gather(static_cast<std::int64_t>(mesh.cell_global.size()));
  run.insert(run.begin(), mesh.info.first_id);
  for (std::size_t r = 1; r < run.size(); ++r) run[r] += run[r - 1];
  const auto here = static_cast<std::size_t>(comm.rank());
  const bool is_run = mesh.cell_global.empty() ||
                      (mesh.cell_global.front() == run[here] && mesh.cell_global.back() == run[here + 1] - 1);
  return comm.all(is_run) ? run : std::vector<GlobalId>{};
}

}  // namespace pamr::mesh
