// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/session.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "cli/output_file.hpp"
#include "cli/standard_output.hpp"
#include "cli/step_clock.hpp"
#include "cli/version_text.hpp"
#include "pamr/base/case_file.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/one_line.hpp"
#include "pamr/base/read_file.hpp"
#include "pamr/base/version.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/io/unfinished_name.hpp"

namespace pamr::cli {

namespace {

/// On rank 0 only, and with the same exception on every rank. Collective.
template <class Check>
void on_first(const par::Comm& comm, Check&& check) {
  par::agree(comm, [&] {
    if (comm.is_first()) check();
  });
}

/// Broken after commas and semicolons so that no line is longer than a wide terminal, as far as there are any.
std::string wrapped(std::string line) {
  constexpr std::size_t longest = 160;
  const std::string indent = "  ";
  for (std::size_t begin = 0; line.size() - begin > longest;) {
    auto end = std::max(line.rfind(", ", begin + longest - 1) + 1, line.rfind("; ", begin + longest - 1) + 1);
    if (end <= begin + indent.size())
      end = std::min(line.find(", ", begin + longest), line.find("; ", begin + longest)) + 1;
    if (end == 0 || end >= line.size()) break;
    line.replace(end, 1, "\n" + indent);
    begin = end + 1;
  }
  return line;
}

}  // namespace

Session::Session(const par::Comm& comm, std::string tool, CommonOptions options, BadFiles bad_files)
    : comm_(&comm), tool_(std::move(tool)), options_(std::move(options)), bad_files_(std::move(bad_files)) {
  if (!writes_report_file()) return;
  on_first(*comm_, [&] {
    require_replaceable(options_.json);
    if (!is_device(options_.json)) files_.add_output(options_.json);
  });
}

Session::~Session() {
  if (comm_->is_first()) hide_step();
}

void Session::check_input(const std::string& path) {
  on_first(*comm_, [&] {
    require_readable(path);
    require_named(path);
    add_input(path);
  });
}

void Session::keep(const std::string& path) {
  on_first(*comm_, [&] { add_input(path); });
}

void Session::add_input(const std::string& path) {
  if (const auto bad = bad_files_.find(path); bad != bad_files_.end()) throw Error(bad->second);
  files_.add_input(path);
}

std::string Session::read_case(const std::string& path) {
  std::string text;
  on_first(*comm_, [&] {
    require_readable(path);
    if (std::filesystem::is_directory(path)) throw Error(path + ": expected a file, found a folder");
    add_input(path);
    auto found = read_file(path);
    if (!found) throw Error(path + ": expected a file that can be read");
    text = std::move(*found);
    for (const auto& file : files_of_case(text, path)) add_input(file);
  });
  return comm_->broadcast(text);
}

void Session::check_output(const std::string& path, bool force, const std::string& may_replace) {
  on_first(*comm_, [&] {
    if (path.empty()) throw Error("expected the name of an output file, found an empty name");
    files_.add_output(path, may_replace);
    require_writable(path, force || (!may_replace.empty() && is_same_file(path, may_replace)));
  });
  remove_leftovers(path);
}

void Session::check_native_output(const std::string& path, bool force) {
  constexpr std::array others{".vtk", ".pvtu", ".xdmf", ".csv", ".json", ".png", ".html", ".toml"};
  const auto extension = std::filesystem::path(path).extension().string();
  if (io::is_foreign_name(path) || std::find(others.begin(), others.end(), extension) != others.end())
    throw Error(path + ": this output is a native mesh: expected a name that ends in .hdf, found " + extension +
                " (pamr-convert writes other formats)");
  check_output(path, force);
}

void Session::check_series(const SeriesName& series, std::uint64_t first, bool force, const std::string& may_replace) {
  on_first(*comm_, [&] {
    files_.add_series(series, may_replace);
    require_replaceable(series(first));
    io::remove_leftovers(
        std::filesystem::path(series(first)).parent_path(),
        [&](const std::string& name, bool is_cut) { return !is_cut && is_file_of(series, name); }, files_.inputs());
    if (const auto found = existing_files(series, first); !found.empty()) require_writable(found.front(), force);
  });
}

void Session::check_folder(const std::string& path) {
  on_first(*comm_, [&] { files_.add_folder(path); });
  remove_leftovers(path);
}

void Session::remove_leftovers(const std::string& path) const {
  if (comm_->is_first()) io::remove_leftovers(path, files_.inputs());
}

void Session::summary(const std::string& line) const {
  if (options_.quiet || !comm_->is_first()) return;
  hide_step();
  const auto text = wrapped(one_line(line)) + "\n";
  if (options_.json != "-") {
    print(text);
    return;
  }
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

void Session::warn(const std::string& line) const { say("warning", line); }

void Session::note(const std::string& line, const std::vector<std::string>& lines_to_copy) const {
  if (options_.quiet) return;
  say("note", line);
  if (!comm_->is_first()) return;
  for (const auto& copy : lines_to_copy) std::fputs(("  " + one_line(copy) + "\n").c_str(), stderr);
  std::fflush(stderr);
}

void Session::complain(const std::string& line) const { say("error", line); }

void Session::say(const char* what, const std::string& line) const {
  if (!comm_->is_first()) return;
  hide_step();
  std::fputs((tool_ + ": " + what + ": " + one_line(line) + "\n").c_str(), stderr);
  std::fflush(stderr);
}

std::function<void(const std::string&)> Session::remarks() const {
  return [this](const std::string& remark) { warn(remark); };
}

void Session::step(const std::string& what) const {
  if (comm_->is_first() && !options_.quiet) show_step(what);
}

Progress Session::progress(const std::string& what, std::int64_t total, const std::string& unit,
                           std::int64_t before) const {
  return {what, total, unit, comm_->is_first() && !options_.quiet, before};
}

void Session::write_report(const nlohmann::json& report) const {
  if (!wants_report()) return;
  on_first(*comm_, [&] {
    nlohmann::ordered_json whole;
    whole["report"] = {{"tool", tool_},
                       {"version", std::string(version())},
                       {"commit", commit_of_sources()},
                       {"format", report_format},
                       {"inputs", files_.inputs()}};
    for (const auto& [key, value] : report.items()) whole[key] = value;
    // File names need not be UTF-8; JSON must be.
    const auto text = whole.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (options_.json != "-") return write_whole(options_.json, text);
    if (!print(text)) throw Error("standard output: the report cannot be written");
  });
}

}  // namespace pamr::cli
