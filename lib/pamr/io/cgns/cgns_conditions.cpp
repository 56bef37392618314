// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/cgns/cgns_conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io::cgns {

namespace {

std::string kind_of(const std::string& condition) {
  for (const auto& [begin, kind] :
       {std::pair("BCWall", "wall"), std::pair("BCSymmetryPlane", "symmetry"), std::pair("BCFarfield", "farfield"),
        std::pair("BCInflow", "inflow"), std::pair("BCOutflow", "outflow")})
    if (condition.starts_with(begin)) return kind;
  return {};
}

class ConditionReader {
 public:
  ConditionReader(const Tree& tree, const std::string& base, const std::string& zone, ZoneElements& elements,
                  WholeMesh& mesh)
      : tree_(tree), base_(base), zone_(zone), elements_(elements), mesh_(mesh) {}

  void read() {
    const auto all = tree_.child(zone_, "ZoneBC_t", true);
    if (all.path.empty()) return;
    std::vector<std::uint8_t> is_in_condition(mesh_.triangle.size(), 0);
    std::set<std::int64_t> of_conditions;
    std::vector<std::uint8_t> is_named_cell(mesh_.cell.size(), 0);
    for (const bool on_elements : {true, false})
      for (const auto& condition : tree_.children(all.path, "BC_t")) {
        const auto named = named_by(condition);
        if (named.are_elements != on_elements) continue;
        count_others(tree_, condition.path, {"IndexRange_t", "IndexArray_t", "GridLocation_t", "FamilyName_t"},
                     mesh_.left_out);
        CellGroup given{condition.name, {}};
        auto type = tree_.text(condition);
        if (type == "FamilySpecified") std::tie(given, type) = family_of(condition);
        const auto& name = given.name;
        std::vector<std::size_t> triangles;
        std::int32_t of_cells = -1;
        if (on_elements) {
          for (const auto number : named.number) {
            const auto faces = elements_.triangles.find(number);
            for (std::size_t k = 0; k < faces.n; ++k) triangles.push_back(faces.first + k);
            const auto [first, n] = elements_.cells.find(number);
            if (n == 0) continue;
            if (of_cells < 0) of_cells = elements_.group_of(given);
            const auto group = elements_.group_of_cell.begin() + static_cast<std::ptrdiff_t>(first);
            if (std::exchange(is_named_cell[first], 1) == 0)
              std::fill_n(group, n, of_cells);
            else if (*group != of_cells)
              ++shared_[{3, elements_.group[at(*group)].name, name}];
          }
        } else {
          triangles = triangles_within(named.number);
        }
        if (of_cells >= 0) elements_.has_named_cells = true;
        if (triangles.empty() && of_cells >= 0) continue;
        const auto tag = elements_.tag_of(name, mesh_);
        auto& patch = mesh_.patch_of_tag[tag];
        take_kind(condition, type, patch);
        patch.groups.clear();
        for (const auto& member : given.members) patch.groups.push_back({-1, member});
        of_conditions.insert(tag);
        for (const auto t : triangles) {
          if (is_in_condition[t] == 0)
            mesh_.tag[t] = tag;
          else if (mesh_.tag[t] != tag)
            ++shared_[{2, mesh_.patch_of_tag[mesh_.tag[t]].name, name}];
          is_in_condition[t] = 1;
        }
      }
    for (const auto& [groups, n] : shared_)
      mesh_.overlaps.push_back({std::get<0>(groups), std::get<1>(groups), std::get<2>(groups), n, "which comes first"});
    // Sections whose triangles are all in conditions are no groups of their own.
    of_conditions.insert(mesh_.tag.begin(), mesh_.tag.end());
    std::erase_if(mesh_.patch_of_tag, [&](const auto& one) { return !of_conditions.contains(one.first); });
  }

 private:
  /// Elements or vertices that a condition names.
  struct Named {
    bool are_elements = false;
    std::vector<std::int64_t> number;
  };
  Named named_by(const Node& condition) const {
    const auto location = tree_.text(tree_.child(condition.path, "GridLocation_t", true));
    Named named{location == "FaceCenter" || location == "CellCenter", {}};  // Gmsh has the latter
    for (const auto* label : {"IndexRange_t", "IndexArray_t"})
      for (const auto& node : tree_.children(condition.path, label)) {
        const bool is_range = node.name == "PointRange" || node.name == "ElementRange";
        if (!is_range && node.name != "PointList" && node.name != "ElementList") continue;
        named.are_elements = named.are_elements || node.name.starts_with("Element");
        named.number = tree_.integers(node);
        if (is_range) named.number = within(named.number, named.are_elements);
      }
    return named;
  }

  /// A type without a kind of patches that goes with it is said, but for those that mean none.
  void take_kind(const Node& condition, const std::string& type, mesh::Patch& patch) {
    constexpr std::array<std::string_view, 4> no_types{"", "Null", "UserDefined", "BCGeneral"};
    patch.kind = kind_of(type);
    if (patch.kind.empty() && std::find(no_types.begin(), no_types.end(), type) == no_types.end())
      mesh_.remarks.push_back(fmt::format("the type '{}' of the condition '{}' was left out", shown_text(type),
                                          shown_text(condition.name)));
  }

  std::vector<std::size_t> triangles_within(const std::vector<std::int64_t>& vertices) const {
    const std::set<std::int64_t> corners(vertices.begin(), vertices.end());
    std::vector<std::size_t> triangles;
    for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) {
      const auto& node = mesh_.triangle[t];
      if (std::all_of(node.begin(), node.end(), [&](auto n) { return corners.contains(n + 1); }))
        triangles.push_back(t);
    }
    return triangles;
  }

