// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/complete_outputs.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <exception>
#include <string>

#include "pamr/base/one_line.hpp"

namespace pamr::io {

namespace {

// A signal handler reads these: the storage is fixed, and the length grows once the text is in place.
std::array<char, 1000> text{};
std::atomic<std::size_t> length{0};
std::atomic<bool> is_full{false};
static_assert(std::atomic<std::size_t>::is_always_lock_free);

/// Room that stays for what says that there were more.
constexpr std::string_view more = ", ...";

void append(std::string_view part) {
  const std::size_t begin = length;
  std::copy(part.begin(), part.end(), text.begin() + static_cast<std::ptrdiff_t>(begin));
  length = begin + part.size();
}

}  // namespace

void add_complete_output(const std::filesystem::path& output) noexcept {
  try {
    if (is_full || output.parent_path().extension() == ".partial") return;
    const auto name = "'" + one_line(output.string()) + "'";
    const auto known = complete_outputs();
    if (known.find(name) != std::string_view::npos) return;
    const auto part = (known.empty() ? "; complete: " : ", ") + name;
    if (length + part.size() + more.size() <= text.size()) return append(part);
    is_full = true;
    if (!known.empty()) append(more);
  } catch (const std::exception&) {  // no memory: the file is complete all the same
  }
}

std::string_view complete_outputs() noexcept { return {text.data(), length}; }

}  // namespace pamr::io
