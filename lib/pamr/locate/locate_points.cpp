// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/locate/locate_points.hpp"

#include <fmt/format.h>

#include <array>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::locate {

namespace {

struct Question {
  geometry::Vec3 point;
  std::int64_t row;
};

struct Answer {
  std::int64_t row;
  GlobalId cell;
};

/// The boxes of the cells of all ranks. Collective.
std::vector<geometry::Box> gather_boxes(const par::Comm& comm, const geometry::Box& own) {
  const std::array<double, 6> values{own.low.x, own.low.y, own.low.z, own.high.x, own.high.y, own.high.z};
  std::array<std::vector<double>, 6> all;
  for (std::size_t i = 0; i < 6; ++i) all[i] = comm.all_gather(values[i]);
  std::vector<geometry::Box> boxes(at(comm.size()));
  for (std::size_t r = 0; r < boxes.size(); ++r)
    boxes[r] = {{all[0][r], all[1][r], all[2][r]}, {all[3][r], all[4][r], all[5][r]}};
  return boxes;
}

}  // namespace

PointLocations locate_points(const par::Comm& comm, const mesh::DistMesh& mesh, const Locator& locator,
                             std::span<const geometry::Vec3> points, std::span<const LocalId> near) {
  par::agree(comm, [&] {
    if (!near.empty() && near.size() != points.size())
      throw Error(fmt::format("locate: expected a cell to begin at for each of {} points, found {} (rank {})",
                              points.size(), near.size(), comm.rank()));
  });
  PointLocations result;
  result.cell.assign(points.size(), invalid_global);
  result.rank.assign(points.size(), -1);
  const auto boxes = gather_boxes(comm, locator.tree().box());
  par::Mailbox<Question> questions(comm);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto own = locator.find(points[i], near.empty() ? invalid_local : near[i]);
    if (own != invalid_local) {
      result.cell[i] = mesh.cell_global[at(own)];
      result.rank[i] = comm.rank();
      if (side_of_cell(mesh, own, points[i]) > 0) continue;
    }
    for (Rank r = 0; r < comm.size(); ++r)
      if (r != comm.rank() && boxes[at(r)].contains(points[i]))
        questions.add(r, {points[i], static_cast<std::int64_t>(i)});
  }
  const auto asked = questions.send();
  par::Mailbox<Answer> answers(comm);
  for (std::size_t r = 0; r < asked.rank.size(); ++r)
    for (const auto& question : asked.from(r))
      if (const auto cell = locator.find(question.point); cell != invalid_local)
        answers.add(asked.rank[r], {question.row, mesh.cell_global[at(cell)]});
  const auto answered = answers.send();
  for (std::size_t r = 0; r < answered.rank.size(); ++r)
    for (const auto& answer : answered.from(r)) {
      auto& cell = result.cell[at(answer.row)];
      if (cell != invalid_global && cell < answer.cell) continue;
      cell = answer.cell;
      result.rank[at(answer.row)] = answered.rank[r];
    }
  return result;
}

}  // namespace pamr::locate
