// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the formats: Gmsh reference manual, "MSH file format" and "MSH file format version 2 (Legacy)".
#include "pamr/io/gmsh/write_gmsh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/io/elements/boundary_rows.hpp"
#include "pamr/io/gmsh/gmsh_parts.hpp"
#include "pamr/io/rows_in_order.hpp"
#include "pamr/io/shared_output.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/untagged_patch.hpp"

namespace pamr::io {

namespace {

/// Numbers as text, a blank between them, or as bytes.
class Record {
 public:
  explicit Record(bool binary) : binary_(binary) {}

  void small(std::int64_t value) { binary_ ? bytes(static_cast<std::int32_t>(value)) : text(value); }
  void large(std::int64_t value) { binary_ ? bytes(static_cast<std::uint64_t>(value)) : text(value); }
  void real(double value) { binary_ ? bytes(value) : text(value); }
  void end_line() {
    if (!binary_) data_ += '\n';
  }
  const std::string& data() const { return data_; }

 private:
  template <class T>
  void bytes(T value) {
    data_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  template <class T>
  void text(T value) {
    std::array<char, 40> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    if (!data_.empty() && data_.back() != '\n') data_ += ' ';
    data_.append(digits.data(), end);
  }

  bool binary_;
  std::string data_;
};

/// The elements of an order: how many nodes they have, what Gmsh calls them, and their nodes in its order.
struct FirstOrder {
  using Triangle = std::array<GlobalId, 3>;
  using Cell = std::array<GlobalId, 4>;
  static constexpr int triangle_type = 2, cell_type = 4;
  static Cell cell(const RowsInOrder& rows, std::size_t c) { return rows.cell_to_node[c]; }
  static Triangle triangle(const RowsInOrder& rows, std::size_t c, const std::array<int, 3>& slot) {
    const auto& n = rows.cell_to_node[c];
    return {n[at(slot[0])], n[at(slot[1])], n[at(slot[2])]};
  }
};

/// Corners, then mid-edge nodes: those of a tetrahedron by its edges 0-1, 1-2, 2-0, 3-0, 2-3, 1-3.
struct OfSecondOrder {
  using Triangle = std::array<GlobalId, 6>;
  using Cell = std::array<GlobalId, 10>;
  static constexpr int triangle_type = 9, cell_type = 11;
  static Cell cell(const RowsInOrder& rows, std::size_t c) {
    const auto& n = rows.cell_to_node[c];
    return {n[0],
            n[1],
            n[2],
            n[3],
            rows.mid(c, 0, 1),
            rows.mid(c, 1, 2),
            rows.mid(c, 2, 0),
            rows.mid(c, 3, 0),
            rows.mid(c, 2, 3),
            rows.mid(c, 1, 3)};
  }
  static Triangle triangle(const RowsInOrder& rows, std::size_t c, const std::array<int, 3>& slot) {
    const auto& n = rows.cell_to_node[c];
    return {n[at(slot[0])],
            n[at(slot[1])],
            n[at(slot[2])],
            rows.mid(c, slot[0], slot[1]),
            rows.mid(c, slot[1], slot[2]),
            rows.mid(c, slot[2], slot[0])};
  }
};

/// Physical groups of a file, and those of each part: of a patch or region itself, or the user's that it is in.
class Physicals {
 public:
  std::vector<std::string> name;
  std::vector<std::int64_t> number;
  std::vector<std::vector<std::size_t>> of_part;

  /// Adds a part that has no elements in the file.
  void add_none() { of_part.emplace_back(); }

  /// Adds a part; the groups of several parts are one if they have the same number and name.
  void add(const mesh::Group& own, const std::vector<mesh::Group>& groups) {
    auto& physicals = of_part.emplace_back();
    for (const auto& group : groups.empty() ? std::vector{own} : groups) {
      const auto [place, is_new] = place_of_.try_emplace({group.number, group.name}, name.size());
      if (is_new) {
        name.push_back(group.name);
        number.push_back(group.number);
      }
      physicals.push_back(place->second);
    }
  }

