// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/toml_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "pamr/base/error.hpp"

namespace pamr {
namespace toml_table_test {

using ::testing::ElementsAre;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

struct Point {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Point&, const Point&) = default;
};

/// The message with which reading that text this way fails; empty if it does not.
template <class Read>
std::string message_of(std::string_view text, const Read& read) {
  try {
    read(parse_toml(text, "a.toml"));
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(TomlTable, ReadsEveryKindOfValue) {
  const auto file = parse_toml(R"(
number = 2
integer = 7
flag = true
text = "words"
mode = "fast"
texts = ["a", "b"]
center = [1, 2.5, -3e0]
corners = [[0, 0, 0], [1, 1, 1]]
creases = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0], [2, 1, 0]]]
)",
                               "a.toml");

  EXPECT_EQ(file.number("number"), 2);
  EXPECT_EQ(file.integer("integer", 0, 10), 7);
  EXPECT_TRUE(file.flag("flag"));
  EXPECT_EQ(file.text("text"), "words");
  EXPECT_EQ(file.word("mode", {"slow", "fast"}), "fast");
  EXPECT_THAT(file.texts("texts"), ElementsAre("a", "b"));
  EXPECT_EQ(file.point<Point>("center"), (Point{1, 2.5, -3}));
  EXPECT_THAT(file.points<Point>("corners", 2), ElementsAre(Point{}, Point{1, 1, 1}));
  EXPECT_EQ(file.polylines<Point>("creases")[1].size(), 3U);
  EXPECT_TRUE(file.has_list("corners"));
  EXPECT_NO_THROW(file.finish());
}

TEST(TomlTable, TakesFallbacksForMissingKeysOnly) {
  const auto file = parse_toml("number = 'warm'\n", "a.toml");

  EXPECT_EQ(file.number_or("other", 3), 3);
  EXPECT_EQ(file.find_number("other"), std::nullopt);
  EXPECT_EQ(file.integer_or("other", 4, 0, 10), 4);
  EXPECT_TRUE(file.flag_or("other", true));
  EXPECT_EQ(file.text_or("other", "x"), "x");
  EXPECT_EQ(file.word_or("other", "x", {"y"}), "x");
  EXPECT_TRUE(file.list("other").empty());
  EXPECT_FALSE(file.has_list("other"));
  EXPECT_FALSE(file.has_list("number"));
  EXPECT_FALSE(file.find_table("other"));
  EXPECT_THROW(file.number_or("number", 3), Error);
}

TEST(TomlTable, NamesTheUnknownKeyAndTheNearestKnownOne) {
  const auto read = [](const TomlTable& file) {
    const auto stream = file.table("stream").table("free");
    (void)stream.number_or("temperature", 1);
    (void)stream.number_or("density", 1);
    file.finish();
  };

  EXPECT_EQ(message_of("[stream.free]\n  temprature = 300\n", read),
            "a.toml:2:3: unknown key 'temprature' in [stream.free]; did you mean 'temperature'?");
  EXPECT_EQ(message_of("[stream.free]\nspeed = 300\n", read),
            "a.toml:2:1: unknown key 'speed' in [stream.free]; expected one of density, temperature");
}

TEST(TomlTable, TakesAnUnknownKeyForTheMissingOne) {
  const auto read = [](const TomlTable& file) { (void)file.list("sphere").at(0).point<Point>("center"); };

  EXPECT_EQ(message_of("[[sphere]]\ncentre = [0, 0, 0]\n", read),
            "a.toml:2:1: unknown key 'centre' in [[sphere]]; did you mean 'center'?");
}

TEST(TomlTable, SaysWhatWasExpectedAndFound) {
  const auto number = [](const TomlTable& file) { (void)file.table("t").number("x", NumberRange::above(0)); };
  EXPECT_EQ(message_of("[t]\nx = 'a'\n", number), "a.toml:2:5: expected x = a number above 0 in [t], found \"a\"");
  EXPECT_EQ(message_of("[t]\nx = 0.0\n", number), "a.toml:2:5: expected x = a number above 0 in [t], found 0.0");
  EXPECT_EQ(message_of("[t]\nx = inf\n", number), "a.toml:2:5: expected x = a number above 0 in [t], found inf");
  EXPECT_EQ(message_of("[t]\nx = nan\n", number), "a.toml:2:5: expected x = a number above 0 in [t], found nan");
  EXPECT_EQ(message_of("[t]\nx = [1, 2]\n", number),
            "a.toml:2:5: expected x = a number above 0 in [t], found an array of 2");
  EXPECT_EQ(message_of("[t]\nx = {}\n", number), "a.toml:2:5: expected x = a number above 0 in [t], found a table");
  EXPECT_EQ(message_of("[t]\nx = true\n", number), "a.toml:2:5: expected x = a number above 0 in [t], found true");
  EXPECT_EQ(message_of("[t]\nx = 1979-05-27\n", number),
            "a.toml:2:5: expected x = a number above 0 in [t], found a date or time");
  EXPECT_EQ(message_of("[t]\n", number), "a.toml:1:1: expected x = a number above 0 in [t], found none");
}

