// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/locate/ask_ranks.hpp"

#include <array>

namespace pamr::locate {

std::vector<geometry::Box> gather_boxes(const par::Comm& comm, const geometry::Box& own) {
  const std::array<double, 6> values{own.low.x, own.low.y, own.low.z, own.high.x, own.high.y, own.high.z};
  std::array<std::vector<double>, 6> all;
  for (std::size_t i = 0; i < 6; ++i) all[i] = comm.all_gather(values[i]);
  std::vector<geometry::Box> boxes(at(comm.size()));
  for (std::size_t r = 0; r < boxes.size(); ++r)
    boxes[r] = {{all[0][r], all[1][r], all[2][r]}, {all[3][r], all[4][r], all[5][r]}};
  return boxes;
}

}  // namespace pamr::locate
