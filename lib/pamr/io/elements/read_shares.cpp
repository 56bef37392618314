// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/read_shares.hpp"

#include <optional>

#include "pamr/base/error.hpp"
#include "pamr/io/elements/line_index.hpp"

namespace pamr::io {

ElementParts read_shares(const par::Comm& comm, const std::filesystem::path& file,
                         const std::function<bool(TextCursor&)>& is_text,
                         const std::function<ElementParts(TextCursor&, Share)>& read) {
  std::optional<MappedFile> mapped;
  std::optional<TextCursor> in;
  bool has_lines = false;
  par::agree(comm, [&] {
    mapped.emplace(file);
    in.emplace(mapped->bytes(), file.string());
    has_lines = is_text(*in);
  });
  const auto size = static_cast<std::int64_t>(mapped->bytes().size());
  if (comm.min(size) != comm.max(size))
    throw Error("file '" + file.string() + "': expected a file that stays as it is, found one of several sizes");
  std::optional<LineIndex> lines;
  if (comm.any(has_lines) && comm.size() > 1) lines.emplace(comm, mapped->bytes());
  ElementParts parts;
  par::agree(comm, [&] {
    if (lines) in->use_index(&*lines);
    parts = read(*in, {comm.rank(), comm.size()});
  });
  return parts;
}

}  // namespace pamr::io
