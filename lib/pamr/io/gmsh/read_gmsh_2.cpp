// SPDX-License-Identifier: GPL-3.0-or-later
// Gmsh's format 2.2. Source: Gmsh reference manual, section "MSH file format version 2 (Legacy)".
#include "pamr/io/gmsh/read_gmsh_2.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include "pamr/base/memory.hpp"

namespace pamr::io::gmsh {

namespace {

int checked_type(const TextCursor& in, std::int64_t type) {
  if (type < 0 || type > 1000 || n_nodes_of_type(static_cast<int>(type)) == 0)
    in.fail("a known type of elements", fmt::format("{}", type));
  return static_cast<int>(type);
}

/// `$ParametricNodes`: behind each node the dimension and the number of its entity, and its parameters there.
void read_parametric_nodes(TextCursor& in, bool is_binary, Share share, Parts& parts) {
  parts.n_nodes = in.checked_count(in.integer("the number of nodes"), 8, "nodes");
  (void)in.line();
  const auto own = share.of(parts.n_nodes);
  in.set_binary(is_binary);
  if (!is_binary) in.skip_lines(own.begin, "a node");
  for (auto i = is_binary ? 0 : own.begin; i < (is_binary ? parts.n_nodes : own.end); ++i) {
    std::int64_t tag = 0, dimension = 0;
    geometry::Vec3 p;
    if (is_binary) {  // rows differ in length
      tag = in.value<std::int32_t>("a node");
      for (std::size_t k = 0; k < 3; ++k) p[k] = in.value<double>("a coordinate");
      dimension = in.value<std::int32_t>("the dimension of an entity");
      if (dimension < 0 || dimension > 3) in.fail("a dimension from 0 to 3", fmt::format("{}", dimension));
      const auto n_parameters = dimension == 1 || dimension == 2 ? dimension : 0;
      in.skip_rows(1, sizeof(std::int32_t) + static_cast<std::size_t>(n_parameters) * sizeof(double), "parameters");
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) in.fail("finite coordinates", "others");
    } else {
      tag = in.integer("the number of a node");
      for (std::size_t k = 0; k < 3; ++k) p[k] = in.real("a coordinate");
      (void)in.line();
    }
    if (i < own.begin || i >= own.end) continue;
    parts.node_tag.push_back(tag);
    parts.position.push_back(p);
  }
  if (!is_binary) in.skip_lines(parts.n_nodes - own.end, "a node");
}

void read_nodes(TextCursor& in, bool is_binary, Share share, Parts& parts) {
  parts.n_nodes = in.checked_count(in.integer("the number of nodes"), 8, "nodes");
  (void)in.line();
  const auto own = share.of(parts.n_nodes);
  reserve_array(parts.node_tag, static_cast<std::size_t>(own.count()));
  reserve_array(parts.position, static_cast<std::size_t>(own.count()));
  constexpr std::size_t row = sizeof(std::int32_t) + 3 * sizeof(double);
  in.set_binary(is_binary);
  is_binary ? in.skip_rows(own.begin, row, "a node") : in.skip_lines(own.begin, "a node");
  for (auto i = own.begin; i < own.end; ++i) {
    if (is_binary) {
      parts.node_tag.push_back(in.value<std::int32_t>("a node"));
      const auto x = in.value<double>("x"), y = in.value<double>("y"), z = in.value<double>("z");
      if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) in.fail("finite coordinates", "others");
      parts.position.push_back({x, y, z});
    } else {
      parts.node_tag.push_back(in.integer("the number of a node"));
      const double x = in.real("x"), y = in.real("y"), z = in.real("z");
      parts.position.push_back({x, y, z});
      (void)in.line();
    }
  }
  const auto rest = parts.n_nodes - own.end;
  is_binary ? in.skip_rows(rest, row, "a node") : in.skip_lines(rest, "a node");
}

/// The first tag is the physical group, the second the geometrical entity.
std::int64_t group_of(std::int64_t physical, std::int64_t entity) {
  return physical != 0 ? std::abs(physical) : -entity;
}

using Nodes = std::array<std::int64_t, max_nodes>;

/// Keeps elements in the order of the file. Groups are looked up only where the type or the tags change.
class Elements {
 public:
  explicit Elements(Parts& parts) : parts_(&parts) {}

  /// The first tag is the physical group, the second the entity; others say partitions.
  void take_tag(std::int64_t place, std::int64_t value, std::array<std::int64_t, 2>& tag) {
    if (place < 2)
      tag[static_cast<std::size_t>(place)] = value;
    else if (value != 0)
      parts_->has_partitions = true;
  }
  void keep(int type, const Nodes& nodes, const std::array<std::int64_t, 2>& tag) {
    if (type != type_ || tag != tag_) begin_run(type, tag);
    if (group_ > 0 && (type == element_type::point || type == element_type::line))
      ++parts_->n_in_group[{type == element_type::point ? 0 : 1, group_}];
    keep_element(*parts_, type, nodes, group_);
  }

 private:
  void begin_run(int type, const std::array<std::int64_t, 2>& tag) {
    type_ = type;
    tag_ = tag;
    group_ = group_of(tag[0], tag[1]);
    const bool is_face = element_type::is_face(type);
    if (is_face) parts_->group_of_surface[tag[1]] = group_;
    if (group_ > 0 && (is_face || element_type::is_cell(type)))
      parts_->entity_in_group.insert({is_face ? 2 : 3, tag[1], group_});
  }

