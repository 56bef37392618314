// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace pamr::io {

/// Told of what is not as in the mesh, on every rank alike; may be none.
using Remark = std::function<void(const std::string& text)>;

/// A format's names of patches or regions, one for each name of the mesh: throws `Error` where two that differ have
/// become one, and remarks on those that are not as they were. `what`: "patch"; `format`: "Gmsh". Local.
void check_written_names(std::string_view format, std::string_view what, const std::vector<std::string>& names,
                         const std::vector<std::string>& written, const Remark& remark);

/// The beginning of a text, `most` bytes long or a little less: no character in UTF-8 is cut.
std::string cut_to(std::string_view text, std::size_t most);

}  // namespace pamr::io
