// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace pamr::par {

/// While it lives, a process that no launcher has started tells Open MPI so by its environment: MPI then starts no
/// daemon, which would only serve processes to come, looks for no network, and keeps its files in a folder of this
/// process. That is four fifths of the time in which such a process starts (Open MPI 4.1.4: 0.39 s, then 0.08 s). Does
/// nothing where a launcher's variables are found, keeps what users have set, and takes its own variables back in the
/// end, so that programs started later do not have them. Folders of this user's processes that have ended without
/// removing theirs go. To be made right before MPI is initialized, before any thread.
/// Local. Other implementations of MPI do not look at these variables.
class LoneStart {
 public:
  LoneStart();
  ~LoneStart();
  LoneStart(const LoneStart&) = delete;
  LoneStart& operator=(const LoneStart&) = delete;
  LoneStart(LoneStart&&) = delete;
  LoneStart& operator=(LoneStart&&) = delete;

 private:
  void set(const char* name, const char* value);

  std::vector<const char*> set_here_;
};

}  // namespace pamr::par
