// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/surface_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pamr/base/error.hpp"

namespace pamr::geometry {

int SurfaceSet::index_of(std::string_view wanted) const {
  const auto place = std::find(name.begin(), name.end(), wanted);
  return place == name.end() ? -1 : static_cast<int>(place - name.begin());
}

const Surface* SurfaceSet::get(Exact<int> index) const {
  return index < 0 || index >= size() ? nullptr : surface[static_cast<std::size_t>(index)].get();
}

void SurfaceSet::add(std::string new_name, std::string where, std::shared_ptr<const Surface> new_surface) {
  if (index_of(new_name) >= 0)
    throw Error(fmt::format("{}: surface \"{}\": expected a new name, found it twice", where, new_name));
  name.push_back(std::move(new_name));
  described_at.push_back(std::move(where));
  surface.push_back(std::move(new_surface));
}

void SurfaceSet::append(const SurfaceSet& other) {
  for (std::size_t i = 0; i < other.surface.size(); ++i) add(other.name[i], other.described_at[i], other.surface[i]);
  if (!toml.empty() && !other.toml.empty() && toml.back() != '\n') toml += '\n';
  toml += other.toml;
  triangulations.insert(triangulations.end(), other.triangulations.begin(), other.triangulations.end());
}

std::vector<std::string> SurfaceSet::remarks() const {
  std::vector<std::string> texts;
  for (const auto& one : triangulations)
    for (const auto& remark : one->remarks) texts.push_back(fmt::format("surface \"{}\": {}", one->name, remark));
  return texts;
}

SharedSurfaces no_surfaces() { return std::make_shared<const SurfaceSet>(); }

}  // namespace pamr::geometry