 private:
  std::map<std::pair<std::int64_t, std::string>, std::size_t> place_of_;
};

/// The physical volume of a region: its number, but Gmsh's numbers are positive, and what has none is in no group, which
/// not all programs expect. Such regions get the lowest free numbers, and names that `read_gmsh` knows.
std::map<std::int64_t, mesh::Region> volumes_of(const std::vector<std::int64_t>& regions, const mesh::MeshInfo& info) {
  std::map<std::int64_t, mesh::Region> volumes;
  std::set<std::int64_t> taken(regions.begin(), regions.end());
  for (const auto& region : info.regions) {
    taken.insert(region.number);
    for (const auto& group : region.groups) taken.insert(group.number);
    if (region.number > 0) volumes[region.number] = region;
  }
  std::int64_t next = 1;
  for (const auto region : regions) {
    if (region > 0) {
      volumes.try_emplace(region, mesh::Region{region, ""});
      continue;
    }
    const auto name = mesh::name_of_region(info, region);
    while (!taken.insert(next).second) ++next;
    volumes[region] = {next, name.empty() ? fmt::format("{}{}", gmsh::unnamed_region, region) : name};
  }
  return volumes;
}

/// Elements of one rank in the order of the file.
template <class Order>
struct Elements {
  std::vector<std::vector<typename Order::Triangle>> triangle;  ///< by patch and interface
  RegionsInOrder region;                                        ///< 1 everywhere without the field
  std::map<std::int64_t, mesh::Region> volume;                  ///< of each region, and of those with names
};

template <class Order>
Elements<Order> collect(const par::Comm& comm, const mesh::DistMesh& mesh, const RowsInOrder& rows) {
  Elements<Order> elements;
  elements.triangle.resize(rows.group_name.size());
  for (std::size_t c = 0; c < rows.group.size(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (rows.group[c][slot] < 0) continue;
      elements.triangle[at(rows.group[c][slot])].push_back(Order::triangle(rows, c, mesh::tet::face_to_corner[slot]));
    }
  elements.region = regions_in_order(comm, mesh);
  if (!elements.region.has_field) {
    elements.region.of_cell.assign(rows.cell_to_node.size(), 1);
    elements.region.all = {1};
  }
  elements.volume = volumes_of(elements.region.all, elements.region.has_field ? mesh.info : mesh::MeshInfo());
  return elements;
}

/// Faces without a tag are left out, as Gmsh itself does where others have one. Collective.
RowsInOrder tagged_rows(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::SecondOrder* second_order,
                        Interfaces interfaces) {
  auto rows = rows_in_order(comm, mesh, second_order, interfaces);
  leave_out_untagged(rows, mesh.info);
  return rows;
}

/// Names as Gmsh reads them back: a `"` would end one, and "(127 characters max)" is what the manual says. Local.
std::vector<std::string> physical_names(const char* what, const std::vector<std::string>& names, const Remark& remark) {
  const auto is_allowed = [](char c) { return c != '"'; };
  return written_names({.format = "Gmsh", .what = what, .is_allowed = is_allowed, .instead = '\'', .longest = 127},
                       names, remark);
}

template <class Order>
class Writer {
 public:
  Writer(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
         const mesh::SecondOrder* second_order, const GmshWriteOptions& options)
      : comm_(comm),
        mesh_(mesh),
        binary_(options.binary),
        out_(comm, file),
        rows_(tagged_rows(comm, mesh, second_order, options.interfaces)),
        elements_(collect<Order>(comm, mesh, rows_)) {
    for (std::size_t p = 0; p < rows_.group_name.size(); ++p) {
      const bool is_patch = p < mesh.info.patches.size();
      if (is_patch && mesh::is_untagged(mesh.info.patches[p])) {
        surfaces_.add_none();
        continue;
      }
      surfaces_.add({is_patch ? rows_.patch_number[p] : -1, rows_.group_name[p]},
                    is_patch ? mesh.info.patches[p].groups : std::vector<mesh::Group>());
    }
    surfaces_.number = patch_numbers(surfaces_.name, "physical_", 1, surfaces_.number);
    surfaces_.name = physical_names("patch", surfaces_.name, options.remark);
    for (const auto& [region, volume] : elements_.volume) volumes_.add({volume.number, volume.name}, volume.groups);
    for (const auto number : volumes_.number)
      if (number > std::numeric_limits<std::int32_t>::max())
        throw Error(fmt::format("Gmsh: expected regions with numbers below 2^31, found {}", number));
    std::vector<std::string> regions;
    std::copy_if(volumes_.name.begin(), volumes_.name.end(), std::back_inserter(regions),
                 [](const std::string& name) { return !name.empty(); });
    regions = physical_names("region", regions, options.remark);
    auto next = regions.begin();
    for (auto& name : volumes_.name)
      if (!name.empty()) name = *next++;
    for (const auto& patch : elements_.triangle)
      n_triangles_.push_back(comm.sum(static_cast<std::int64_t>(patch.size())));
    n_elements_ = mesh.info.n_global_cells;
    for (const auto n : n_triangles_) n_elements_ += n;
  }

  void write_2() {
    // elements are written once for each of their groups
    std::int64_t n_cells = 0;
    for (const auto region : elements_.region.of_cell) n_cells += std::ssize(volumes_.of_part[index_of(region)]);
    auto n_elements = comm_.sum(n_cells);
    for (std::size_t p = 0; p < n_triangles_.size(); ++p)
      n_elements += std::ssize(surfaces_.of_part[p]) * n_triangles_[p];
    const auto most = std::max(n_elements, rows_.n_nodes);
    if (binary_ && most > std::numeric_limits<std::int32_t>::max())
      throw Error(fmt::format("Gmsh format 2.2, binary: expected at most 2^31 - 1 nodes and elements, found {}", most));
    begin("2.2");
    section("Nodes", fmt::format("{}\n", rows_.n_nodes));
    Record nodes(binary_);
    for (std::size_t i = 0; i < rows_.position.size(); ++i) {
      nodes.small(rows_.first_node + static_cast<GlobalId>(i) + 1);
      put(nodes, rows_.position[i]);
    }
    end(nodes, "Nodes");
    section("Elements", fmt::format("{}\n", n_elements));
    std::int64_t done = 0;
    for (std::size_t p = 0; p < elements_.triangle.size(); ++p) {
      Record part(binary_);
      const auto& triangles = elements_.triangle[p];
      const auto n_copies = std::ssize(surfaces_.of_part[p]);
      auto number = done + n_copies * comm_.exclusive_sum(std::ssize(triangles));
      const auto entity = static_cast<std::int64_t>(p) + 1;
      for (const auto& face : triangles)
        for (const auto group : surfaces_.of_part[p])
          element_2(part, ++number, Order::triangle_type, surfaces_.number[group], entity, face);
      if (n_triangles_[p] > 0) block_2(part, Order::triangle_type, n_copies * n_triangles_[p]);
      done += n_copies * n_triangles_[p];
    }
    Record cells(binary_);
    auto number = done + comm_.exclusive_sum(n_cells);
    for (std::size_t c = 0; c < rows_.cell_to_node.size(); ++c) {
      const auto part = index_of(elements_.region.of_cell[c]);
      const auto entity =
          static_cast<std::int64_t>(part) + 1;  // Gmsh gives all groups of an entity to all of its cells
      for (const auto group : volumes_.of_part[part])
        element_2(cells, ++number, Order::cell_type, volumes_.number[group], entity, Order::cell(rows_, c));
    }
    if (n_elements > done) block_2(cells, Order::cell_type, n_elements - done);
    end(Record(binary_), "Elements");
    out_.commit();
  }

  void write_4() {
    begin("4.1");
    section("Entities", "");
    write_entities();
    section("Nodes", "");
    write_nodes_4();
    section("Elements", "");
    write_elements_4();
    out_.commit();
  }

 private:
  void begin(const std::string& version) {
    std::string text = "$MeshFormat\n" + version + (binary_ ? " 1 8\n" : " 0 8\n");
    const std::int32_t one = 1;
    if (binary_) text.append(reinterpret_cast<const char*>(&one), sizeof(one)) += '\n';
    std::string names;
    std::size_t n_names = 0;
    const auto list = [&](int dimension, const Physicals& groups) {
      for (std::size_t i = 0; i < groups.name.size(); ++i) {
        if (groups.name[i].empty()) continue;
        names += fmt::format("{} {} \"{}\"\n", dimension, groups.number[i], groups.name[i]);
        ++n_names;
      }
    };
    list(2, surfaces_);
    list(3, volumes_);
    out_.append_once(text + fmt::format("$EndMeshFormat\n$PhysicalNames\n{}\n{}$EndPhysicalNames\n", n_names, names));
  }
  /// Of a region among those with elements or names.
  std::size_t index_of(std::int64_t region) const {
    return static_cast<std::size_t>(std::distance(elements_.volume.begin(), elements_.volume.find(region)));
  }
  void section(const std::string& name, const std::string& head) { out_.append_once("$" + name + "\n" + head); }
  void end(const Record& record, const std::string& name) {
    out_.append(record.data());
    out_.append_once((binary_ ? "\n$End" : "$End") + name + "\n");
  }
  static void put(Record& record, geometry::Vec3 p) {
    record.real(p.x);
    record.real(p.y);
    record.real(p.z);
    record.end_line();
  }

  template <std::size_t N>
  void element_2(Record& record, std::int64_t number, int type, std::int64_t physical, std::int64_t entity,
                 const std::array<GlobalId, N>& nodes) const {
    record.small(number);
    if (!binary_) {
      record.small(type);
      record.small(2);
    }
    record.small(physical);
    record.small(entity);
    for (const auto node : nodes) record.small(node + 1);
    record.end_line();
  }
  void block_2(const Record& record, int type, std::int64_t n) {
    Record head(true);
    head.small(type);
    head.small(n);
    head.small(2);
    if (binary_) out_.append_once(head.data());
    out_.append(record.data());
  }

  void write_entities() {
    const auto [low, high] = mesh::box_over_ranks(comm_, geometry::box_of(rows_.position));
    Record record(binary_);
    if (comm_.is_first()) {
      record.large(0);
      record.large(0);
      record.large(std::count_if(surfaces_.of_part.begin(), surfaces_.of_part.end(),
                                 [](const auto& groups) { return !groups.empty(); }));
      record.large(static_cast<std::int64_t>(elements_.region.all.size()));
      record.end_line();
      const std::array<double, 6> box{low.x, low.y, low.z, high.x, high.y, high.z};
      const auto entity = [&](std::size_t index, const Physicals& all, const std::vector<std::size_t>& groups) {
        record.small(static_cast<std::int64_t>(index) + 1);
        for (const double x : box) record.real(x);
        record.large(std::ssize(groups));
        for (const auto group : groups) record.small(all.number[group]);
        record.large(0);
        record.end_line();
      };
      for (std::size_t p = 0; p < n_triangles_.size(); ++p)
        if (!surfaces_.of_part[p].empty()) entity(p, surfaces_, surfaces_.of_part[p]);
      for (std::size_t r = 0; r < elements_.region.all.size(); ++r)
        entity(r, volumes_, volumes_.of_part[index_of(elements_.region.all[r])]);
    }
    end(record, "Entities");
  }

  void head_4(std::int64_t n_blocks, std::int64_t n) {
    Record head(binary_);
    for (const auto value : {n_blocks, n, std::int64_t{n > 0 ? 1 : 0}, n}) head.large(value);
    head.end_line();
    out_.append_once(head.data());
  }

  void write_nodes_4() {
    const auto n = rows_.n_nodes;
    head_4(n > 0 ? 1 : 0, n);
    Record head(binary_), tags(binary_), points(binary_);
    for (const int value : {3, 1, 0}) head.small(value);
    head.large(n);
    head.end_line();
    if (n > 0) out_.append_once(head.data());
    for (std::size_t i = 0; i < rows_.position.size(); ++i) {
      tags.large(rows_.first_node + static_cast<GlobalId>(i) + 1);
      tags.end_line();
      put(points, rows_.position[i]);
    }
    out_.append(tags.data());
    end(points, "Nodes");
  }

  /// Appends a block of elements of one entity; `number` counts through the file.
  template <class Item>
  void block_4(int dimension, std::size_t entity, int type, const std::vector<Item>& items, std::int64_t& number) {
    const auto n = comm_.sum(static_cast<std::int64_t>(items.size()));
    if (n == 0) return;
    Record head(binary_), part(binary_);
    head.small(dimension);
    head.small(static_cast<std::int64_t>(entity) + 1);
    head.small(type);
    head.large(n);
    head.end_line();
    out_.append_once(head.data());
    auto mine = number + comm_.exclusive_sum(static_cast<std::int64_t>(items.size()));
    for (const auto& item : items) {
      part.large(++mine);
      for (const auto node : item) part.large(node + 1);
      part.end_line();
    }
    out_.append(part.data());
    number += n;
  }

  void write_elements_4() {
    const auto n_surfaces =
        std::count_if(n_triangles_.begin(), n_triangles_.end(), [](std::int64_t n) { return n > 0; });
    head_4(n_surfaces + static_cast<std::int64_t>(elements_.region.all.size()), n_elements_);
    std::int64_t number = 0;
    for (std::size_t p = 0; p < elements_.triangle.size(); ++p)
      block_4(2, p, Order::triangle_type, elements_.triangle[p], number);
    const auto rows_of_region = elements_.region.rows_of_each();
    for (std::size_t r = 0; r < rows_of_region.size(); ++r) {
      std::vector<typename Order::Cell> cells;
      for (const auto c : rows_of_region[r]) cells.push_back(Order::cell(rows_, c));
      block_4(3, r, Order::cell_type, cells, number);
    }
    end(Record(binary_), "Elements");
  }

  const par::Comm& comm_;
  const mesh::DistMesh& mesh_;
  bool binary_;
  SharedOutput out_;
  RowsInOrder rows_;
  Elements<Order> elements_;
  Physicals surfaces_, volumes_;           ///< of patches and interfaces, of `elements_.volume`
  std::vector<std::int64_t> n_triangles_;  ///< of each patch and interface, all ranks
  std::int64_t n_elements_ = 0;
};

template <class Order>
void write(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
           const GmshWriteOptions& options, const mesh::SecondOrder* second_order) {
  Writer<Order> writer(comm, file, mesh, second_order, options);
  options.version == GmshVersion::v2_2 ? writer.write_2() : writer.write_4();
}

}  // namespace

void write_gmsh(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                const GmshWriteOptions& options, const mesh::SecondOrder* second_order) {
  if (second_order == nullptr)
    write<FirstOrder>(comm, file, mesh, options, nullptr);
  else
    write<OfSecondOrder>(comm, file, mesh, options, second_order);
}

}  // namespace pamr::io
