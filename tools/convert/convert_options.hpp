// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "cli/run_tool.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/io/interfaces.hpp"

namespace pamr::convert {

/// What pamr-convert is asked for.
struct Options {
  std::string input, output, surfaces, cad, unit = geometry::usual_cad_unit, gmsh_version = "4.1", solution_in,
                                            solution_out;
  std::vector<std::string> ties, surface_files, patches, kinds, solution_fields;
  std::vector<std::vector<double>> creases;
  double tolerance = -1, feature_angle = -1, scale = 1;
  int format = io::newest_format, order = 1;
  bool asks_version = false, asks_format = false, asks_unit = false, recognize = false, as_level0 = false,
       repair = false, no_repair = false, strict = false, split_prisms = false, weld = false, text = false,
       interfaces = false, force = false;
  const io::Format *from = nullptr, *to = nullptr;  ///< of input and output, set after the command line is read
};

/// Declares the options of the command line, which are put into `options`.
void declare(cli::CommandLine& line, Options& options);

bool brings_surfaces(const Options& options);
/// Whether the surfaces of the mesh are looked at, not only handed on.
bool asks_for_surfaces(const Options& options);
io::Interfaces interfaces_of(const Options& options);

/// Checks what can be checked before a mesh is read. Yields the text of `surfaces`, if it is given. Collective; throws
/// the same `Error` on every rank.
std::string check_files(cli::Session& session, const Options& options);

}  // namespace pamr::convert
