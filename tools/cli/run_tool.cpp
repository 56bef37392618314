// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/run_tool.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "cli/help_format.hpp"
#include "cli/interrupt.hpp"
#include "cli/standard_output.hpp"
#include "cli/step_clock.hpp"
#include "cli/version_text.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/heap.hpp"
#include "pamr/base/nearest_word.hpp"
#include "pamr/io/complete_outputs.hpp"
#include "pamr/io/remove_on_interrupt.hpp"
#include "pamr/par/runtime.hpp"
#include "pamr/par/same_start.hpp"

namespace pamr::cli {

namespace {

constexpr const char* exit_codes_help =
    "Exit codes: 0 done; 1 a check or gate failed; 2 bad usage or bad input; 3 internal failure; 6 interrupted.";
constexpr const char* ranks_help = "Runs alone or as `mpirun -n P ...`; the result does not depend on P.";
constexpr const char* common_group = "Options of all tools";

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

/// Of a tool with commands of which none was named: says so, and which was meant. Empty where there is no need.
std::string missing_command(const CLI::App& app) {
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  if (commands.empty() || !app.get_subcommands().empty()) return "";
  std::vector<std::string> names;
  std::string list;
  for (const auto* command : commands) {
    names.push_back(command->get_name());
    list += (list.empty() ? "" : ", ") + names.back();
  }
  const auto text = "expected a command (" + list + "), found ";
  const auto extras = app.remaining();
  if (extras.empty()) return text + "none";
  if (extras[0].starts_with("-")) return "";
  const auto near = nearest_word(extras[0], names);
  return text + "'" + extras[0] + "'; did you mean `" + app.get_name() + " " +
         (near ? *near : names[0] + " " + extras[0]) + "`?";
}

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

/// The options of all tools, in the last group of --help.
void declare_common(CLI::App& app, const ToolInfo& info, CommonOptions& options) {
  app.option_defaults()->group(common_group);
  app.add_option("--json", options.json, "write a report in JSON to this file, - for standard output")
      ->type_name("FILE");
  app.add_flag("--quiet", options.quiet, "neither progress nor summary");
  app.set_version_flag(
      "--version", [&] { return version_text(info.name); }, "print the versions of tool and libraries and end");
  for (auto* of : app.get_subcommands({}))
    of->set_help_flag("-h,--help", "print this text and end")->group(common_group);
  app.set_help_flag("-h,--help", "print this text and end");
}

/// Reads the command line into `options` and what `declare` names; prints --help and --version if it `speaks`.
Parsed parse(int argc, char** argv, const ToolInfo& info, const std::function<void(CommandLine&)>& declare,
             CommonOptions& options, bool speaks) {
  CLI::App app(info.purpose, info.name);
  const auto width = help_width();
  app.formatter(help_format(width));
  app.footer("Examples:\n" + example_lines(info.example, width) + "\n" + wrapped(exit_codes_help, width) + "\n" +
             wrapped(ranks_help, width));
  CommandLine line(app);
  declare(line);
  declare_common(app, info, options);
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::Success& wanted) {  // --help, --version
    std::ostringstream text, none;
    app.exit(wanted, text, none);
    if (speaks) print(text.str());
    return {false, {}};
  } catch (const CLI::ParseError& wrong) {
    const auto no_command = missing_command(app);
    const auto unknown = no_command.empty()
                             ? unknown_argument(app)
                             : no_command;  // said first: a misspelt option may be the one that is missed
    return {false,
            {ExitCode::bad_input, (unknown.empty() ? wrong.what() : unknown) + (" (see " + info.name + " --help)")}};
  }
}

/// An ending without an error, unless a summary or a help text has not arrived where it was sent.
Ending with_output(Ending ending) {
  const auto trouble = trouble_of_output();
  if (!ending.error.empty() || trouble.empty()) return ending;
  return {ExitCode::bad_input, "standard output: not all that was printed could be written: " + trouble};
}

/// From the command line to the end of the work; files are complete, or gone.
Ending run(const par::Runtime& runtime, int argc, char** argv, const ToolInfo& info,
           const std::function<void(CommandLine&)>& declare, const std::function<ExitCode(Session&)>& work,
           const BadFiles& bad_files) {
  try {
    const par::Comm comm(runtime.world());
    par::require_same_start(comm, par::start_of(version_text(info.name), argc, argv));
    CommonOptions options;
    const auto parsed = parse(argc, argv, info, declare, options, comm.is_first());
    if (!parsed.proceed) return with_output(parsed.ending);
    Session session(comm, info.name, options, bad_files);
    return with_output({work(session), {}});
  } catch (const Error& error) {
    return {ExitCode::bad_input, error.what()};
  }
}

}  // namespace

int run_tool(int argc, char** argv, const ToolInfo& info, const std::function<void(CommandLine&)>& declare,
             const std::function<ExitCode(Session&)>& work) {
  keep_standard_streams();
  guard_exit_code();
  set_up_heap();
  const auto bad_files =
      check_named_files(argc, argv, info.files_in, info.fuses_solids);  // no process of an MPI job forks
  par::Runtime runtime(argc, argv);
  const auto clean_up = [] {
    be_silent_on_interrupt();  // mpirun ends the ranks that are not the first to leave with an error
    io::remove_unfinished();
  };
  runtime.on_failure(
      {info.name, [] { return std::string(io::complete_outputs()); }, clean_up, hide_step, announce_abort});
  end_well_on_interrupt(info.name, runtime.rank() == 0, runtime.size() > 1);
  tell_of_crash(info.name);
  // A file beyond `ulimit -f`, and a reader of standard output that has left, are errors of the write, which names
  // them.
  for (const int signal : {SIGXFSZ, SIGPIPE}) std::signal(signal, SIG_IGN);

  const auto ending = run(runtime, argc, argv, info, declare, work, bad_files);
  constexpr double patience_after_error = 30, for_ever = std::numeric_limits<double>::infinity();
  const int code =
      runtime.end(static_cast<int>(ending.code), ending.error, ending.error.empty() ? for_ever : patience_after_error);
  // What happens to the process later changes nothing that it has done.
  keep_outcome(info.name, code, code >= static_cast<int>(ExitCode::bad_input));
  return code;
}

}  // namespace pamr::cli
