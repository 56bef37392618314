// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/number_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <variant>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::io {

namespace {

/// From the numbers that the file gives its nodes to their place in the file. Collective.
class NodeTable {
 public:
  NodeTable(const par::Comm& comm, const ElementParts& parts, const std::string& source)
      : comm_(comm), source_(source) {
    std::int64_t least = std::numeric_limits<std::int64_t>::max(), greatest = 0;
    for (const auto tag : parts.node_tag) {
      least = std::min(least, tag);
      greatest = std::max(greatest, tag);
    }
    least = comm.min(least);
    greatest = comm.max(greatest);
    if (parts.n_nodes == 0) throw Error(source + ": expected nodes, found none");
    if (least < 0 || greatest - least >= 64 * parts.n_nodes + 1024)
      throw Error(
          fmt::format("{}: expected node numbers from 0 on without wide gaps, found numbers from {} to {} for {} nodes",
                      source, least, greatest, parts.n_nodes));
    tags_ = {greatest - least + 1, least};
    std::vector<GlobalId> place(parts.node_tag.size());
    const auto own = par::block_range(parts.n_nodes, comm.rank(), comm.size());
    bool is_counted = true;
    for (std::size_t i = 0; i < place.size(); ++i) {
      place[i] = own.begin + static_cast<GlobalId>(i) + 1;
      is_counted = is_counted && parts.node_tag[i] - least + 1 == place[i];
    }
    is_counted_ = !comm.any(!is_counted);
    if (is_counted_) return;
    place_ = par::scatter_rows<GlobalId>(comm, tags_, place, 1, parts.node_tag);
    const auto back = par::fetch_rows<GlobalId>(comm, tags_, place_, 1, parts.node_tag);
    par::agree(comm, [&] {
      for (std::size_t i = 0; i < back.size(); ++i)
        if (back[i] != place[i])
          throw Error(fmt::format("{}: expected every node number once, found {} twice", source_, parts.node_tag[i]));
    });
  }

  /// Replaces numbers by places. Collective.
  void translate(std::span<GlobalId> tags) const {
    par::agree(comm_, [&] {
      for (const auto tag : tags)
        if (!tags_.contains(tag)) fail(tag);
    });
    if (is_counted_) {
      for (auto& tag : tags) tag -= tags_.first;
      return;
    }
    const auto place = par::fetch_rows<GlobalId>(comm_, tags_, place_, 1, tags);
    par::agree(comm_, [&] {
      for (std::size_t i = 0; i < tags.size(); ++i) {
        if (place[i] == 0) fail(tags[i]);
        tags[i] = place[i] - 1;
      }
    });
  }

 private:
  [[noreturn]] void fail(GlobalId tag) const {
    throw Error(fmt::format("{}: expected elements of nodes that are there, found node number {}", source_, tag));
  }

  const par::Comm& comm_;
  const std::string& source_;
  IdRange tags_{0};
  bool is_counted_ = false;      ///< nodes are numbered in their order without a gap: a place follows from the number
  std::vector<GlobalId> place_;  ///< counted from 1, otherwise
};

/// The nodes of all items, without their groups.
template <class Item>
auto nodes_of(const std::vector<Item>& items) {
  std::vector<decltype(Item::node)> nodes;
  reserve_array(nodes, items.size());
  for (const auto& item : items) nodes.push_back(item.node);
  return nodes;
}

/// The node numbers of all items as one span.
template <std::size_t n>
std::span<GlobalId> flat(std::vector<std::array<GlobalId, n>>& items) {
  static_assert(sizeof(std::array<GlobalId, n>) == n * sizeof(GlobalId));
  return {reinterpret_cast<GlobalId*>(items.data()), n * items.size()};
}

/// Rows of this rank's block, sent to where their new numbers belong. Collective.
template <class T>
std::vector<T> chosen_rows(const par::Comm& comm, GlobalId n, const std::vector<T>& all, std::size_t width,
                           const std::vector<std::size_t>& rows, const std::vector<GlobalId>& new_number) {
  std::vector<T> chosen;
  reserve_array(chosen, rows.size() * width);
  for (const auto row : rows)
    for (std::size_t k = 0; k < width; ++k) chosen.push_back(all[row * width + k]);
  return par::scatter_rows<T>(comm, n, chosen, width, new_number);
}

}  // namespace

Numbered number_elements(const par::Comm& comm, ElementParts& parts, const std::string& source, bool with_origin) {
  Numbered result;
  result.cell = nodes_of(parts.tetrahedron);
  result.triangle = nodes_of(parts.triangle);
  {
    const NodeTable table(comm, parts, source);
    free_array(parts.node_tag);
    table.translate(flat(result.cell));
    table.translate(flat(result.triangle));
  }
  std::vector<std::uint8_t> is_used;
  {
    const std::vector<std::uint8_t> one(4 * result.cell.size(), 1);
    is_used = par::scatter_rows<std::uint8_t>(comm, parts.n_nodes, one, 1, flat(result.cell));
  }
  std::int64_t n_used = 0;
  for (const auto used : is_used) n_used += used;
  result.n_nodes = comm.sum(n_used);
  result.n_dropped = parts.n_nodes - result.n_nodes;
  result.position = std::move(parts.position);
  result.node_fields = std::move(parts.node_fields);
  if (with_origin) {
    result.origin.resize(is_used.size());
    std::iota(result.origin.begin(), result.origin.end(),
              par::block_range(parts.n_nodes, comm.rank(), comm.size()).begin);
  }
  if (result.n_dropped == 0) return result;

  auto next = comm.exclusive_sum(n_used);
  std::vector<GlobalId> new_number, kept;
  std::vector<std::size_t> rows;
  assign_array(new_number, is_used.size(), GlobalId{-1});
  reserve_array(kept, static_cast<std::size_t>(n_used));
  reserve_array(rows, static_cast<std::size_t>(n_used));
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (is_used[i] != 0) {
      new_number[i] = next++;
      kept.push_back(new_number[i]);
      rows.push_back(i);
    }
  result.position = chosen_rows(comm, result.n_nodes, result.position, 1, rows, kept);
  if (with_origin) result.origin = chosen_rows(comm, result.n_nodes, result.origin, 1, rows, kept);
  for (auto& field : result.node_fields)
    std::visit(
        [&](auto& values) { values = chosen_rows(comm, result.n_nodes, values, at(field.n_components), rows, kept); },
        field.value);
  const auto renumber = [&](std::span<GlobalId> nodes) {
    std::ranges::copy(par::fetch_rows<GlobalId>(comm, parts.n_nodes, new_number, 1, nodes), nodes.begin());
  };
  renumber(flat(result.cell));
  renumber(flat(result.triangle));
  return result;
}

}  // namespace pamr::io
