// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "cli/step_clock.hpp"

namespace pamr::cli {

namespace {

constexpr std::chrono::milliseconds terminal_interval{100};
constexpr std::chrono::seconds line_interval{10};
constexpr std::int64_t bar_width = 24;
constexpr const char* clear_line = "\r\033[K";

std::string clock_text(double seconds) {
  const auto whole = std::llround(seconds);
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string rate_text(double per_second) {
  if (per_second >= 1e6) return fmt::format("{:.3g} M ", per_second * 1e-6);
  if (per_second >= 1e4) return fmt::format("{:.3g} k ", per_second * 1e-3);
  return fmt::format("{:.3g} ", per_second);
}

std::string bar(std::int64_t done, std::int64_t total) {
  const auto filled = total > 0 ? std::clamp<std::int64_t>(done * bar_width / total, 0, bar_width) : 0;
  return "[" + std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(bar_width - filled), '.') + "] ";
}

}  // namespace

std::string progress_text(const Work& work, std::int64_t done, double seconds, const std::string& step) {
  const auto& [what, unit, total, before] = work;
  std::string text =
      total < 0 ? fmt::format("{}: {} {}", what, done, unit) : fmt::format("{}: {} of {} {}", what, done, total, unit);
  if (total > 0) text += fmt::format(" ({} %)", done * 100 / total);
  if (done > before && seconds > 0) {
    const double rate = static_cast<double>(done - before) / seconds;
    text += fmt::format(", {}{}/s", rate_text(rate), unit);
    if (total >= 0)
      text += fmt::format(", {} left", clock_text(static_cast<double>(std::max<std::int64_t>(total - done, 0)) / rate));
  }
  if (!step.empty()) text += ", " + step;
  return text;
}

Progress::Progress(std::string what, std::int64_t total, std::string unit, bool shown, std::int64_t before)
    : work_{std::move(what), std::move(unit), total, before},
      shown_(shown),
      on_terminal_(shown && error_is_on_terminal()),
      start_(Clock::now()),
      last_(on_terminal_ ? start_ - terminal_interval : start_) {
  if (shown_) hide_step();
}

Progress::~Progress() {
  if (drawn_) hide_step();
}

void Progress::update(std::int64_t done, const std::string& step) {
  if (!shown_) return;
  const auto now = Clock::now();
  const bool due = on_terminal_ ? now - last_ >= terminal_interval : now - last_ >= line_interval;
  if (!due) return;
  last_ = now;
  const auto text = progress_text(work_, done, std::chrono::duration<double>(now - start_).count(), step);
  if (on_terminal_) {
    drawn_ = true;
    mark_line(true);  // before it is: an interrupt may come in between
    std::fputs((clear_line + bar(done, work_.total) + text).c_str(), stderr);
  } else {
    std::fputs((text + "\n").c_str(), stderr);
  }
  std::fflush(stderr);
}

}  // namespace pamr::cli
