// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace pamr::io {

/// Whether a text is UTF-8 (no overlong forms, no surrogates) without control characters other than those given.
bool is_clean_text(std::string_view text, std::string_view allowed_controls);

/// A text as a message may show it: short, `?` for bytes that are not printable ASCII.
std::string shown_text(std::string_view text);

/// Throws `Error` for a name that is no clean text; `what` has it: "patch 7".
void require_clean_name(std::string_view what, std::string_view name);

}  // namespace pamr::io
