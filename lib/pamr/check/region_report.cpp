// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/region_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/par/gather_few.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::check {

std::vector<RegionReport> measure_regions(const par::Comm& comm, const mesh::DistMesh& mesh) {
  constexpr std::size_t max_regions = 1000;
  const auto* field = mesh::find_regions(mesh);
  if (field == nullptr) return {};
  const auto& region = field->integer();
  std::set<std::int64_t> here;
  for (LocalId c = 0; c < mesh.n_cells() && here.size() <= max_regions; ++c) here.insert(region[at(c)]);
  if (comm.max(std::int64_t{std::ssize(here)}) > std::int64_t{max_regions}) return {};
  const auto numbers = par::gather_distinct(comm, here);
  if (numbers.size() > max_regions) return {};

  std::vector<par::ExactSum> volume(numbers.size());
  std::vector<std::int64_t> cells(numbers.size(), 0);
  std::vector<double> ratio(numbers.size(), -std::numeric_limits<double>::infinity());  // negated, for a maximum
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto r = at(std::lower_bound(numbers.begin(), numbers.end(), region[at(c)]) - numbers.begin());
    const auto points = mesh.points(c);
    const double here_ratio = geometry::mean_ratio(points);
    volume[r].add(geometry::volume(points));
    ++cells[r];
    ratio[r] = std::max(ratio[r], std::isnan(here_ratio) ? 0 : -here_ratio);
  }
  const auto volumes = par::reproducible_sums(comm, volume);
  comm.sum_in_place(cells);
  comm.max_in_place(ratio);
  std::vector<RegionReport> result;
  for (std::size_t r = 0; r < numbers.size(); ++r) {
    auto name = mesh::name_of_region(mesh.info, numbers[r]);
    const auto has_it = [&name](const auto& before) { return before.name == name; };
    if (name.empty() || std::any_of(result.begin(), result.end(), has_it)) name = std::to_string(numbers[r]);
    result.push_back({numbers[r], std::move(name), cells[r], volumes[r], 0 - ratio[r]});
  }
  return result;
}

}  // namespace pamr::check
