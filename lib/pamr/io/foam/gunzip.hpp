// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace pamr::io {

/// What gzip has packed, of all members of a file. `source` begins errors. Throws `Error` for bytes that are damaged or
/// end early. Local; at most 1,032 times as many bytes as are given. Source: RFC 1952.
std::string gunzip(std::string_view packed, const std::string& source);

}  // namespace pamr::io
