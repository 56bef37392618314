// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace pamr::io {

/// Whether a text is UTF-8 (no overlong forms, no surrogates) without control characters other than those given.
bool is_clean_text(std::string_view text, std::string_view allowed_controls);

}  // namespace pamr::io
