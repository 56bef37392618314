// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/io/elements/mesh_of_elements.hpp"

namespace pamr::io {

/// What the reader of a file of elements had to change or leave out, with counts: one sentence each, for warnings.
std::vector<std::string> remarks_of(const ElementMesh& read);

/// That of boundary faces without a tag; empty if there are none.
std::string remark_on_untagged(const ElementMesh& read);

/// Throws `Error`, which begins with `source`, for the first of these: what is strict accepts none. Local.
void refuse_changes(const ElementMesh& read, const std::string& source);

}  // namespace pamr::io
