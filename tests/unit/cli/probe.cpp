// SPDX-License-Identifier: GPL-3.0-or-later
/// A tool that behaves or misbehaves on request, for the test of the life of a tool.
#include <mpi.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "cli/output_file.hpp"
#include "cli/run_tool.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/partial_file.hpp"
#include "pamr/io/shared_output.hpp"

namespace {

using pamr::cli::ExitCode;
using pamr::cli::Session;

void misbehave(const std::string& how, const pamr::par::Comm& comm) {
  const bool is_last = comm.rank() == comm.size() - 1;
  if (how == "wild-error")
    throw pamr::Error("expected a word, found \x1b[31m red \r\n and \x7f \xc2\x9b 2J, caf\xc3\xa9");
  if (how == "agreed-error")
    pamr::par::agree(comm, [&] {
      if (is_last) throw pamr::Error("cell 7: expected a positive volume, found -1");
    });
  if (how == "failure-everywhere") PAMR_ENSURES(comm.size() == 0);
  if (how == "failure-on-one" && is_last) throw std::out_of_range("slot 12 of 4");
  if (how == "memory-on-one" && is_last) throw std::bad_alloc();
  if (how == "failure-on-one") comm.barrier();
  if (how == "memory-on-one") comm.barrier();
}

/// The signal that MPI_Finalize comes to; 0: none.
int signal_at_end = 0;
/// The code that it returns, whatever it does.
int code_at_end = MPI_SUCCESS;

struct sigaction heard_at_once {};

extern "C" void hear(int signal) {
  const timespec while_others_work{0, 100'000'000};
  (void)::nanosleep(&while_others_work, nullptr);
  heard_at_once.sa_handler(signal);
}

/// As on a machine that has no time for this rank.
void hear_late() {
  struct sigaction late {};
  late.sa_handler = hear;
  ::sigaction(SIGTERM, &late, &heard_at_once);
}

/// Between the moment at which the output has its name and the end of the work.
void misbehave_behind_output(const std::string& how, const pamr::par::Comm& comm) {
  const bool is_last = comm.rank() == comm.size() - 1;
  if (how == "error-behind") pamr::par::agree(comm, [] { throw pamr::Error("expected a report, found none"); });
  if (how == "failure-behind" && is_last) throw std::out_of_range("slot 12 of 4");
  if (how == "crash-behind" && is_last) (void)std::raise(SIGSEGV);
  if (how == "sleep-behind") std::this_thread::sleep_for(std::chrono::seconds(600));
  if (how.ends_with("-behind")) comm.barrier();
}

/// Behind the work, or `...-of-error` behind an error of all ranks.
void misbehave_at_end(const std::string& how) {
  if (how.starts_with("crash-at-end")) signal_at_end = SIGSEGV;
  if (how == "interrupt-at-end") signal_at_end = SIGTERM;
  if (how.starts_with("crash-at-exit")) std::atexit([] { (void)std::raise(SIGSEGV); });
  if (how == "error-at-end") code_at_end = MPI_ERR_OTHER;
  if (how.starts_with("code-at-exit")) std::atexit([] { std::exit(7); });
  if (how.ends_with("-of-error")) throw pamr::Error("expected a report, found none");
}

ExitCode work(Session& session, const std::string& input, const std::string& output, bool force,
              const std::string& how) {
  if (!input.empty()) session.check_input(input);
  if (!output.empty()) session.check_output(output, force);
  misbehave(how, session.comm());
  if (how == "sleep" || how == "sleep-deeply") {
    if (how == "sleep-deeply" && session.comm().is_first()) hear_late();
    pamr::io::PartialFile file(output);
    if (session.comm().is_first()) (void)file.make(100);
    file.share(session.comm());
    std::this_thread::sleep_for(std::chrono::seconds(600));
  }
  if (!output.empty()) {
    pamr::io::SharedOutput file(session.comm(), output);
    file.append_once("all of it\n");
    file.commit();
  }
  misbehave_behind_output(how, session.comm());
  nlohmann::json report{{"ranks", session.comm().size()}, {"input", input}};
  if (how == "long-report") report["numbers"] = std::vector<int>(4000, 12345);  // a line each
  session.write_report(report);
  if (how == "step") {
    session.step("resting 7 cells");
    for (int i = 0; i < 100 && !(i > 15 && session.options().quiet); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(110));
  }
  if (how.starts_with("progress")) {
    auto progress = session.progress("walking", 40, "steps");
    for (int i = 0; i < 40; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(40));
      progress.update(i + 1, "uphill");
    }
  }
  if (how == "long") {
    std::string line = "done";
    for (int i = 0; i < 60; ++i) line += ", part " + std::to_string(i);
    session.summary(line + "; end");
  }
  misbehave_at_end(how);
  if (how == "warn") session.warn("a file named a\nb\x1b");
  session.summary("done on " + std::to_string(session.comm().size()) + " ranks");
  return how == "gate" ? ExitCode::failed : ExitCode::done;
}

}  // namespace

/// Instead of that of the library, which is called.
extern "C" int MPI_Finalize() {
  if (signal_at_end == SIGTERM) (void)std::raise(signal_at_end);
  const int code = PMPI_Finalize();
  if (signal_at_end == SIGSEGV) (void)std::raise(signal_at_end);
  return code_at_end != MPI_SUCCESS ? code_at_end : code;
}

int main(int argc, char** argv) {
  std::string input, output, how;
  bool force = false;
  return pamr::cli::run_tool(
      argc, argv, {"pamr-probe", "Behaves as told.", "pamr-probe --how gate"},
      [&](pamr::cli::CommandLine& line) {
        line.option("INPUT", input, "file to read");
        line.option("-o,--output", output, "file to write");
        line.option("--how", how, "kind of trouble");
        line.flag("--force", force, pamr::cli::force_help);
      },
      [&](Session& session) { return work(session, input, output, force, how); });
}