TEST(TomlTable, CutsLongTextsInMessages) {
  const auto message =
      message_of("x = '" + std::string(10000, 'a') + "'", [](const TomlTable& file) { (void)file.number("x"); });

  EXPECT_EQ(message, "a.toml:1:5: expected x = a number, found \"" + std::string(60, 'a') + "...\"");
}

TEST(TomlTable, DescribesItsRanges) {
  const auto expected = [](NumberRange range) {
    return message_of("x = 'a'", [&](const TomlTable& file) { (void)file.number("x", range); }).substr(25);
  };

  EXPECT_EQ(expected({}), "a number, found \"a\"");
  EXPECT_EQ(expected(NumberRange::at_least(2)), "a number of at least 2, found \"a\"");
  EXPECT_EQ(expected({0, 1}), "a number between 0 and 1, found \"a\"");
  EXPECT_EQ(expected({0, 1, true}), "a number above 0 and at most 1, found \"a\"");
  EXPECT_EQ(expected({NumberRange().low, 1}), "a number of at most 1, found \"a\"");
}

TEST(TomlTable, RefusesValuesOfTheWrongType) {
  const auto read = [](std::string_view value, const auto& use) {
    return message_of("x = " + std::string(value), use).substr(0, 100);
  };

  EXPECT_EQ(read("1.5", [](const TomlTable& t) { (void)t.integer("x", 0, 9); }),
            "a.toml:1:5: expected x = an integer between 0 and 9, found 1.5");
  EXPECT_EQ(read("10", [](const TomlTable& t) { (void)t.integer("x", 0, 9); }),
            "a.toml:1:5: expected x = an integer between 0 and 9, found 10");
  EXPECT_EQ(read("1", [](const TomlTable& t) { (void)t.flag("x"); }),
            "a.toml:1:5: expected x = true or false, found 1");
  EXPECT_EQ(read("''", [](const TomlTable& t) { (void)t.text("x", "the name of a patch"); }),
            "a.toml:1:5: expected x = the name of a patch, found \"\"");
  EXPECT_EQ(read("'c'",
                 [](const TomlTable& t) {
                   (void)t.word("x", {"a", "b"});
                 }),
            "a.toml:1:5: expected x = \"a\" or \"b\", found \"c\"");
  EXPECT_EQ(read("['a', 1]", [](const TomlTable& t) { (void)t.texts("x"); }),
            "a.toml:1:11: expected x = an array of texts, found 1");
  EXPECT_EQ(read("[1, 2]", [](const TomlTable& t) { (void)t.numbers<3>("x"); }),
            "a.toml:1:5: expected x = an array of 3 numbers, found an array of 2");
  EXPECT_EQ(read("[1, 2, nan]", [](const TomlTable& t) { (void)t.numbers<3>("x"); }),
            "a.toml:1:12: expected x = an array of 3 numbers, found nan");
  EXPECT_EQ(read("[[0, 0, 0]]", [](const TomlTable& t) { (void)t.points<Point>("x", 2); }),
            "a.toml:1:5: expected x = an array of 2 points [[x, y, z], ...], found an array of 1");
  EXPECT_EQ(read("[[[0, 0, 0]]]", [](const TomlTable& t) { (void)t.polylines<Point>("x"); }),
            "a.toml:1:6: expected x = polylines [[[x, y, z], [x, y, z], ...], ...], found an array of 1");
}

TEST(TomlTable, RefusesWhatIsNoTable) {
  EXPECT_EQ(message_of("x = 1", [](const TomlTable& t) { (void)t.table("x"); }),
            "a.toml:1:5: expected a table [x], found 1");
  EXPECT_EQ(message_of("", [](const TomlTable& t) { (void)t.table("x"); }), "a.toml: expected a table [x], found none");
  EXPECT_EQ(message_of("x = 1", [](const TomlTable& t) { (void)t.list("x"); }),
            "a.toml:1:5: expected tables [[x]], found 1");
  EXPECT_EQ(message_of("x = [{}, 1]", [](const TomlTable& t) { (void)t.list("x"); }),
            "a.toml:1:10: expected a table [[x]], found 1");
  EXPECT_EQ(message_of("[x]\ny = 1", [](const TomlTable& t) { (void)t.table("x").all_tables(); }),
            "a.toml:2:5: expected a table [x.y], found 1");
}

TEST(TomlTable, FinishesTheTablesThatWereTakenFromIt) {
  const auto read = [](const TomlTable& file) {
    for (const auto& item : file.list("a")) {
      (void)item.has("x");
      (void)item.find_table("b");
    }
    file.ignore("c");
    file.finish();
  };

  EXPECT_EQ(message_of("[[a]]\nx = 1\n[c]\ny = 1\n", read), "");
  EXPECT_EQ(message_of("[[a]]\n[[a]]\nxx = 1\nb = 1\n", read).substr(0, 27), "a.toml:4:5: expected a tabl");
  EXPECT_EQ(message_of("[[a]]\n[[a]]\nother = 1\n", read),
            "a.toml:3:1: unknown key 'other' in [[a]]; expected one of b, x");
  EXPECT_EQ(message_of("[[a]]\n[a.b]\nz = 1\n", read), "a.toml:3:1: unknown key 'z' in [a.b]; expected no keys");
}

