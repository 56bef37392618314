// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/line_index.hpp"

#include <gtest/gtest.h>

#include <string>

#include "pamr/base/error.hpp"
#include "pamr/io/elements/text_cursor.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {
namespace line_index_test {

/// Lines of 0 to 6 characters.
std::string lines(int n) {
  std::string text;
  for (int i = 0; i < n; ++i) text += std::string(static_cast<std::size_t>(i * i % 7), 'x') + "\n";
  return text;
}

std::size_t after_lines_slowly(const std::string& text, std::size_t from, std::int64_t n) {
  for (; from < text.size() && n > 0; ++from) n -= text[from] == '\n' ? 1 : 0;
  return n == 0 ? from : std::string::npos;
}

TEST(LineIndex, FindsWhatCountingFindsFromEverywhere) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto text = lines(40) + "no end";
  for (const std::size_t chunk : {1, 3, 8, 64, 1000}) {
    const LineIndex index(comm, text, chunk);
    for (std::size_t from = 0; from < text.size(); ++from)
      for (std::int64_t n = 1; n < 43; ++n) ASSERT_EQ(index.after_lines(from, n), after_lines_slowly(text, from, n));
    EXPECT_EQ(index.after_lines(text.size(), 1), std::string::npos);
  }
  EXPECT_EQ(LineIndex(comm, "").after_lines(0, 1), std::string::npos);
}

TEST(TextCursor, SkipsFarWithAnIndexToTheSamePlaceAsWithout) {
  const par::Comm comm(MPI_COMM_WORLD);
  std::string text;
  for (int i = 0; i < 700000; ++i) text += std::to_string(i) + "\n";
  const LineIndex index(comm, text);
  for (const std::int64_t n : {1, 1000, 400000, 650000, 700000}) {
    TextCursor with(text, "file"), without(text, "file");
    with.use_index(&index);
    with.skip_lines(n, "a line");
    without.skip_lines(n, "a line");
    EXPECT_EQ(with.position(), without.position());
  }
  TextCursor beyond(text, "file");
  beyond.use_index(&index);
  EXPECT_THROW(beyond.skip_lines(700001, "a line"), Error);
}

TEST(TextCursor, SkipsToAWholeLine) {
  TextCursor in("$a\n$End\n x$End\n$Endless\n$End\r\nrest", "file");
  (void)in.line();
  (void)in.line();
  in.skip_to_line("$End");
  EXPECT_EQ(in.line(), "rest");
  TextCursor none("$a\n$Endless", "file");
  EXPECT_THROW(none.skip_to_line("$End"), Error);
}

}  // namespace line_index_test
}  // namespace pamr::io
