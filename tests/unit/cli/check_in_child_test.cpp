// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/check_in_child.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace pamr::cli {
namespace check_in_child_test {

constexpr ChildLimits limits{.processor_seconds = 1, .memory_bytes = rlim_t{64} << 20U};

TEST(InChild, YieldsTheTextOfItsWork) {
  const std::string text(1000000, 'x');
  const auto answer = in_child([&] { return text; }, limits);
  EXPECT_EQ(answer.text, text);
  EXPECT_EQ(answer.trouble, "");
}

TEST(InChild, OutlivesTheDeathOfTheChild) {
  const auto answer = in_child(
      []() -> std::string {
        std::raise(SIGSEGV);
        return "alive";
      },
      limits);
  EXPECT_EQ(answer.text, "");
  EXPECT_EQ(answer.trouble, "Segmentation fault");
}

TEST(InChild, EndsAChildThatComputesForEver) {
  const auto answer = in_child(
      []() -> std::string {
        for (volatile bool go = true; go;) {
        }
        return {};
      },
      limits);
  EXPECT_EQ(answer.trouble, "CPU time limit exceeded");
}

TEST(InChild, KeepsAChildFromTakingTheMemoryOfTheMachine) {
  const auto answer = in_child([] { return std::string(std::size_t{1} << 30U, 'x'); }, limits);
  EXPECT_EQ(answer.text, "");
  EXPECT_EQ(answer.trouble, "failure");
}

/// A variable of the environment that has this value while the object lives.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value, 1);
  }
  ~Variable() { before_.empty() ? unsetenv(name_) : setenv(name_, before_.c_str(), 1); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  Variable(Variable&&) = delete;
  Variable& operator=(Variable&&) = delete;

 private:
  const char* name_;
  std::string before_;
};

/// A file that begins as one of HDF5 and goes on otherwise, and a text that names it.
class NamedFiles : public testing::Test {
 protected:
  NamedFiles() {
    std::filesystem::create_directories(folder_);
    std::ofstream(bad_, std::ios::binary) << "\x89HDF\r\n\x1a\n" << std::string(2000, 'x');
    std::ofstream(list_) << bad_;
  }
  ~NamedFiles() override { std::filesystem::remove_all(folder_); }

  static BadFiles check(std::string word, FilesIn files_in = nullptr) {
    std::string tool = "pamr-probe", none = "none.hdf";
    std::array<char*, 3> words{tool.data(), word.data(), none.data()};
    return check_named_files(static_cast<int>(words.size()), words.data(), files_in);
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("pamr_check_in_child_" + std::to_string(getpid()));
  std::string bad_ = (folder_ / "bad.hdf").string(), list_ = (folder_ / "list.txt").string();
};

TEST_F(NamedFiles, OfTheCommandLineAreChecked) {
  const Variable first("OMPI_COMM_WORLD_RANK", "0");
  EXPECT_THAT(check(bad_), testing::ElementsAre(testing::Pair(bad_, testing::HasSubstr("complete HDF5 file"))));
  EXPECT_THAT(check("--mesh=" + bad_), testing::ElementsAre(testing::Key(bad_)));
  EXPECT_THAT(check(list_), testing::IsEmpty());
}

TEST_F(NamedFiles, OfFilesAreCheckedWhereTheToolKnowsThem) {
  const Variable first("OMPI_COMM_WORLD_RANK", "0");
  const auto of_list = [](const std::string& file) {
    std::string name;
    std::ifstream(file) >> name;
    return file.ends_with(".txt") ? std::vector<std::string>{name} : std::vector<std::string>{};
  };
  EXPECT_THAT(check(list_, of_list), testing::ElementsAre(testing::Key(bad_)));
}

TEST_F(NamedFiles, AreLeftToTheFirstRank) {
  const Variable second("OMPI_COMM_WORLD_RANK", "1");
  EXPECT_THAT(check(bad_), testing::IsEmpty());
}

}  // namespace check_in_child_test
}  // namespace pamr::cli
