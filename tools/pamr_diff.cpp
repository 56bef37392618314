// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "cli/run_tool.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/check/compare.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/validate/validate.hpp"

namespace {

using namespace pamr;

struct Options {
  std::string first, second;
  double tolerance = 0;
};

void declare(cli::CommandLine& line, Options& options) {
  line.option("A", options.first, "a mesh").required();
  line.option("B", options.second, "another mesh").required();
  line.option("--tolerance", options.tolerance,
              "by how much coordinates may differ (length unit), and field values, these times max(1, |value|); "
              "default 0: not at all")
      .not_negative();
}

mesh::DistMesh read_mesh(cli::Session& session, const std::string& file) {
  session.step("reading " + file);
  auto result = assemble::assemble(
      session.comm(), io::read_native(session.comm(), file, {.build_surfaces = false, .remark = session.remarks()}));
  validate::require_valid(session.comm(), result, file);
  return result;
}

nlohmann::json report_of(const check::Comparison& comparison) {
  auto differences = nlohmann::json::array();
  for (const auto& d : comparison.differences) {
    nlohmann::json item{{"what", d.what}, {"text", d.text}, {"count", d.count}, {"largest", d.largest}};
    if (d.first != invalid_global) item["first"] = d.first;
    differences.push_back(std::move(item));
  }
  return {{"same", comparison.differences.empty()},
          {"differences", std::move(differences)},
          {"notes", comparison.notes},
          {"fields", comparison.fields}};
}

cli::ExitCode run(cli::Session& session, const Options& options) {
  session.check_input(options.first);
  session.check_input(options.second);
  const auto first = read_mesh(session, options.first), second = read_mesh(session, options.second);
  session.step(fmt::format("comparing {} cells", first.info.n_global_cells));
  const auto comparison = check::compare_meshes(session.comm(), first, second, options.tolerance);
  session.write_report(report_of(comparison));
  if (!comparison.differences.empty()) {
    const auto more = comparison.differences.size() - 1;
    session.summary("different: " + comparison.differences.front().text +
                    (more > 0 ? fmt::format(" (and {} more differences)", more) : std::string()));
    return cli::ExitCode::failed;
  }
  std::string notes;
  for (const auto& note : comparison.notes) notes += "; " + note;
  session.summary(fmt::format("same mesh and fields: {} cells, {} nodes, {} fields{}", first.info.n_global_cells,
                              first.info.n_global_nodes, comparison.fields.size(), notes));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return pamr::cli::run_tool(
      argc, argv,
      {"pamr-diff", "Tells whether two files hold the same mesh and fields, whatever the order of nodes and cells.",
       "pamr-mesh --shape kuhn-cube --n 4 -o a.hdf && pamr-diff a.hdf a.hdf --tolerance 1e-12"},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return run(session, options); });
}
