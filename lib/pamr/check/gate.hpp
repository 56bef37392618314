// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace pamr::check {

/// A bound that a number of the report must keep.
struct Gate {
  enum class Kind { min, max };
  std::string text;  ///< as given on the command line
  std::string name;  ///< dotted path in the report ("mean_ratio.min", "inverted_cells")
  Kind kind = Kind::min;
  double bound = 0;
};

/// Reads `NAME:min:V` or `NAME:max:V`. Throws `Error` for anything else.
Gate parse_gate(const std::string& text);

/// Every number of a report with its dotted path, in the order of the report; true and false count as 1 and 0, what is
/// null as not a number. Histograms are left out.
std::vector<std::pair<std::string, double>> numbers_of(const nlohmann::json& report);

/// Says by how much the report misses the gate; empty when it passes. A metric's plain name stands for its `min` in a
/// gate of kind min, for its `max` in the other. Not a number passes no gate. Throws `Error` when the report has no
/// number of that name.
std::string why_failed(const Gate& gate, const std::vector<std::pair<std::string, double>>& numbers);

}  // namespace pamr::check
