// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/rights_of.hpp"

#include <sys/stat.h>
#include <unistd.h>

namespace pamr::io {

std::optional<Rights> rights_of(const std::filesystem::path& path) {
  constexpr mode_t all = 0777;
  struct stat found {};
  if (stat(path.c_str(), &found) != 0) return {};
  return Rights{found.st_uid, found.st_gid, found.st_mode & all};
}

bool set_rights(int descriptor, const Rights& rights) {
  struct stat made {};
  if (fstat(descriptor, &made) != 0) return false;
  // Who may not give a file to another owner may still give it to one of the own groups.
  const bool is_others = made.st_uid != rights.owner || made.st_gid != rights.group;
  if (is_others && fchown(descriptor, rights.owner, rights.group) != 0)
    (void)!fchown(descriptor, made.st_uid, rights.group);
  return fchmod(descriptor, rights.mode) == 0;
}

}  // namespace pamr::io
