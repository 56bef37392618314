// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/remove_on_interrupt.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <system_error>

namespace pamr::io {

namespace {

// What a signal handler may touch: fixed storage, and a state that is raised after the path is in place.
enum State : int { is_free, is_being_filled, is_armed };
struct Slot {
  std::atomic<int> state{is_free};
  std::array<char, PATH_MAX> path{};
};
constexpr std::size_t max_slots = 64;
std::array<Slot, max_slots> slots;
static_assert(std::atomic<int>::is_always_lock_free);

std::size_t claim() {
  for (std::size_t i = 0; i < max_slots; ++i) {
    int expected = is_free;
    if (slots[i].state.compare_exchange_strong(expected, is_being_filled)) return i;
  }
  return max_slots;
}

}  // namespace

RemoveOnInterrupt::RemoveOnInterrupt(const std::filesystem::path& path) : slot_(claim()) {
  if (slot_ == max_slots) return;
  std::error_code failed;
  auto name = std::filesystem::absolute(path, failed).string();  // in case the process changes its folder
  if (failed) name = path.string();
  if (name.size() >= PATH_MAX) {
    slots[slot_].state = is_free;
    slot_ = max_slots;
    return;
  }
  std::memcpy(slots[slot_].path.data(), name.c_str(), name.size() + 1);
  slots[slot_].state = is_armed;
}

RemoveOnInterrupt::~RemoveOnInterrupt() {
  if (slot_ < max_slots) slots[slot_].state = is_free;
}

void remove_unfinished() noexcept {
  const int before = errno;
  for (const auto& slot : slots)
    if (slot.state == is_armed) ::unlink(slot.path.data());
  constexpr int deepest = 4;  // folders within folders, in any order
  for (int pass = 0; pass < deepest; ++pass)
    for (const auto& slot : slots)
      if (slot.state == is_armed) ::rmdir(slot.path.data());
  errno = before;
}

}  // namespace pamr::io
