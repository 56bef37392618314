// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/foam/foam_order.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/io/export/write_foam.hpp"
#include "pamr/io/foam/foam_tokens.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::io {

std::int64_t count_other_faces(const par::Comm& comm, const std::filesystem::path& case_folder,
                               const mesh::DistMesh& mesh) {
  using Face = std::array<GlobalId, 2>;
  par::Mailbox<Face> box(comm);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (const auto next : mesh.cell_to_cell[at(c)]) {
      if (next < 0) continue;
      const auto other =
          mesh.is_ghost(next) ? mesh.ghost_global[at(next - mesh.n_cells())] : mesh.cell_global[at(next)];
      const auto own = mesh.cell_global[at(c)];
      if (own < other) box.add(0, {own - mesh.info.first_id, other - mesh.info.first_id});
    }
  const auto received = box.send().item;
  std::int64_t n_other = 0;
  par::agree(comm, [&] {
    const auto folder = foam_folder(case_folder);
    if (!comm.is_first() || !foam::is_present(folder / "owner")) return;
    std::vector<Face> faces(received.begin(), received.end());
    std::sort(faces.begin(), faces.end());
    const auto owner = foam::FoamFile(folder / "owner").labels(),
               neighbor = foam::FoamFile(folder / "neighbour").labels();
    const auto n = std::min({faces.size(), owner.size(), neighbor.size()});
    n_other = static_cast<std::int64_t>(std::max(faces.size(), neighbor.size()) - n);
    for (std::size_t f = 0; f < n; ++f) n_other += faces[f] != Face{owner[f], neighbor[f]} ? 1 : 0;
  });
  return comm.max(n_other);
}

}  // namespace pamr::io
