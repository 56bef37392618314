// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/foam/gunzip.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>

#include "pamr/base/error.hpp"

namespace pamr::io {

std::string gunzip(std::string_view packed, const std::string& source) {
  constexpr int with_gzip_header = 16 + MAX_WBITS;
  constexpr std::size_t step = std::size_t{1} << 20U;
  z_stream stream{};
  if (inflateInit2(&stream, with_gzip_header) != Z_OK)
    throw Error(source + ": expected memory to unpack it, found none");
  const std::unique_ptr<z_stream, decltype(&inflateEnd)> owner(&stream, inflateEnd);
  std::string text;
  for (int state = Z_OK; !packed.empty() || state != Z_STREAM_END;) {
    if (state == Z_STREAM_END && inflateReset(&stream) != Z_OK) break;  // the next member
    const auto n_given = std::min<std::size_t>(packed.size(), std::numeric_limits<uInt>::max());
    const auto n_known = text.size();
    text.resize(n_known + step);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(n_given);
    stream.next_out = reinterpret_cast<Bytef*>(text.data() + n_known);
    stream.avail_out = static_cast<uInt>(step);
    state = inflate(&stream, Z_NO_FLUSH);
    packed.remove_prefix(n_given - stream.avail_in);
    text.resize(n_known + step - stream.avail_out);
    if (state == Z_BUF_ERROR)
      throw Error(source + ": expected the end of what gzip has packed, found that of the file");
    if (state != Z_OK && state != Z_STREAM_END)
      throw Error(source + ": expected data packed by gzip, found damaged ones");
  }
  return text;
}

}  // namespace pamr::io