  /// Numbers of a range: of elements those that are triangles or cells.
  std::vector<std::int64_t> within(const std::vector<std::int64_t>& range, bool are_elements) const {
    std::vector<std::int64_t> numbers;
    if (range.size() != 2) return numbers;
    const auto add = [&](const Elements& known) {
      for (auto run = known.run_after(range[0]); run != known.runs().end() && run->number <= range[1]; ++run)
        for (auto n = std::max(range[0], run->number); n < run->end() && n <= range[1]; ++n) numbers.push_back(n);
    };
    if (are_elements) {
      add(elements_.triangles);
      add(elements_.cells);
    } else {
      for (auto n = std::max<std::int64_t>(range[0], 1); n <= std::min(range[1], std::ssize(mesh_.point)); ++n)
        numbers.push_back(n);
    }
    return numbers;
  }

  /// The group of the family of a condition, and the type of the family. Gmsh writes one family for each entity, with
  /// the names of the groups of that entity in it.
  std::pair<CellGroup, std::string> family_of(const Node& condition) {
    const auto family = tree_.text(tree_.child(condition.path, "FamilyName_t", true));
    if (family.empty()) return {{condition.name, {}}, {}};
    const auto families = tree_.children(base_, "Family_t");
    for (const auto& node : families) {
      if (node.name != family) continue;
      const auto type = tree_.text(tree_.child(node.path, "FamilyBC_t", true));
      const auto groups = tree_.children(node.path, "FamilyName_t");
      if (groups.size() == 1) return {{groups.front().name, {}}, type};
      const auto is_of_gmsh = [&](const Node& group) { return tree_.text(group) == group.name; };  // a tree has places
      if (groups.empty() || !type.empty() || !std::all_of(groups.begin(), groups.end(), is_of_gmsh))
        return {{family, {}}, type};
      CellGroup joint;
      for (const auto& group : groups) joint.members.push_back(group.name);
      auto& name = joint_name_[{joint.members.begin(), joint.members.end()}];
      if (name.empty()) name = joint_name(joint.members, families);
      joint.name = name;
      return {joint, type};
    }
    return {{family, {}}, {}};
  }

  /// `A+B`, with more `+` where a family, group, condition or section has that name.
  std::string joint_name(const std::vector<std::string>& members, const std::vector<Node>& families) const {
    std::set<std::string> taken;
    for (const auto& [others, name] : joint_name_) taken.insert(name);
    for (const auto& node : tree_.children(zone_, "Elements_t")) taken.insert(node.name);
    for (const auto& node : tree_.children(tree_.child(zone_, "ZoneBC_t").path, "BC_t")) taken.insert(node.name);
    for (const auto& family : families) {
      taken.insert(family.name);
      for (const auto& group : tree_.children(family.path, "FamilyName_t")) taken.insert(group.name);
    }
    std::string name;
    for (const auto& member : members) name += (name.empty() ? "" : "+") + member;
    while (taken.contains(name)) name += '+';
    return name;
  }

  const Tree& tree_;
  const std::string& base_;
  const std::string& zone_;
  ZoneElements& elements_;
  WholeMesh& mesh_;
  std::map<std::set<std::string>, std::string> joint_name_;  ///< of groups that families name together
  /// Elements in two conditions by dimension, name kept, other name.
  std::map<std::tuple<int, std::string, std::string>, std::int64_t> shared_;
};

}  // namespace

void Elements::add(std::int64_t number, Pieces pieces) {
  const bool continues = !runs_.empty() && runs_.back().end() == number && runs_.back().pieces.n == pieces.n &&
                         runs_.back().of(number).first == pieces.first;
  if (continues)
    ++runs_.back().n;
  else
    runs_.push_back({number, 1, pieces});
}

void Elements::put_in_order() {
  const auto is_before = [](const Run& a, const Run& b) { return a.number < b.number; };
  were_in_order_ = std::is_sorted(runs_.begin(), runs_.end(), is_before);
  std::stable_sort(runs_.begin(), runs_.end(), is_before);
  for (std::size_t i = 1; i < runs_.size(); ++i)
    if (runs_[i].number < runs_[i - 1].end())
      throw Error(fmt::format("expected cells, and triangles, with different numbers, found two with number {}",
                              runs_[i].number));
}

Elements::Pieces Elements::find(std::int64_t number) const {
  const auto run = run_after(number);
  return run == runs_.end() || number < run->number ? Pieces{} : run->of(number);
}

std::vector<Elements::Run>::const_iterator Elements::run_after(std::int64_t number) const {
  return std::partition_point(runs_.begin(), runs_.end(), [&](const Run& run) { return run.end() <= number; });
}

std::int64_t Elements::size() const {
  return std::accumulate(runs_.begin(), runs_.end(), std::int64_t{0},
                         [](std::int64_t sum, const Run& run) { return sum + run.n; });
}

std::int32_t ZoneElements::group_of(const CellGroup& named) {
  const auto [found, is_new] = group_of_name.emplace(named.name, static_cast<std::int32_t>(group.size()));
  if (is_new) group.push_back(named);
  return found->second;
}

std::int64_t ZoneElements::tag_of(const std::string& name, WholeMesh& mesh) {
  const auto [found, is_new] = tag_of_name.emplace(name, std::ssize(tag_of_name));
  if (is_new) mesh.patch_of_tag[found->second] = {name, ""};
  return found->second;
}

void read_conditions(const Tree& tree, const std::string& base, const std::string& zone, ZoneElements& elements,
                     WholeMesh& mesh) {
  ConditionReader(tree, base, zone, elements, mesh).read();
}

}  // namespace pamr::io::cgns
