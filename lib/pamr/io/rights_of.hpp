// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>

namespace pamr::io {

/// Who may do what with a file or folder.
struct Rights {
  uid_t owner = 0;
  gid_t group = 0;
  mode_t mode = 0;
};

/// Those of what has this name, through links; nothing where nothing has it, or the system does not tell. Local.
std::optional<Rights> rights_of(const std::filesystem::path& path);

/// Gives an open file or folder these rights, and the owner and the group as far as the system lets this process: so a
/// file that others may not read is none that they may after it was replaced. False, with errno, where that failed.
/// Local.
bool set_rights(int descriptor, const Rights& rights);

}  // namespace pamr::io
