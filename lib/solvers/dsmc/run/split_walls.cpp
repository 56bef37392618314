// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/split_walls.hpp"

#include <numeric>
#include <utility>

#include "pamr/adapt/adapt.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::dsmc {

SplitWalls split_walls(const par::Comm& comm, const mesh::DistMesh& mesh, const Flow& flow) {
  const auto& setup = flow.setup();
  SplitWalls split;
  split.is_at_wall.assign(at(mesh.n_cells()), 0);
  for (const auto& face : flow.domain().boundary)
    if (setup.patch[at(face.patch)].is_wall()) split.is_at_wall[at(face.cell)] = 1;
  split.n_split = comm.sum(std::accumulate(split.is_at_wall.begin(), split.is_at_wall.end(), std::int64_t{0}));
  refine::Options how;
  how.quality_control = refine::QualityControl::none;  // closure cells are halved too, and within themselves
  how.project = false;
  split.mesh = adapt::refine(comm, mesh, split.is_at_wall, how).mesh;

  constexpr std::size_t width = 2;
  std::vector<double> rows;  // of the cells before: whether it is at a wall, its time step
  for (std::size_t c = 0; c < split.is_at_wall.size(); ++c)
    rows.insert(rows.end(),
                {static_cast<double>(split.is_at_wall[c]), setup.cell_dt.empty() ? setup.dt : setup.cell_dt[c]});
  const IdRange before{mesh.info.n_global_cells, mesh.info.first_id};
  const auto& parents =
      mesh::require_cell_field(split.mesh, {mesh::parent_field, mesh::FieldValues::integer, 1, "--check-cells"})
          .integer();
  const auto of_parents = par::fetch_rows<double>(
      comm, before, par::scatter_rows<double>(comm, before, rows, width, mesh.cell_global), width, parents);
  for (std::size_t c = 0; c < parents.size(); ++c) {
    split.comes_from_wall.push_back(of_parents[width * c] != 0 ? 1 : 0);
    if (!setup.cell_dt.empty()) split.cell_dt.push_back(of_parents[width * c + 1]);
  }
  return split;
}

}  // namespace pamr::dsmc
