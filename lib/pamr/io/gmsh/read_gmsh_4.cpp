// SPDX-License-Identifier: GPL-3.0-or-later
// Gmsh's format 4.1. Source: Gmsh reference manual, section "MSH file format".
#include "pamr/io/gmsh/read_gmsh_4.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>

#include "pamr/base/memory.hpp"

namespace pamr::io::gmsh {

namespace {

/// Numbers of a section, whichever way they are written.
class Reader {
 public:
  Reader(TextCursor& in, bool is_binary) : in_(&in), is_binary_(is_binary) { in.set_binary(is_binary); }

  std::int64_t small(std::string_view what) { return is_binary_ ? in_->value<std::int32_t>(what) : in_->integer(what); }
  std::int64_t large(std::string_view what) {
    if (!is_binary_) return in_->integer(what);
    const auto value = in_->value<std::uint64_t>(what);
    if (value >> 62U != 0) in_->fail(std::string(what) + " below 2^62", fmt::format("{}", value));
    return static_cast<std::int64_t>(value);
  }
  double real(std::string_view what) {
    if (!is_binary_) return in_->real(what);
    const auto value = in_->value<double>(what);
    if (!std::isfinite(value)) in_->fail(std::string(what) + " that is finite", "another");
    return value;
  }
  /// The end of the line that was read, in a text.
  void end_line() {
    if (!is_binary_) (void)in_->line();
  }
  /// Passes `n` rows of `n_large` large numbers (or reals of 8 bytes), one a line in a text.
  void skip(std::int64_t n, std::size_t n_large, std::string_view what) {
    is_binary_ ? in_->skip_rows(n, 8 * n_large, what) : in_->skip_lines(n, what);
  }
  std::int64_t count(std::size_t min_bytes, std::string_view what) {
    return in_->checked_count(large("the number of " + std::string(what)), min_bytes, what);
  }
  TextCursor& in() { return *in_; }

