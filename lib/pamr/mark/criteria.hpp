// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mark/field_criteria.hpp"
#include "pamr/mark/geometric_criteria.hpp"

namespace pamr::mark {

struct AllCells {};
struct CrossingSphere {
  Sphere sphere;
};
struct CentroidShell {
  Sphere sphere;
  double width = 0;
};
struct Box {
  geometry::Vec3 low, high;
};
struct NearPatch {
  std::string patch;
  int layers = 1;
};
struct SizeOver {
  std::string field;
  double ratio = 1;
};

struct ErrorOver {
  enum class Bar { theta, target, bulk };
  std::string field;
  Bar bar = Bar::theta;
  double value = 0;  ///< share of the mean square; relative error; fraction of the total squared error
};

/// The fewest cells that carry this part of the sum of a field.
struct BulkOf {
  std::string field;
  double fraction = 0;
};

/// One criterion as the command line states it.
struct Criterion {
  std::string text;  ///< for reports
  std::variant<AllCells, CrossingSphere, CentroidShell, Box, NearPatch, Threshold, SizeOver, ErrorOver, BulkOf> rule;
  /// Cells that would not meet the criterion with this value in place of its own may be coarsened.
  std::optional<double> coarsen_below{};
};

/// What to mark: cells that meet any criterion and every limit.
struct Request {
  std::vector<Criterion> criteria;
  CellSize size = CellSize::cbrt_volume;
  std::optional<Exact<int>> max_level;
  std::vector<Cutoff> only_where;
  Exact<bool> coarsen_rest = false;  ///< cells that meet no criterion may be coarsened
  Exact<int> min_level = 0;          ///< cells of this level and below stay
  Exact<int> keep_for = 0;           ///< so many times a cell that may be coarsened stays, see `keep_for_a_while`

  /// Whether cells may be coarsened at all.
  bool coarsens() const;
};

/// An option and its argument, as given.
struct Given {
  std::string option;  ///< "--field"
  std::string text;    ///< empty for a flag
};

/// The options of a text as on a command line, "--size-over lambda --ratio 1 --max-level 2": those that `read_request`
/// knows; no name or argument may hold blanks. Throws `Error` for others, and for arguments that are missing or too
/// many.
std::vector<Given> split_options(const std::string& text);

/// The same criterion with another value in place of its own (threshold, ratio, error or fraction).
Criterion with_value(Criterion criterion, double value);

/// The request with every value by which cells are marked, and those by which they may be coarsened, made stricter by
/// this factor (above 1; looser below 1): a threshold is moved by factor - 1 times its size (1 if it is 0), a ratio or
/// a share of the mean error grows by it, a fraction of a bulk falls. Criteria without a value and limits stay.
Request scaled(Request request, double factor);

/// Reads the options, in the order in which they were given: `--layers`, `--above`, `--below`, `--ratio`,
/// `--theta`, `--target`, `--bulk` and `--error` belong to the nearest option of their kind (`--patch`, `--field`, ...)
/// before them that has none yet, else to the first after them; so does `--coarsen-below`, to any criterion with a
/// value. Throws `Error` for what cannot be read, for halves
/// without their other half, and when there is no criterion.
Request read_request(const std::vector<Given>& given);

}  // namespace pamr::mark
