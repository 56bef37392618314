// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/find_patches.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/base/name_pattern.hpp"

namespace pamr::mesh {

std::vector<int> find_patches(const std::vector<Patch>& patches, const std::string& name) {
  std::vector<int> exact, fitting;
  for (int p = 0; p < static_cast<int>(patches.size()); ++p) {
    const auto& patch = patches[at(p)];
    const auto is_any = [&](auto&& is_wanted) {
      return is_wanted(patch.name) || std::any_of(patch.groups.begin(), patch.groups.end(),
                                                  [&](const Group& group) { return is_wanted(group.name); });
    };
    if (is_any([&](const std::string& own) { return own == name; })) exact.push_back(p);
    if (is_any([&](const std::string& own) { return stands_for(name, own); })) fitting.push_back(p);
  }
  return exact.empty() ? fitting : exact;
}

std::vector<int> require_patches(const std::vector<Patch>& patches, const std::string& name, const std::string& where) {
  auto found = find_patches(patches, name);
  if (found.empty())
    throw Error(fmt::format("{}: expected a patch of the mesh ({}), found \"{}\"", where, list_patches(patches), name));
  return found;
}

std::vector<std::string> group_names(const Patch& patch) {
  std::vector<std::string> names;
  for (const auto& group : patch.groups) names.push_back(group.name);
  return names;
}

std::string list_patches(const std::vector<Patch>& patches) {
  if (patches.empty()) return "none";
  return listed(patches, {.most = all_items}, &Patch::name);
}

}  // namespace pamr::mesh
