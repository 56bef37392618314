// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "solvers/dsmc/run/computation.hpp"
#include "solvers/dsmc/sampling/cell_resolution.hpp"

namespace pamr::dsmc {

/// Files of a computation; empty names are not written.
struct OutputFiles {
  std::string mesh;     ///< the mesh with the averaged flow as cell fields
  std::string surface;  ///< averages on the walls, VTU
  std::string lines;    ///< averages at stations, lines and planes, CSV
  std::string history;  ///< CSV
};

/// Writes `text` of rank 0 to a file, as a whole or not at all. Collective.
using WriteText = std::function<void(const std::string& file, const std::string& text)>;

/// Averages the flow, puts the averages on the mesh as cell fields and writes what is asked for. Returns how well the
/// cells resolve the flow. Collective. Throws `Error` when a file cannot be written.
CellResolution write_output(Computation& computation, const OutputFiles& files, const WriteText& write_text);

/// Writes the mesh as it is now with the averages of the window so far; the computation stays as it is. Collective.
/// Throws `Error` when the file cannot be written.
void write_window(Computation& computation, const std::string& file);

/// A sentence for each station, line and plane of the case that has no row in the text of `OutputFiles::lines`. Local.
std::vector<std::string> warnings_of_lines(const Case& the_case, const std::string& text);

}  // namespace pamr::dsmc
