// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/run_tool.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "cli/interrupt.hpp"
#include "cli/standard_output.hpp"
#include "cli/step_clock.hpp"
#include "cli/version_text.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/heap.hpp"
#include "pamr/base/nearest_word.hpp"
#include "pamr/base/one_line.hpp"
#include "pamr/io/remove_on_interrupt.hpp"
#include "pamr/par/runtime.hpp"
#include "pamr/par/same_start.hpp"

namespace pamr::cli {

namespace {

constexpr const char* exit_codes_help =
    "Exit codes: 0 done; 1 a check or gate failed; 2 bad usage or bad input; 3 internal failure; 6 interrupted.\n"
    "Runs alone or as `mpirun -n P ...`; the result does not depend on P.";

/// How this rank's part ended.
struct Ending {
  ExitCode code = ExitCode::done;
  std::string error;
};

/// What the command line asks for: work, or an end without it.
struct Parsed {
  bool proceed = true;
  Ending ending;
};

/// An argument that nothing takes, and the option that may have been meant: the most alike, or the one that has its
/// name as a part (--sphere: --crossing-sphere). Empty if every argument was taken.
std::string unknown_argument(const CLI::App& app) {
  const auto extras = app.remaining();
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word[0] == '-'; };
  auto word = std::find_if(extras.begin(), extras.end(), is_option);
  if (word == extras.end()) return extras.empty() ? "" : "unexpected argument '" + extras.back() + "'";
  const auto name = word->substr(0, word->find('='));
  std::vector<std::string> known;
  for (const auto* option : app.get_options())
    for (const auto& of_it : option->get_lnames()) known.push_back("--" + of_it);
  auto near = nearest_word(name, known);
  constexpr std::size_t shortest_part = 5;
  if (const auto part = name.substr(name.find_first_not_of('-')); !near && part.size() >= shortest_part)
    for (const auto& candidate : known)
      if (candidate.find(part) != std::string::npos) near = candidate;
  return "unknown option " + name + (near ? "; did you mean " + *near + "?" : "");
}

/// Reads the command line into `options` and what `declare` names; prints --help and --version if it `speaks`.
Parsed parse(int argc, char** argv, const ToolInfo& info, const std::function<void(CommandLine&)>& declare,
             CommonOptions& options, bool speaks) {
  CLI::App app(info.purpose, info.name);
  app.set_help_flag("-h,--help", "print this text and end");
  app.set_version_flag(
      "--version", [&] { return version_text(info.name); }, "print the versions of tool and libraries and end");
  app.add_option("--json", options.json, "write a report in JSON to this file, - for standard output")
      ->type_name("FILE");
  app.add_flag("--quiet", options.quiet, "neither progress nor summary");
  app.footer("Example:\n  " + info.example + "\n\n" + exit_codes_help);
  CommandLine line(app);
  declare(line);
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::Success& wanted) {  // --help, --version
    std::ostringstream text, none;
    app.exit(wanted, text, none);
    if (speaks) print(text.str());
    return {false, {}};
  } catch (const CLI::ParseError& wrong) {
    const auto unknown = unknown_argument(app);  // said first: a misspelt option may be the one that is missed
    return {false,
            {ExitCode::bad_input, (unknown.empty() ? wrong.what() : unknown) + (" (see " + info.name + " --help)")}};
  }
}

void print_error(const ToolInfo& info, const std::string& error, const std::string& where) {
  hide_step();
  std::fputs((info.name + ": error: " + one_line(error) + where + "\n").c_str(), stderr);
  std::fflush(nullptr);
}

/// What the handler of unexpected exceptions needs; set once, before any work.
const par::Runtime* running = nullptr;
const ToolInfo* running_tool = nullptr;

/// Ends this rank's part: prints the error once if all ranks end within `grace_period` seconds, here otherwise, in
/// which case all are ended. Returns the common exit code. What happens to the process later changes nothing that it
/// has done: where it could still end in another way, that is said.
int end(const Ending& ending, double grace_period) {
  if (!ending.error.empty()) {
    be_silent_on_interrupt();  // mpirun ends the ranks that are not the first to leave with an error
    io::remove_unfinished();
  }
  const auto outcome = running->settle(static_cast<int>(ending.code), grace_period);
  if (!outcome) {
    print_error(*running_tool, ending.error, " (on rank " + std::to_string(running->rank()) + ")");
    announce_abort();
    running->abort(static_cast<int>(ending.code));
  }
  const bool is_complete = outcome->code < static_cast<int>(ExitCode::bad_input);
  if (is_complete) keep_outcome(running_tool->name, outcome->code);
  if (outcome->reporter == running->rank() && !ending.error.empty()) print_error(*running_tool, ending.error, "");
  return outcome->code;
}

/// An exception nobody expects is not caught, because destructors on its way could wait for ranks that never come.
[[noreturn]] void end_after_failure() {
  constexpr double grace_period = 3;
  Ending ending{ExitCode::internal, "ended without an exception"};
  try {
    if (const auto failure = std::current_exception()) std::rethrow_exception(failure);
  } catch (const std::bad_alloc&) {
    ending.error = "out of memory";
  } catch (const std::exception& failure) {
    ending.error = std::string("internal: ") + failure.what();
  } catch (...) {
    ending.error = "internal: exception of an unknown type";
  }
  const int code = end(ending, grace_period);
  announce_abort();
  (void)running->settle(code, 1);  // whoever aborts first takes the others with it: not before one has reported
  running->abort(code);
}

/// An ending without an error, unless a summary or a help text has not arrived where it was sent.
Ending with_output(Ending ending) {
  const auto trouble = trouble_of_output();
  if (!ending.error.empty() || trouble.empty()) return ending;
  return {ExitCode::bad_input, "standard output: not all that was printed could be written: " + trouble};
}

/// From the command line to the end of the work; files are complete, or gone.
Ending run(int argc, char** argv, const std::function<void(CommandLine&)>& declare, const BadFiles& bad_files,
           const std::function<ExitCode(Session&)>& work) {
  try {
    const par::Comm comm(running->world());
    par::require_same_start(comm, par::start_of(version_text(running_tool->name), argc, argv));
    CommonOptions options;
    const auto parsed = parse(argc, argv, *running_tool, declare, options, comm.is_first());
    if (!parsed.proceed) return with_output(parsed.ending);
    Session session(comm, running_tool->name, options, bad_files);
    return with_output({work(session), {}});
  } catch (const Error& error) {
    return {ExitCode::bad_input, error.what()};
  }
}

}  // namespace

int run_tool(int argc, char** argv, const ToolInfo& info, const std::function<void(CommandLine&)>& declare,
             const std::function<ExitCode(Session&)>& work) {
  set_up_heap();
  const auto bad_files = check_named_files(argc, argv, info.files_in);  // no process of an MPI job forks
  const par::Runtime runtime(argc, argv);
  running = &runtime;
  running_tool = &info;
  std::set_terminate(end_after_failure);
  end_well_on_interrupt(info.name, runtime.rank() == 0, runtime.size() > 1);
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond `ulimit -f` is an error of the write, which names it

  const auto ending = run(argc, argv, declare, bad_files, work);
  constexpr double patience_after_error = 30, for_ever = std::numeric_limits<double>::infinity();
  return end(ending, ending.error.empty() ? for_ever : patience_after_error);
}

}  // namespace pamr::cli
