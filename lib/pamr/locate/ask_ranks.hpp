// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::locate {

/// The boxes of the cells of all ranks. Collective.
std::vector<geometry::Box> gather_boxes(const par::Comm& comm, const geometry::Box& own);

/// What another rank says of a point: the point's row where it was asked for.
template <class T>
struct RankAnswer {
  std::int64_t row = 0;
  T value{};
};

/// Asks all other ranks whose box holds a point about it. `box`: around this rank's cells; `rows`: of the points to
/// ask about; `find`: what this rank knows of a point, an optional T. Collective: a gather of six numbers a rank, and
/// two sparse exchanges.
template <class T, class Find>
par::Received<RankAnswer<T>> ask_ranks(const par::Comm& comm, const geometry::Box& box,
                                       std::span<const geometry::Vec3> points, std::span<const std::size_t> rows,
                                       Find&& find) {
  struct Question {
    geometry::Vec3 point;
    std::int64_t row;
  };
  const auto boxes = gather_boxes(comm, box);
  par::Mailbox<Question> questions(comm);
  for (const auto row : rows)
    for (Rank r = 0; r < comm.size(); ++r)
      if (r != comm.rank() && boxes[at(r)].contains(points[row]))
        questions.add(r, {points[row], static_cast<std::int64_t>(row)});
  const auto asked = questions.send();
  par::Mailbox<RankAnswer<T>> answers(comm);
  for (std::size_t r = 0; r < asked.rank.size(); ++r)
    for (const auto& question : asked.from(r))
      if (const std::optional<T> value = find(question.point); value)
        answers.add(asked.rank[r], {question.row, *value});
  return answers.send();
}

}  // namespace pamr::locate