TEST(TomlTable, GivesTheTablesWithFreeNamesInAlphabeticalOrder) {
  const auto file = parse_toml("[b.y]\n[b.x]\n", "a.toml");

  const auto tables = file.table("b").all_tables();

  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].name(), "x");
  EXPECT_EQ(tables[1].name(), "y");
  EXPECT_EQ(tables[0].at(), "a.toml:2:1");
}

TEST(TomlTable, IsCalledByItsTitle) {
  auto table = parse_toml("[[surface]]\nname = 'ball'\nprofile = [{}]\n", "a.toml").list("surface").at(0);
  table.set_title("surface \"ball\"");

  EXPECT_THAT([&] { (void)table.number("radius"); },
              ThrowsMessage<Error>(StrEq("a.toml:1:1: expected radius = a number in surface \"ball\", found none")));
  EXPECT_THAT([&] { (void)table.list("profile").at(0).numbers<2>("from"); },
              ThrowsMessage<Error>(StrEq("a.toml:3:12: expected from = an array of 2 numbers in profile of surface "
                                         "\"ball\", found none")));
  EXPECT_THAT([&] { table.finish(); },
              ThrowsMessage<Error>(StrEq("a.toml:2:1: unknown key 'name' in surface \"ball\"; expected one of profile, "
                                         "radius")));
}

TEST(TomlTable, RefusesForReasonsOfItsUser) {
  const auto file = parse_toml("[t]\nlow = 2\nhigh = 1\n", "a.toml");
  const auto table = file.table("t");

  EXPECT_THAT([&] { table.refuse("low", "low below high"); },
              ThrowsMessage<Error>(StrEq("a.toml:2:7: expected low = low below high in [t], found 2")));
  EXPECT_THAT([&] { table.refuse("low", "a number below high", "2 and 1"); },
              ThrowsMessage<Error>(StrEq("a.toml:2:7: expected low = a number below high in [t], found 2 and 1")));
  EXPECT_THAT([&] { table.fail("expected one of low and high, found both"); },
              ThrowsMessage<Error>(StrEq("a.toml:1:1: expected one of low and high, found both")));
  EXPECT_EQ(file.at(), "a.toml");
}

TEST(TomlTable, SaysWhichLineIsNoToml) {
  const auto parse = [](std::string_view text) { return message_of(text, [](const TomlTable&) {}); };

  EXPECT_EQ(parse("x = 1\n  name = \"box\ny = 2\n"), "a.toml:2:14: missing quote in the line: name = \"box");
  EXPECT_EQ(parse("x = 1\nname = \"box"), "a.toml:2:12: missing quote in the line: name = \"box");
  EXPECT_EQ(parse("x = 'box\n").substr(0, 26), "a.toml:1:9: missing quote ");
  EXPECT_EQ(parse("x = 1\ny = = 2\n").substr(0, 28), "a.toml:2:5: expected TOML: E");
  EXPECT_EQ(parse("x = 1\nx = 2\n").substr(0, 26), "a.toml:2:5: expected TOML:");
}

TEST(TomlTable, OutlivesTheTableThatItCameFrom) {
  const auto inner = [] { return parse_toml("[a.b]\nx = 3\n", "a.toml").table("a").table("b"); }();

  EXPECT_EQ(inner.number("x"), 3);
}

TEST(TomlTable, KeepsTheSourceOfTheTablesOfOneKeyOnTheirLines) {
  const auto file = parse_toml(
      "[mesh]\nx = 1\n[[surface]]\nname = 'a'  # kept\n[mesh.sizes]\n[[surface]]\n[[surface.p]]\n"
      "[other]\n",
      "a.toml");

  EXPECT_EQ(file.source_of("surface"), "\n\n[[surface]]\nname = 'a'  # kept\n\n[[surface]]\n[[surface.p]]\n\n");
}

TEST(TomlTable, SurvivesDamagedText) {
  const std::string good = "[mesh]\nshape = \"box\"\nsize = [1, 2.5, -3e0]\n[[a]]\nb = { c = true, d = 1979-05-27 }\n";
  std::mt19937 random(7);
  std::size_t accepted = 0;

  for (int trial = 0; trial < 2000; ++trial) {
    auto text = good;
    for (int change = 0; change < 3; ++change) text[random() % text.size()] = static_cast<char>(random() % 256);
    accepted += message_of(text, [](const TomlTable& file) {
                  (void)file.table("mesh").numbers<3>("size");
                  for (const auto& item : file.list("a")) item.finish();
                  file.finish();
                }).empty();
  }

  EXPECT_EQ(accepted, 0U);  // [[a]] has a key that nobody asked for
}

}  // namespace toml_table_test
}  // namespace pamr