 private:
  TextCursor* in_;
  bool is_binary_;
};

/// The physical groups of every entity that has some, by dimension and number.
using Groups = std::map<std::pair<int, std::int64_t>, std::set<std::int64_t>>;

Groups read_entities(Reader read) {
  Groups groups;
  std::array<std::int64_t, 4> n{};
  for (auto& count : n) count = read.count(2, "entities");
  for (int dimension = 0; dimension < 4; ++dimension)
    for (std::int64_t i = 0; i < n[static_cast<std::size_t>(dimension)]; ++i) {
      const auto tag = read.small("the number of an entity");
      for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) (void)read.real("a coordinate of an entity");
      const auto n_physical = read.count(1, "physical groups");
      for (std::int64_t k = 0; k < n_physical; ++k) {
        const auto group = std::abs(read.small("a physical group"));
        groups[{dimension, tag}].insert(group);
      }
      if (dimension == 0) continue;
      const auto n_bounding = read.count(1, "bounding entities");
      for (std::int64_t k = 0; k < n_bounding; ++k) (void)read.small("a bounding entity");
    }
  read.end_line();
  return groups;
}

/// The part of a block of `n` items, of which `done` came before, that belongs to a rank.
par::BlockRange part_of_block(par::BlockRange own, std::int64_t done, std::int64_t n) {
  return {std::clamp<std::int64_t>(own.begin - done, 0, n), std::clamp<std::int64_t>(own.end - done, 0, n)};
}

void read_nodes(Reader read, Share share, Parts& parts) {
  const auto n_blocks = read.count(4, "blocks of nodes");
  parts.n_nodes = read.count(8, "nodes");
  (void)read.large("the least node number");
  (void)read.large("the greatest node number");
  read.end_line();
  const auto own = share.of(parts.n_nodes);
  reserve_array(parts.node_tag, static_cast<std::size_t>(own.count()));
  reserve_array(parts.position, static_cast<std::size_t>(own.count()));
  std::int64_t done = 0;
  for (std::int64_t b = 0; b < n_blocks; ++b) {
    const auto dimension = read.small("the dimension of an entity");
    if (dimension < 0 || dimension > 3) read.in().fail("a dimension from 0 to 3", fmt::format("{}", dimension));
    (void)read.small("the number of an entity");
    const bool is_parametric = read.small("whether nodes have parameters") != 0;
    const auto n = read.large("the number of nodes of a block");
    read.end_line();
    if (n < 0 || n > parts.n_nodes - done) read.in().fail("a number of nodes that is left", fmt::format("{}", n));
    const auto part = part_of_block(own, done, n);
    read.skip(part.begin, 1, "a node number");
    for (auto i = part.begin; i < part.end; ++i) {
      parts.node_tag.push_back(read.large("a node number"));
      read.end_line();
    }
    read.skip(n - part.end, 1, "a node number");
    const auto width = static_cast<std::size_t>(3 + (is_parametric ? dimension : 0));
    read.skip(part.begin, width, "the coordinates of a node");
    for (auto i = part.begin; i < part.end; ++i) {
      const double x = read.real("x"), y = read.real("y"), z = read.real("z");
      for (std::size_t k = 3; k < width; ++k) (void)read.real("a parameter of a node");
      parts.position.push_back({x, y, z});
      read.end_line();
    }
    read.skip(n - part.end, width, "the coordinates of a node");
    done += n;
  }
  if (done != parts.n_nodes)
    read.in().fail(fmt::format("{} nodes in all blocks", parts.n_nodes), fmt::format("{}", done));
}

/// Elements of entities in several groups get one that stands for these. Names come before the entities in a file.
void join_groups(const Groups& groups, Parts& parts) {
  for (const int dimension : {2, 3}) {
    std::set<std::int64_t> taken;
    std::set<std::set<std::int64_t>> sets;
    for (const auto& [entity, all] : groups) {
      if (entity.first != dimension) continue;
      taken.insert(all.begin(), all.end());
      sets.insert(all);
    }
    add_joint_groups(parts, dimension, sets, std::move(taken));
  }
}

void read_elements(Reader read, Share share, const Groups& groups, Parts& parts) {
  const auto n_blocks = read.count(4, "blocks of elements");
  parts.n_elements = read.count(4, "elements");
  (void)read.large("the least element number");
  (void)read.large("the greatest element number");
  read.end_line();
  const auto own = share.of(parts.n_elements);
  make_room(read.in(), parts, own.count());
  std::int64_t done = 0;
  for (std::int64_t b = 0; b < n_blocks; ++b) {
    const auto dimension = read.small("the dimension of an entity");
    const auto entity = read.small("the number of an entity");
    const auto type = read.small("the type of elements");
    const auto n = read.large("the number of elements of a block");
    read.end_line();
    const int n_nodes = type < 0 || type > 1000 ? 0 : n_nodes_of_type(static_cast<int>(type));
    if (n_nodes == 0) read.in().fail("an element type of Gmsh", fmt::format("{}", type));
    if (n < 0 || n > parts.n_elements - done) read.in().fail("a number of elements that is left", fmt::format("{}", n));
    const auto known = groups.find({static_cast<int>(dimension), entity});
    const auto group =
        known != groups.end() ? number_of_groups(parts, static_cast<int>(dimension), known->second) : -entity;
    const auto part = part_of_block(own, done, n);
    const auto width = static_cast<std::size_t>(1 + n_nodes);
    read.skip(part.begin, width, "an element");
    for (auto i = part.begin; i < part.end; ++i) {
      (void)read.large("the number of an element");
      std::array<std::int64_t, max_nodes> nodes{};
      for (int k = 0; k < n_nodes; ++k) {
        const auto node = read.large("a node of an element");
        if (k < std::ssize(nodes)) nodes[static_cast<std::size_t>(k)] = node;
      }
      keep_element(parts, static_cast<int>(type), nodes, group);
      read.end_line();
    }
    read.skip(n - part.end, width, "an element");
    if (known != groups.end() && part.count() > 0 && (type == element_type::point || type == element_type::line))
      for (const auto any : known->second) parts.n_in_group[{static_cast<int>(dimension), any}] += part.count();
    done += n;
  }
  if (done != parts.n_elements)
    read.in().fail(fmt::format("{} elements in all blocks", parts.n_elements), fmt::format("{}", done));
}

void read_periodic(Reader read, Parts& parts) {
  const auto n_links = read.count(12, "periodic links");
  read.end_line();
  for (std::int64_t i = 0; i < n_links; ++i) {
    const auto dimension = read.small("the dimension of a periodic link");
    const auto entity = read.small("a linked entity"), master = read.small("an entity that it is linked to");
    keep_link(parts, dimension, entity, master);
    read.end_line();
    const auto n_affine = read.count(2, "entries of a transformation");
    for (std::int64_t k = 0; k < n_affine; ++k) (void)read.real("an entry of a transformation");
    read.end_line();
    const auto n_pairs = read.count(4, "pairs of linked nodes");
    read.end_line();
    read.skip(n_pairs, 2, "a pair of linked nodes");
  }
}

}  // namespace

Parts read_parts_4(TextCursor& in, bool is_binary, Share share) {
  Parts parts;
  Groups groups;
  for_each_section(in, parts, [&](const std::string& name) {
    if (name == "PartitionedEntities")
      in.fail("a mesh in one part", "one that Gmsh has partitioned (gmsh OLD.msh -unpartition -save -o NEW.msh)");
    if (name == "PhysicalNames")
      read_group_names(in, parts);
    else if (name == "Entities")
      join_groups(groups = read_entities(Reader(in, is_binary)), parts);
    else if (name == "Nodes")
      read_nodes(Reader(in, is_binary), share, parts);
    else if (name == "Elements")
      read_elements(Reader(in, is_binary), share, groups, parts);
    else if (name == "Periodic")
      read_periodic(Reader(in, is_binary), parts);
    else
      return false;
    in.set_binary(false);
    return true;
  });
  for (const auto& [entity, all] : groups)
    if (entity.first == 2) parts.group_of_surface[entity.second] = number_of_groups(parts, 2, all);
  return parts;
}

}  // namespace pamr::io::gmsh
