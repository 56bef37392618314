// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command_line.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pamr::cli {
namespace command_line_test {

/// A command line that is read from words, as a shell gives them.
class CommandLineTest : public ::testing::Test {
 protected:
  void read(std::vector<std::string> words) {
    std::reverse(words.begin(), words.end());  // the order in which CLI11 takes a vector
    app.parse(words);
  }

  CLI::App app;
  CommandLine line{app};
};

TEST_F(CommandLineTest, ReadsValuesOfEachType) {
  std::string mesh, output;
  int layers = 1;
  double height = 0;
  std::optional<std::int64_t> most;
  std::optional<std::uint64_t> seed;
  std::vector<std::vector<double>> centers;
  bool force = false;
  line.option("MESH", mesh, "").required();
  line.option("-o,--output", output, "");
  line.option("--layers", layers, "");
  line.option("--height", height, "");
  line.option("--most", most, "");
  line.option("--seed", seed, "");
  line.option("--center", centers, "").delimiter(',');
  line.flag("--force", force, "");
  read({"a.hdf", "-o", "b.hdf", "--layers=3", "--height", "1e-3", "--most", "9000000000", "--force"});
  EXPECT_EQ(mesh, "a.hdf");
  EXPECT_EQ(output, "b.hdf");
  EXPECT_EQ(layers, 3);
  EXPECT_EQ(height, 1e-3);
  EXPECT_EQ(most, 9000000000);
  EXPECT_EQ(seed, std::nullopt);
  EXPECT_TRUE(force);
}

TEST_F(CommandLineTest, RefusesValuesOutsideTheirRange) {
  int layers = 0;
  double share = 0, length = 1;
  std::string how;
  line.option("--layers", layers, "").range(1, 3);
  line.option("--share", share, "").range(0.0, 1.0);
  line.option("--length", length, "").positive();
  line.option("--how", how, "").one_of({"fast", "well"});
  EXPECT_NO_THROW(read({"--layers", "3", "--share", "1", "--length", "1e-9", "--how", "well"}));
  EXPECT_THROW(read({"--layers", "4"}), CLI::ValidationError);
  EXPECT_THROW(read({"--share", "1.1"}), CLI::ValidationError);
  EXPECT_THROW(read({"--length", "0"}), CLI::ValidationError);
  EXPECT_THROW(read({"--how", "badly"}), CLI::ValidationError);
  EXPECT_THROW(read({"--layers", "two"}), CLI::ParseError);
  EXPECT_THROW(read({"--length", "inf"}), CLI::ValidationError);
  EXPECT_THROW(read({"--length", "nan"}), CLI::ValidationError);
  try {
    read({"--length", "-2"});
    FAIL() << "expected a length of -2 to be refused";
  } catch (const CLI::ValidationError& error) {
    EXPECT_STREQ(error.what(), "--length: expected a number above 0, found -2");
  }
}

TEST_F(CommandLineTest, KnowsWhichOptionsWereGiven) {
  std::string mesh, marks;
  auto mesh_option = line.option("--mesh", mesh, "");
  auto marks_option = line.option("--marks", marks, "").needs(mesh_option);
  read({"--mesh", "a.hdf"});
  EXPECT_TRUE(mesh_option.is_given());
  EXPECT_FALSE(marks_option.is_given());
  EXPECT_THROW(read({"--marks", "refine"}), CLI::RequiresError);
}

TEST_F(CommandLineTest, RefusesOptionsThatExcludeEachOther) {
  std::string a, b;
  auto first = line.option("--first", a, "");
  line.option("--second", b, "").excludes(first);
  EXPECT_THROW(read({"--first", "1", "--second", "2"}), CLI::ExcludesError);
}

TEST_F(CommandLineTest, ListsOptionsInTheOrderOfTheCommandLine) {
  bool all = false;
  line.listed_option("--sphere", "");
  line.listed_option("--box", "");
  line.listed_flag("--all", all, "");
  read({"--box", "1", "--sphere", "2", "--all", "--box", "3", "--all"});
  const std::vector<std::pair<std::string, std::string>> expected{
      {"--box", "1"}, {"--sphere", "2"}, {"--all", ""}, {"--box", "3"}};
  EXPECT_EQ(line.listed(), expected);
}

TEST_F(CommandLineTest, ChecksAfterReadingAndRefusesWhatIsMissing) {
  std::string output;
  const auto given = line.option("--output", output, "");
  line.after_reading([given] {
    if (!given.is_given()) CommandLine::refuse_without("--output");
  });
  EXPECT_NO_THROW(read({"--output", "a.hdf"}));
  EXPECT_THROW(read({}), CLI::RequiredError);
}

}  // namespace command_line_test
}  // namespace pamr::cli
