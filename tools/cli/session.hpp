// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/check_in_child.hpp"
#include "cli/files.hpp"
#include "cli/progress.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::cli {

/// Exit codes of all tools.
enum class ExitCode : int {
  done = 0,
  failed = 1,       ///< a check or gate failed, or no convergence
  bad_input = 2,    ///< usage, file, option: `pamr::Error`
  internal = 3,     ///< a defect, or a resource ran out
  interrupted = 6,  ///< interrupted after a checkpoint was written
};

/// Number of the form of all reports, `report.format` in them; a key that changes its meaning makes it larger.
inline constexpr int report_format = 1;

/// What every tool was asked for on its command line.
struct CommonOptions {
  std::string json;    ///< file of the report, "-" for standard output, empty for none
  bool quiet = false;  ///< neither progress nor summary
};

/// One run of a tool: its processes, its common options, and the way to speak to the user.
class Session {
 public:
  /// `bad_files`: what is wrong with files that may be inputs, by name (`check_named_files`); only those of rank 0
  /// count. Throws `Error` when the report could not be written. Collective.
  Session(const par::Comm& comm, std::string tool, CommonOptions options, BadFiles bad_files = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  Session(Session&&) = delete;
  Session& operator=(Session&&) = delete;

  const par::Comm& comm() const { return *comm_; }
  const CommonOptions& options() const { return options_; }

  /// What the run reads and writes, to be stated before work starts: first all inputs, then all outputs. Each of these
  /// throws `Error` if an output, that of --json included, is an input or another output under any name (`Files`).
  /// Collective; rank 0 decides.
  ///
  /// An existing file or folder that can be read. Inputs that a child process found bad are refused here and in the
  /// next two.
  void check_input(const std::string& path);
  /// An input that need not be there, or that has been found already.
  void keep(const std::string& path);
  /// `check_input` for a case file and all files that it names. Yields its text.
  std::string read_case(const std::string& path);
  /// An output. Throws `Error` also if it exists and `force` is not given, if it is no regular file, or if its folder
  /// is missing or cannot be written. Removes what killed runs have left of it. `may_replace`: an input that it may be,
  /// without `force`, or empty.
  void check_output(const std::string& path, bool force, const std::string& may_replace = {});
  /// The same for an output in the native format; refuses a name that ends as those of other formats do.
  void check_native_output(const std::string& path, bool force);
  /// The same for outputs whose numbers are not known yet. Throws `Error` also if one with number `first` or more
  /// exists and `force` is not given.
  void check_series(const SeriesName& series, std::uint64_t first, bool force, const std::string& may_replace = {});
  /// A folder that will be replaced with everything in it.
  void check_folder(const std::string& path);
  /// Removes what killed runs have left of an output. Local; rank 0 removes.
  void remove_leftovers(const std::string& path) const;

  /// One line on standard output (standard error where the report goes to standard output), by rank 0. Where it is
  /// longer than 160 characters it goes on in the next line, after a comma or semicolon, indented. Local.
  void summary(const std::string& line) const;
  /// A remark that the user should see even with --quiet: one line on standard error, by rank 0. Local.
  void warn(const std::string& line) const;
  /// Something to know that is no trouble, on standard error by rank 0, with lines to copy below it. Not with --quiet.
  /// Local.
  void note(const std::string& line, const std::vector<std::string>& lines_to_copy = {}) const;
  /// `warn` for `io::ReadOptions::remark`, to be used no longer than this session.
  std::function<void(const std::string&)> remarks() const;
  /// The same for what makes the exit code 1: a check or gate that fails. Local.
  void complain(const std::string& line) const;
  /// Names the work that begins now: "refining 59971 cells". If it takes long, rank 0 says so on standard error
  /// (`show_step`), unless --quiet is given. Local.
  void step(const std::string& what) const;
  /// Progress of `total` units of work (below zero: not known), of which `before` are done; silent with --quiet and on
  /// ranks other than 0. Local.
  Progress progress(const std::string& what, std::int64_t total, const std::string& unit,
                    std::int64_t before = 0) const;
  /// Whether --json asks for a report. The same on all ranks.
  bool wants_report() const { return !options_.json.empty(); }
  /// Writes the report where --json says (an existing file is replaced), all or nothing; nothing without --json. NaN
  /// and infinity become null. Before the keys of `report`, an object, stands `report`: tool, version, commit, format
  /// and inputs (those that were stated above, as given). Only rank 0's `report` counts. Collective; throws `Error`.
  void write_report(const nlohmann::json& report) const;

 private:
  void add_input(const std::string& path);
  void say(const char* what, const std::string& line) const;
  bool writes_report_file() const { return !options_.json.empty() && options_.json != "-"; }

  const par::Comm* comm_;
  std::string tool_;
  CommonOptions options_;
  BadFiles bad_files_;
  Files files_;  ///< on rank 0
};

}  // namespace pamr::cli
