// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/output_file.hpp"
#include "cli/run_tool.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/check/extract.hpp"
#include "pamr/check/gate.hpp"
#include "pamr/check/mesh_view.hpp"
#include "pamr/check/quality_report.hpp"
#include "pamr/check/report_text.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/validate/validate.hpp"
#include "report/html_report.hpp"

namespace {

using namespace pamr;

struct Options {
  std::vector<std::string> meshes, gates;
  std::string csv, html, worst_out;
  std::int64_t worst = 0;
  double tolerance = check::QualityOptions{}.off_surface_tolerance;
  bool force = false;
};

void declare(cli::CommandLine& line, Options& options) {
  line.option("MESH", options.meshes, "meshes to measure; several are compared in a table").required();
  line.option("--gate", options.gates,
              "NAME:min:V or NAME:max:V, exit 1 unless the number keeps the bound; NAME is a path in the report, "
              "such as mean_ratio.min, inverted_cells, patches.sphere.worst_distance")
      .one_at_a_time();
  line.option("--csv", options.csv, "write the numbers here, a line a mesh").file_ending(".csv");
  line.option("--html", options.html, "write a page here that shows the meshes; any browser opens it without network")
      .file_ending(".html");
  line.option("--worst", options.worst, "write the N cells of lowest mean ratio as a mesh").positive();
  line.option("--worst-out", options.worst_out, "that mesh (.hdf)").type_name("FILE");
  line.option("--off-surface", options.tolerance,
              "distance beyond which a boundary node is off its surface, as a part of the bounding box's diagonal")
      .not_negative()
      .show_default();
  line.flag("--force", options.force, cli::force_help);
}

void check_files(cli::Session& session, const Options& options) {
  if ((options.worst > 0) != !options.worst_out.empty())
    throw Error(std::string("expected --worst N and --worst-out FILE together, found only ") +
                (options.worst > 0 ? "--worst" : "--worst-out"));
  if (options.worst > 0 && options.meshes.size() > 1)
    throw Error(fmt::format("expected one mesh with --worst, found {}", options.meshes.size()));
  for (const auto& file : options.meshes) session.check_input(file);
  for (const auto& file : {options.csv, options.html})
    if (!file.empty()) session.check_output(file, options.force);
  if (!options.worst_out.empty()) session.check_native_output(options.worst_out, options.force);
}

void write_html(const par::Comm& comm, const std::string& file, const std::vector<report::ReportedMesh>& meshes) {
  par::agree(comm, [&] {
    if (comm.is_first()) cli::write_whole(file, report::html_report(meshes));
  });
}

nlohmann::json whole_report(const std::vector<check::NamedReport>& reports) {
  if (reports.size() == 1) return check::to_json(reports.front().report);
  nlohmann::json json{{"meshes", nlohmann::json::array()}};
  for (const auto& named : reports) {
    json["meshes"].push_back(check::to_json(named.report));
    json["meshes"].back()["file"] = named.file;
  }
  return json;
}

cli::ExitCode run(cli::Session& session, const Options& options) {
  std::vector<check::Gate> gates;
  for (const auto& text : options.gates) gates.push_back(check::parse_gate(text));
  check_files(session, options);

  const auto& comm = session.comm();
  std::vector<check::NamedReport> reports;
  std::vector<report::ReportedMesh> pictured;
  std::vector<std::string> complaints;
  for (const auto& file : options.meshes) {
    session.step("reading " + file);
    const auto mesh =
        assemble::assemble(comm, io::read_native(comm, file, {.turn_inverted = false, .remark = session.remarks()}));
    validate::require_size(comm, mesh, file);
    session.step(fmt::format("measuring {}, {} cells", file, mesh.info.n_global_cells));
    reports.push_back({file, check::report_quality(comm, mesh, {options.tolerance})});
    if (!options.html.empty()) {
      const double distance = options.tolerance * reports.back().report.bounding_box_diagonal;
      const auto limits = report::limits_of_one(options.meshes.size());
      pictured.push_back({reports.back(), check::view_mesh(comm, mesh, distance, limits)});
    }
    const auto faults = check::faults_of(reports.back());
    complaints.insert(complaints.end(), faults.begin(), faults.end());
    const auto numbers = check::numbers_of(check::to_json(reports.back().report));
    for (const auto& gate : gates)
      if (const auto reason = with_file_name(file, [&] { return check::why_failed(gate, numbers); }); !reason.empty())
        complaints.push_back(file + ": " + reason);
    if (options.worst > 0)
      io::write_native(comm, options.worst_out,
                       check::extract_cells(comm, mesh, check::worst_cells(comm, mesh, options.worst)));
  }

  if (!options.csv.empty()) cli::write_whole(comm, options.csv, check::to_csv(reports));
  if (!options.html.empty()) {
    session.step("writing " + options.html);
    write_html(comm, options.html, pictured);
  }
  session.write_report(whole_report(reports));
  if (reports.size() == 1) {
    session.summary(check::summary_of(reports.front()));
    for (const auto& line : check::region_lines(reports.front().report)) session.summary(line);
    for (const auto& line : check::patch_lines(reports.front().report)) session.summary(line);
  } else {
    for (const auto& line : check::table_of(reports)) session.summary(line);
  }
  for (const auto& complaint : complaints) session.complain(complaint);
  return complaints.empty() ? cli::ExitCode::done : cli::ExitCode::failed;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return pamr::cli::run_tool(
      argc, argv,
      {"pamr-quality",
       "Measures meshes: invariants, cell shapes, patches, fingerprint; exit 1 when an invariant or a gate fails.",
       "pamr-mesh --shape kuhn-cube --n 4 -o a.hdf && pamr-quality a.hdf --gate mean_ratio:min:0.2 --json -"},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return run(session, options); });
}
