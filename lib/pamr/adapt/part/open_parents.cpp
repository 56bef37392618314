// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/part/open_parents.hpp"

#include <algorithm>
#include <cstdint>
#include <map>

#include "pamr/base/index.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/refine/transfer.hpp"

namespace pamr::adapt {

namespace {

struct Question {
  LocalId first = 0;  ///< first member of the family, on the rank that has the input
  geometry::Vec3 centroid;
};

constexpr GlobalId open_origin(Rank rank, LocalId first) { return -1 - (GlobalId{rank} << 32 | GlobalId{first}); }
constexpr Rank home_of(GlobalId origin) { return static_cast<Rank>((-1 - origin) >> 32); }
constexpr LocalId first_of(GlobalId origin) { return static_cast<LocalId>((-1 - origin) & 0xffffffff); }

const std::vector<GlobalId>& numbers_of_cells(const mesh::DistMesh& mesh) {
  return mesh.cell_origin.empty() ? mesh.cell_global : mesh.cell_origin;
}

/// Where a cell of the input is in what is left of it.
LocalId place_in(const InputCells& input, LocalId cell) {
  if (input.has_all) return cell;
  return static_cast<LocalId>(std::lower_bound(input.cell.begin(), input.cell.end(), cell) - input.cell.begin());
}

bool depends_on_parent(const mesh::CellField& field, const refine::Options& options) {
  return field.holds_integers() && refine::is_inherited(field, options) && !mesh::is_inner_patch_field(field);
}

/// The number of an input cell, and its values of all integer fields that are handed on.
void append_answer(const mesh::DistMesh& input, LocalId cell, const refine::Options& options,
                   std::vector<std::int64_t>& answers) {
  answers.push_back(numbers_of_cells(input)[at(cell)]);
  for (const auto& field : input.cell_fields) {
    if (!depends_on_parent(field, options)) continue;
    const auto begin = field.integer().begin() + std::int64_t{cell} * field.n_components;
    answers.insert(answers.end(), begin, begin + field.n_components);
  }
}

/// Reads such an answer. Returns what comes after it.
const std::int64_t* write_answer(const std::int64_t* answer, const mesh::DistMesh& input,
                                 const refine::Options& options, LocalId cell, mesh::DistMesh& fine) {
  const auto field_named = [&fine](const auto& name) {
    return std::find_if(fine.cell_fields.begin(), fine.cell_fields.end(),
                        [&name](const auto& field) { return field.name == name; });
  };
  const auto number = *answer++;
  if (options.parent_field) field_named(mesh::parent_field)->integer()[at(cell)] = number;
  for (const auto& field : input.cell_fields) {
    if (!depends_on_parent(field, options)) continue;
    auto& values = field_named(field.name)->integer();
    std::copy_n(answer, field.n_components, values.begin() + std::int64_t{cell} * field.n_components);
    answer += field.n_components;
  }
  return answer;
}

}  // namespace

std::vector<GlobalId> origins_of_pass(Rank rank, const refine::NumberedMesh& pass,
                                      const std::vector<mesh::CellNodes>& cell_to_node,
                                      std::span<const LocalId> input_cell) {
  const auto& [mesh, closure, numbering] = pass;
  const auto& number = numbers_of_cells(mesh);
  std::vector<GlobalId> origin;
  origin.reserve(cell_to_node.size());
  for (const auto parent : refine::parents_of(pass, cell_to_node)) origin.push_back(number[at(parent)]);
  for (const auto& family : closure.rebuilt) {
    // members with one number come from one input cell, or are open already
    if (number[at(family.first)] == number[at(family.first + 1)]) continue;
    const auto first = input_cell.empty() ? family.first : input_cell[at(family.first)];
    std::fill(origin.begin() + numbering.first_child[at(family.first)],
              origin.begin() + numbering.first_child[at(family.first + 1)], open_origin(rank, first));
  }
  return origin;
}

std::vector<OpenParent> find_open_parents(const refine::NumberedMesh& last,
                                          const std::vector<mesh::CellNodes>& cell_to_node) {
  const auto& origin = last.mesh.cell_origin;
  std::vector<OpenParent> open;
  if (std::none_of(origin.begin(), origin.end(), [](GlobalId number) { return number < 0; })) return open;
  const auto& first_child = last.numbering.first_child;
  for (LocalId c = 0; c < last.mesh.n_cells(); ++c) {
    const bool is_split = last.closure.action[at(c)] == refine::Action::split;
    if (first_child[at(c)] == first_child[at(c) + 1] || (is_split && origin[at(c)] >= 0)) continue;
    for (auto child = first_child[at(c)]; child < first_child[at(c) + 1]; ++child) {
      const auto centroid = refine::straight_centroid(last, cell_to_node[at(child)]);
      const auto parent = is_split ? c : refine::member_that_holds(last.mesh, c, centroid);
      if (origin[at(parent)] < 0) open.push_back({child, origin[at(parent)], centroid});
    }
  }
  return open;
}

void settle_open_parents(const par::Comm& comm, const InputCells& before, const std::vector<OpenParent>& open,
                         const refine::Options& options, mesh::DistMesh& fine) {
  const auto& input = before.mesh.get();
  if (!comm.any(!open.empty())) return;
  std::map<Rank, std::vector<Question>> asked;
  std::map<Rank, std::vector<LocalId>> cells;
  for (const auto& [cell, origin, centroid] : open) {
    asked[home_of(origin)].push_back({first_of(origin), centroid});
    cells[home_of(origin)].push_back(cell);
  }
  std::vector<par::Outgoing<Question>> questions;
  for (auto& [rank, list] : asked) questions.push_back({rank, std::move(list)});
  const auto arrived = comm.sparse_exchange(questions);
  std::vector<par::Outgoing<std::int64_t>> answers;
  for (std::size_t i = 0; i < arrived.rank.size(); ++i) {
    answers.push_back({arrived.rank[i], {}});
    for (const auto& [first, centroid] : arrived.from(i))
      append_answer(input, refine::member_that_holds(input, place_in(before, first), centroid), options,
                    answers.back().item);
  }
  const auto answered = comm.sparse_exchange(answers);
  const auto* answer = answered.item.data();  // in ascending order of ranks, as `cells`
  for (const auto& [rank, list] : cells)
    for (const auto cell : list) answer = write_answer(answer, input, options, cell, fine);
}

}  // namespace pamr::adapt
