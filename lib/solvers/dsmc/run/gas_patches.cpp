// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/gas_patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/base/name_pattern.hpp"
#include "pamr/mesh/face_geometry.hpp"
#include "pamr/mesh/find_patches.hpp"
#include "pamr/mesh/inner_patches.hpp"

namespace pamr::dsmc {

namespace {

/// One side of a patch inside, in the groups of the patch and in one of its name.
mesh::Patch side_of(const mesh::Patch& patch, const char* side) {
  auto result = patch;
  result.name += side;
  result.groups.insert(result.groups.begin(), {patch.number, patch.name});
  return result;
}

/// The table of the case that names a patch or a group of it; empty: none. Patterns are for the boundary.
std::string table_of(const Case& c, const mesh::Patch& patch) {
  std::vector<std::string> tables;
  for (const auto& [name, condition] : c.boundary)
    if (!is_name_pattern(name)) tables.push_back(name);
  const auto found = find_pattern(tables, patch.name, c.where + ": [boundary.PATCH]", mesh::group_names(patch));
  return found ? tables[*found] : std::string();
}

/// The table of a side: its own, that of the patch, or that of a group.
std::string table_of_side(const Case& c, const mesh::Patch& side, const mesh::Patch& patch) {
  return c.boundary.count(side.name) != 0 ? side.name : table_of(c, patch);
}

/// The front, as the tables of a patch or of its sides tell it.
Facing facing_of(const Case& c, const mesh::Patch& patch, const std::array<std::string, 2>& tables) {
  std::vector<std::string> telling;
  for (const auto& name : {patch.name, tables[0], tables[1]})
    if (c.facing.count(name) != 0 && std::find(telling.begin(), telling.end(), name) == telling.end())
      telling.push_back(name);
  if (telling.size() == 1) return c.facing.at(telling.front());
  if (!telling.empty())
    throw Error(fmt::format("{}: expected front or inside in one table of \"{}\" and its sides, found it in {}",
                            c.boundary_at.at(telling.front()), patch.name, listed(telling, {.most = all_items})));
  throw Error(
      fmt::format("{}: expected front = [x, y, z], the direction in which the front of \"{}\" looks, or inside = "
                  "[x, y, z], a point that it looks away from, because its faces lie inside the gas",
                  c.boundary_at.at(tables[0]), patch.name));
}

/// Makes a patch with faces inside a wall, if the case names it. `is_alone`: it has none on the boundary.
void add_inner_wall(const Case& c, int p, bool is_alone, Setup& setup) {
  const auto patch = setup.patches[at(p)];
  const std::array<mesh::Patch, 2> sides{side_of(patch, ":front"), side_of(patch, ":back")};
  const std::array<std::string, 2> tables{table_of_side(c, sides[0], patch), table_of_side(c, sides[1], patch)};
  if (tables[0].empty() && tables[1].empty()) return;
  const auto is_wall = [&](const std::string& table) { return !table.empty() && c.boundary.at(table).is_wall(); };
  if (!is_alone && !is_wall(tables[0]) && !is_wall(tables[1])) return;  // these are of its faces on the boundary
  for (std::size_t k = 0; k < 2; ++k)
    if (!is_wall(tables[k]))
      throw Error(fmt::format(
          "{}: expected a wall (diffuse, specular, maxwell or cll) on both sides of \"{}\", whose faces lie inside the "
          "gas, found {} for \"{}\"",
          c.boundary_at.at(tables[tables[k].empty() ? 1 - k : k]), patch.name,
          tables[k].empty() ? "no table" : "another kind", sides[k].name));
  InnerWall wall{p, {}, facing_of(c, patch, tables)};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& condition = c.boundary.at(tables[k]);
    if (k == 0 && is_alone) {
      wall.side[k] = p;
      setup.patches[at(p)] = sides[k];
      setup.patch[at(p)] = condition;
      continue;
    }
    wall.side[k] = static_cast<int>(setup.patches.size());
    setup.patches.push_back(sides[k]);
    setup.patch.push_back(condition);
  }
  setup.inner_wall.push_back(wall);
}

void require_tables(const Case& c, const std::vector<std::string>& missing) {
  if (missing.empty()) return;
  throw Error(
      fmt::format("{}: expected a table [boundary.PATCH] for every patch of the mesh, found none for {} (PATCH "
                  "may stand for several, such as \"*\")",
                  c.where, listed(missing, {.most = all_items})));
}

/// Every table has to be of some patch that is there, and to say `front` or `inside` only of walls inside.
void require_patches_of_tables(const Case& c, const std::vector<bool>& is_open_inside, const Setup& setup) {
  for (const auto& [name, condition] : c.boundary) {
    const auto found = mesh::require_patches(setup.patches, name, c.boundary_at.at(name) + ": [boundary.PATCH]");
    if (std::all_of(found.begin(), found.end(),
                    [&](int p) { return at(p) < is_open_inside.size() && is_open_inside[at(p)]; }))
      throw Error(
          fmt::format("{}: expected a condition at the boundary, found \"{}\", for which patches inside the gas stand "
                      "alone: a wall inside is named by its own name or that of a group",
                      c.boundary_at.at(name), name));
    const bool is_inside = std::any_of(setup.inner_wall.begin(), setup.inner_wall.end(), [&](const InnerWall& wall) {
      return std::any_of(found.begin(), found.end(), [&](int p) { return p == wall.side[0] || p == wall.side[1]; });
    });
    if (c.facing.count(name) != 0 && !is_inside)
      throw Error(fmt::format("{}: expected no front or inside for \"{}\", whose faces lie on the boundary",
                              c.boundary_at.at(name), name));
  }
}

/// Throws `Error`, maybe on this rank only, for a face of which neither side is the front.
void require_sides(const Case& c, const mesh::DistMesh& mesh, const Setup& setup) {
  constexpr double least = 1e-6;
  if (setup.inner_wall.empty()) return;
  const mesh::InnerPatches inner(mesh);
  inner.for_each([&](mesh::CellFace face, int patch) {
    const auto* wall = find_wall(setup.inner_wall, patch);
    if (wall == nullptr) return;
    const auto points = corners(mesh, setup.unit, face.cell);
    const auto area = mesh::area_vector(points, face.slot);
    const auto center = mesh::face_centroid(points, face.slot);
    if (std::fabs(wall->facing.of_side((1 / norm(area)) * area, center)) < least)
      throw Error(fmt::format(
          "{}: expected a direction or point that tells the sides of \"{}\" apart, found a face near ({:g}, {:g}, "
          "{:g}) m that looks along it",
          c.where, mesh.info.patches[at(patch)].name, center.x, center.y, center.z));
  });
}

void set_partners(const Case& c, Setup& setup) {
  const auto number = [&](const std::string& name) {
    const auto found = mesh::find_patches(setup.patches, name);
    if (found.size() != 1)
      throw Error(fmt::format("{}: expected one patch of kind \"periodic\", found that \"{}\" stands for {}",
                              c.boundary_at.at(name), name, found.size()));
    return found.front();
  };
  for (const auto& [name, partner] : c.partner) setup.patch[at(number(name))].partner = number(partner);
}

}  // namespace

