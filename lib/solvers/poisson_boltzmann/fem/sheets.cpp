// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/sheets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/inner_patches.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Refuses what no patch inside can be.
void require_sheet(const Case& input, const Boundary& b, const std::string& where) {
  if (b.condition != Condition::potential && b.condition != Condition::charge)
    throw Error(
        fmt::format("{}: expected kind = \"potential\" or \"charge\" in [boundary.{}], whose faces lie inside the "
                    "liquid, found \"{}\" (without a table the liquid goes on through them)",
                    where, b.patch, name_of(b.condition)));
  if (input.plate && input.plate->patch == b.patch)
    throw Error(fmt::format("{}: expected a patch of the boundary in [plate], found \"{}\", whose faces lie inside",
                            where, b.patch));
}

/// Refuses a pattern that stands for patches inside alone: it would say nothing.
void require_use(const std::vector<Boundary>& dropped, const std::vector<Boundary>& left, const std::string& where) {
  for (const auto& b : dropped)
    if (std::none_of(left.begin(), left.end(), [&](const Boundary& other) { return other.pattern == b.pattern; }))
      throw Error(
          fmt::format("{}: expected a condition at the boundary, found \"{}\", for which patches inside the liquid "
                      "stand alone: a sheet is named by its own name or that of a group",
                      where, b.pattern));
}

}  // namespace

Case with_sheets(const par::Comm& comm, Case input, const mesh::DistMesh& mesh, const std::string& where) {
  const auto& patches = mesh.info.patches;
  const auto n_inside = mesh::count_inner_faces(comm, mesh);
  const auto is_alone = mesh::patches_inside_alone(comm, mesh);
  const auto number_of = [&](const Boundary& b) {
    const auto found =
        std::find_if(patches.begin(), patches.end(), [&](const mesh::Patch& patch) { return patch.name == b.patch; });
    return static_cast<std::size_t>(found - patches.begin());
  };
  std::vector<Boundary> dropped, left;
  for (auto& b : std::exchange(input.boundary, {})) {
    const auto p = number_of(b);
    const bool is_sheet = p < patches.size() && is_alone[p];
    (is_sheet && !b.pattern.empty() ? dropped : left).push_back(std::move(b));
    if (is_sheet && !left.empty() && left.back().patch == patches[p].name) left.back().is_inside = true;
  }
  require_use(dropped, left, where);
  input.boundary = std::move(left);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (n_inside[p] == 0) continue;
    const auto* b = input.find_boundary(patches[p].name);
    if (is_alone[p] && input.force.midplane == patches[p].name)
      throw Error(fmt::format("{}: expected a mirror of the boundary as midplane, found \"{}\", whose faces lie inside",
                              where, patches[p].name));
    if (b == nullptr) {
      if (is_alone[p]) input.open_inside.push_back(patches[p].name);
      continue;
    }
    if (is_alone[p]) {
      require_sheet(input, *b, where);
    } else if (b->holds_charge()) {
      throw Error(fmt::format(
          "{}: expected a patch on the boundary or inside for a charge, found \"{}\" with faces on the boundary and {} "
          "inside, which hold it on both sides: give these a patch of their own",
          where, patches[p].name, n_inside[p]));
    } else if (b->condition != Condition::potential) {
      input.open_inside.push_back(patches[p].name);
    }
  }
  return input;
}

std::vector<bool> sheets_of(const Case& input, const std::vector<mesh::Patch>& patches) {
  std::vector<bool> result;
  for (const auto& patch : patches) {
    const auto* b = input.find_boundary(patch.name);
    result.push_back(b != nullptr && (b->is_inside || b->condition == Condition::potential));
  }
  return result;
}

}  // namespace pamr::poisson_boltzmann
