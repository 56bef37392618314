// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::check {

inline constexpr int n_bins = 50;

/// Distribution of one measure of cell shape over all cells of the mesh.
///
/// Bin i counts the values from `edge[i]` up to, not including, `edge[i+1]`; what lies outside the edges falls into the
/// first or last bin, so the bins add up to the number of cells. The edges depend on the metric alone: meshes can be
/// compared bin by bin.
struct MetricReport {
  std::string name;
  double min = 0, mean = 0, max = 0;
  std::array<double, n_bins + 1> edge{};
  std::array<std::int64_t, n_bins> histogram{};
};

/// Gathers the distributions of several metrics, value by value. The means are exact sums rounded once: the same bits
/// for every number of ranks and every order.
class MetricTally {
 public:
  enum class Scale { to_one, degrees, powers };  ///< edges of the histogram: 0 to 1, 0 to 180, 1 to 100 by powers
  struct Kind {
    std::string name;
    Scale scale = Scale::to_one;
  };
  explicit MetricTally(std::vector<Kind> kinds);

  /// One value of metric `m`; not NaN.
  void add(std::size_t m, double value);
  /// What all ranks have gathered, in the order of the kinds; all zero where there are no values. Collective: four
  /// reductions, and two for each metric.
  std::vector<MetricReport> report(const par::Comm& comm) const;

 private:
  std::vector<Kind> kinds_;
  std::vector<double> min_, max_;
  std::vector<par::ExactSum> sum_;
  std::vector<std::int64_t> count_;
};

/// Names of the metrics, in the order of the report: `radius_ratio mean_ratio aspect_ratio min_dihedral max_dihedral
/// edge_ratio` (geometry/quality.hpp defines them; the angles are the cell's smallest and largest, in degrees).
const std::vector<std::string>& metric_names();

/// Value of a metric for one cell, in the order of `metric_names`. Where the formula has no value (corners that are not
/// finite or coincide) it is the worst one: 0 for ratios of which 1 is the best and largest value and for
/// `min_dihedral`, 180 for `max_dihedral`, infinite otherwise.
std::array<double, 6> cell_metrics(const geometry::TetPoints& points);

/// All metrics over all cells; empty mesh: all zero. The means are exact sums rounded once, so every number has the
/// same bits for every number of ranks and every order of the cells. Collective: 16 reductions. O(cells).
std::vector<MetricReport> measure_cells(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::check