void set_patches(const par::Comm& comm, const Case& c, const mesh::DistMesh& mesh, Setup& setup) {
  setup.patches = mesh.info.patches;
  const auto n = setup.patches.size();
  const auto inside = mesh::patches_inside_alone(comm, mesh);
  const auto n_faces = mesh::count_inner_faces(comm, mesh);
  std::vector<std::string> missing;
  for (std::size_t p = 0; p < n; ++p) {
    const auto& patch = setup.patches[p];
    auto& condition = setup.patch.emplace_back();
    condition.kind = BoundaryCondition::Kind::symmetry;  // of patches inside: met by nobody
    if (inside[p]) continue;
    if (const auto* found = c.find_boundary(patch.name, mesh::group_names(patch)))
      condition = *found;
    else
      missing.push_back(patch.name);
  }
  require_tables(c, missing);
  for (std::size_t p = 0; p < n; ++p)
    if (n_faces[p] > 0) add_inner_wall(c, static_cast<int>(p), inside[p], setup);
  auto is_open_inside = inside;
  for (const auto& wall : setup.inner_wall) is_open_inside[at(wall.patch)] = false;
  require_patches_of_tables(c, is_open_inside, setup);
  par::agree(comm, [&] { require_sides(c, mesh, setup); });
  set_partners(c, setup);
}

}  // namespace pamr::dsmc
