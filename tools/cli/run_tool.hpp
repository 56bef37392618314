// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "cli/check_in_child.hpp"
#include "cli/command_line.hpp"
#include "cli/session.hpp"

namespace pamr::cli {

/// What a tool says about itself.
struct ToolInfo {
  std::string name;     ///< as installed: "pamr-refine"
  std::string purpose;  ///< one sentence for --help
  std::string example;  ///< command lines for --help, one a line
  /// Input files that a file of the command line names, if it may name some of HDF5 or CAD.
  FilesIn files_in = nullptr;
  bool fuses_solids = false;  ///< of CAD files
};

/// The whole life of a tool: has a child look at the files of the command line, starts MPI, reads the command line,
/// runs `work`, and turns what happened into the exit code, the same on every rank. To be the only statement of `main`
/// other than the options' declaration.
///
/// `declare` adds the tool's own options and arguments; --help, --version, --json and --quiet are there already. It
/// runs on every rank and must not communicate. `work` runs on every rank after the command line was read and returns
/// `ExitCode::done` or `ExitCode::failed` (a gate).
///
/// Exit codes: what `work` returned; 2 for bad usage and for `pamr::Error`; 3 for any other exception. An error is
/// printed once, by one rank, on standard error as `<name>: error: <text>`. Nothing hangs: when the other ranks do not
/// end too (30 s after an `Error`, 3 s after another exception), this rank prints its error and ends them all. Ranks
/// that are started with different arguments, in different folders or from different versions all end with one error.
/// SIGINT, SIGTERM, SIGHUP and SIGUSR1 remove what is unfinished (`Session::check_output`), say so, and end the process
/// with exit code 6, unless all ranks have ended their work: then they change nothing, and a crash of MPI or another
/// library while it ends is a warning. A summary that cannot be written is an error. So `work` lets exceptions pass;
/// they are the way to end early.
///
/// A whole tool (`#include "cli/run_tool.hpp"`; link `pamr_cli`):
///
///     int main(int argc, char** argv) {
///       std::string input, output;
///       int layers = 1;
///       bool force = false;
///       return pamr::cli::run_tool(
///           argc, argv, {"pamr-peel", "Removes layers of cells.", "pamr-peel box.hdf -o core.hdf --layers 2"},
///           [&](pamr::cli::CommandLine& line) {
///             line.option("MESH", input, "mesh to read").required();
///             line.option("-o,--output", output, "mesh to write").required();
///             line.option("--layers", layers, "layers to remove").positive();
///             line.flag("--force", force, pamr::cli::force_help);
///           },
///           [&](pamr::cli::Session& session) {
///             session.check_input(input);
///             session.check_output(output, force);  // before any work; removes what is unfinished on SIGTERM
///             auto mesh = pamr::io::read_mesh(session.comm(), input);
///             pamr::cli::Progress progress = session.progress("peeling", layers, "layers");
///             for (int i = 0; i < layers; ++i) {
///               peel(session.comm(), mesh);
///               progress.update(i + 1);
///             }
///             pamr::io::write_mesh(session.comm(), output, mesh);
///             session.write_report({{"cells", mesh.n_global_cells}});  // --json
///             session.summary(fmt::format("{} cells -> {}", mesh.n_global_cells, output));
///             return pamr::cli::ExitCode::done;
///           });
///     }
int run_tool(int argc, char** argv, const ToolInfo& info, const std::function<void(CommandLine&)>& declare,
             const std::function<ExitCode(Session&)>& work);

/// Help text of the flag that every tool with an output file has.
inline constexpr const char* force_help = "replace the output file when it exists";
inline constexpr const char* format_help =
    "number of the native format to write, at most; 2 has no place for the map of level 0 at coarse walls; 1 is for "
    "readers of version 0.2 and older and has no place for closure families other than 1:2 and 1:4 either";

}  // namespace pamr::cli
