// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/case_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/name_pattern.hpp"
#include "pamr/mesh/find_patches.hpp"

namespace pamr::poisson_boltzmann {

namespace {

using Names = std::vector<std::string>;

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<Boundary> resolved_boundary(const std::vector<Boundary>& stated, const std::vector<mesh::Patch>& patches,
                                        const std::string& where) {
  Names names;
  for (const auto& b : stated) names.push_back(b.patch);
  std::vector<Names> found(stated.size());
  for (const auto& patch : patches)
    if (const auto i = find_pattern(names, patch.name, where + ": [boundary.PATCH]", mesh::group_names(patch)))
      found[*i].push_back(patch.name);
  std::vector<Boundary> result;
  for (std::size_t i = 0; i < stated.size(); ++i) {
    if (mesh::find_patches(patches, stated[i].patch).empty()) result.push_back(stated[i]);
    for (const auto& patch : found[i]) {
      auto& b = result.emplace_back(stated[i]);
      b.patch = patch;
      if (is_name_pattern(stated[i].patch)) b.pattern = stated[i].patch;
    }
  }
  return result;
}

/// Names of the patches of given potential or charge for which the name of a group or a pattern stands.
Names electrodes_named(const std::string& pattern, const std::vector<mesh::Patch>& patches, const Case& input) {
  Names names;
  for (const int patch : mesh::find_patches(patches, pattern))
    if (const auto& name = patches[at(patch)].name; input.is_electrode(name)) names.push_back(name);
  return names;
}

}  // namespace

void require_bodies(const Case& input, const std::string& where) {
  Names named;
  for (const auto& b : input.boundary) named.push_back(b.patch);
  for (const auto& body : input.bodies) {
    for (const auto& patch : body.patches)
      if (!is_name_pattern(patch) && !input.is_electrode(patch))
        throw Error(
            fmt::format("{}: expected patches with kind = \"potential\", \"charge\" or \"regulated\" in [[body]] "
                        "\"{}\", found \"{}\"",
                        where, body.name, patch));
    const bool is_alone = body.patches == Names{body.name};
    if (!is_alone && contains(named, body.name))
      throw Error(fmt::format("{}: expected names of [[body]] that are no patch's, found \"{}\"", where, body.name));
  }
}

Case resolve_names(Case input, const std::vector<mesh::Patch>& patches, const std::string& where) {
  input.boundary = resolved_boundary(input.boundary, patches, where);
  for (auto& body : input.bodies) {
    Names all;
    for (const auto& name : std::exchange(body.patches, {})) {
      const bool is_unknown = !is_name_pattern(name) && mesh::find_patches(patches, name).empty();
      const auto found = is_unknown ? Names{name} : electrodes_named(name, patches, input);
      if (found.empty())
        throw Error(fmt::format(
            "{}: expected patches of the mesh with kind = \"potential\", \"charge\" or \"regulated\" in [[body]] "
            "\"{}\", found none that \"{}\" stands for",
            where, body.name, name));
      for (const auto& patch : found)
        if (!contains(all, patch)) all.push_back(patch);
    }
    body.patches = std::move(all);
  }
  require_bodies(input, where);
  return input;
}

}  // namespace pamr::poisson_boltzmann
