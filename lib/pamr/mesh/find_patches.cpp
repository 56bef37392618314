// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/find_patches.hpp"

#include "pamr/base/index.hpp"
#include "pamr/base/name_pattern.hpp"

namespace pamr::mesh {

std::vector<int> find_patches(const std::vector<Patch>& patches, const std::string& name) {
  std::vector<int> found;
  for (int p = 0; p < static_cast<int>(patches.size()); ++p) {
    if (patches[at(p)].name == name) return {p};
    if (stands_for(name, patches[at(p)].name)) found.push_back(p);
  }
  return found;
}

}  // namespace pamr::mesh
