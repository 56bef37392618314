// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/options.hpp"

#include <fmt/format.h>

#include "pamr/base/error.hpp"

namespace pamr::refine {

QualityControl quality_control_named(std::string_view wanted) {
  for (const auto& [name, policy] : quality_control_names)
    if (wanted == name) return policy;
  throw Error("quality control: expected none, isotropic, short-edge or removable, found " + std::string(wanted));
}

std::vector<std::string> quality_control_list() {
  std::vector<std::string> names;
  for (const auto& [name, policy] : quality_control_names) names.emplace_back(name);
  return names;
}

Bend bend_named(std::string_view wanted) {
  for (const auto& [name, bend] : bend_names)
    if (wanted == name) return bend;
  throw Error("bend: expected none, walls or all, found " + std::string(wanted));
}

std::vector<std::string> bend_list() {
  std::vector<std::string> names;
  for (const auto& [name, bend] : bend_names) names.emplace_back(name);
  return names;
}

void require_sound(const Options& options) {
  if (!(options.shape_floor >= 0 && options.shape_floor <= 1))
    throw Error(fmt::format("shape floor: expected a mean ratio from 0 (none) to 1, found {}", options.shape_floor));
}

}  // namespace pamr::refine