  Parts* parts_;
  int type_ = 0;  // of the last element, as the tags and the group
  std::array<std::int64_t, 2> tag_{};
  std::int64_t group_ = 0;
};

void read_element_line(TextCursor& in, Elements& elements) {
  (void)in.integer("the number of an element");
  const int type = checked_type(in, in.integer("the type of an element"));
  const auto n_tags = in.integer("the number of tags");
  if (n_tags < 0 || n_tags > 1000) in.fail("a number of tags up to 1000", fmt::format("{}", n_tags));
  std::array<std::int64_t, 2> tag{};
  for (std::int64_t t = 0; t < n_tags; ++t) {
    elements.take_tag(t, in.integer("a tag"), tag);
  }
  Nodes nodes{};
  for (int k = 0; k < n_nodes_of_type(type); ++k) {
    const auto node = in.integer("a node of an element");
    if (k < std::ssize(nodes)) nodes[static_cast<std::size_t>(k)] = node;
  }
  elements.keep(type, nodes, tag);
  (void)in.line();
}

void read_binary_elements(TextCursor& in, par::BlockRange own, std::int64_t n_elements, Elements& elements) {
  for (std::int64_t done = 0; done < n_elements;) {
    const int type = checked_type(in, in.value<std::int32_t>("the type of elements"));
    const auto n = in.value<std::int32_t>("a number of elements"), n_tags = in.value<std::int32_t>("a number of tags");
    if (n <= 0 || n > n_elements - done) in.fail("a number of elements that is left", fmt::format("{}", n));
    if (n_tags < 0 || n_tags > 1000) in.fail("a number of tags up to 1000", fmt::format("{}", n_tags));
    const int n_nodes = n_nodes_of_type(type);
    const auto row = sizeof(std::int32_t) * static_cast<std::size_t>(1 + n_tags + n_nodes);
    const auto begin = std::clamp<std::int64_t>(own.begin - done, 0, n);
    const auto end = std::clamp<std::int64_t>(own.end - done, 0, n);
    in.skip_rows(begin, row, "an element");
    for (auto i = begin; i < end; ++i) {
      (void)in.value<std::int32_t>("an element");
      std::array<std::int64_t, 2> tag{};
      for (int t = 0; t < n_tags; ++t) {
        elements.take_tag(t, in.value<std::int32_t>("a tag"), tag);
      }
      Nodes nodes{};
      for (int k = 0; k < n_nodes; ++k) {
        const auto node = in.value<std::int32_t>("a node of an element");
        if (k < std::ssize(nodes)) nodes[static_cast<std::size_t>(k)] = node;
      }
      elements.keep(type, nodes, tag);
    }
    in.skip_rows(n - end, row, "an element");
    done += n;
  }
}

void read_elements(TextCursor& in, bool is_binary, Share share, Parts& parts) {
  parts.n_elements = in.checked_count(in.integer("the number of elements"), 6, "elements");
  (void)in.line();
  in.set_binary(is_binary);
  const auto own = share.of(parts.n_elements);
  make_room(in, parts, own.count());
  Elements elements(parts);
  if (is_binary) {
    read_binary_elements(in, own, parts.n_elements, elements);
    return;
  }
  in.skip_lines(own.begin, "an element");
  for (auto i = own.begin; i < own.end; ++i) read_element_line(in, elements);
  in.skip_lines(parts.n_elements - own.end, "an element");
}

/// Text in binary files too.
void read_periodic(TextCursor& in, Parts& parts) {
  const auto n_links = in.checked_count(in.integer("the number of periodic links"), 6, "periodic links");
  (void)in.line();
  for (std::int64_t i = 0; i < n_links; ++i) {
    const auto dimension = in.integer("the dimension of a periodic link");
    const auto entity = in.integer("a linked entity"), master = in.integer("an entity that it is linked to");
    keep_link(parts, dimension, entity, master);
    (void)in.line();
    std::string_view line = in.line();
    if (line.starts_with("Affine")) line = in.line();
    std::int64_t n_pairs = 0;
    const auto read = std::from_chars(line.data(), line.data() + line.size(), n_pairs);
    if (read.ec != std::errc() || n_pairs < 0)
      in.fail("the number of pairs of linked nodes", "\"" + std::string(line.substr(0, 40)) + "\"");
    in.skip_lines(n_pairs, "a pair of linked nodes");
  }
}

}  // namespace

Parts read_parts_2(TextCursor& in, bool is_binary, Share share) {
  Parts parts;
  for_each_section(in, parts, [&](const std::string& name) {
    if (name == "PhysicalNames")
      read_group_names(in, parts);
    else if (name == "Nodes")
      read_nodes(in, is_binary, share, parts);
    else if (name == "ParametricNodes")
      read_parametric_nodes(in, is_binary, share, parts);
    else if (name == "Elements")
      read_elements(in, is_binary, share, parts);
    else if (name == "Periodic")
      read_periodic(in, parts);
    else
      return false;
    in.set_binary(false);
    return true;
  });
  return parts;
}

}  // namespace pamr::io::gmsh
