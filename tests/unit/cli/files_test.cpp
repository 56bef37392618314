// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/files.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "pamr/base/error.hpp"

namespace pamr::cli {
namespace files_test {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// In a folder with `a`, a hard link and a symbolic link to it, a link to nothing, a folder and a link to that.
class FilesTest : public ::testing::Test {
 protected:
  FilesTest() : before_(fs::current_path()) {
    std::string name = (fs::temp_directory_path() / "pamr files XXXXXX").string();
    fs::current_path(fs::path(mkdtemp(name.data())));
    std::ofstream("a") << "a";
    fs::create_hard_link("a", "hard");
    fs::create_symlink("a", "link");
    fs::create_symlink("none", "dangling");
    fs::create_directories("folder/inner");
    fs::create_symlink("folder", "other");
  }
  ~FilesTest() override {
    const auto here = fs::current_path();
    fs::current_path(before_);
    fs::remove_all(here);
  }

  fs::path before_;
};

SeriesName series(const std::string& name, int digits) {
  return [name, digits](std::uint64_t number) { return fmt::format("{}-{:0{}}.hdf", name, number, digits); };
}

struct Pair {
  std::string a, b;
};

TEST_F(FilesTest, NamesOfOneFileAreKnownInEverySpelling) {
  const auto here = fs::current_path().string();

  for (const auto& [a, b] : std::vector<Pair>{{"a", "./a"},
                                              {"a", "folder/../a"},
                                              {"a", here + "/a"},
                                              {"a", "hard"},
                                              {"a", "link"},
                                              {"link", "hard"},
                                              {"new", "./new"},
                                              {"new", here + "/new"},
                                              {"folder/new", "other/new"},
                                              {"other/inner/../new", "folder/new"},
                                              {"folder/inner/new", "./other//inner/./new"},
                                              {"dangling", "./dangling"},
                                              {"missing/new", "missing/./new"},
                                              {"folder", "folder/"}}) {
    EXPECT_TRUE(is_same_file(a, b)) << a << " " << b;
    EXPECT_TRUE(is_same_file(b, a)) << a << " " << b;
  }
  for (const auto& [a, b] : std::vector<Pair>{
           {"a", "b"}, {"folder/a", "a"}, {"folder/inner/a", "folder/a"}, {"new", "newer"}, {"none", "dangling"}})
    EXPECT_FALSE(is_same_file(a, b)) << a << " " << b;
}

TEST_F(FilesTest, AnOutputIsNoInputAndNoOtherOutputInWhateverOrder) {
  const auto refused =
      ThrowsMessage<Error>(HasSubstr("new: expected an output of its own, found the same file as the "));
  using Add = std::function<void(Files&)>;
  const std::vector<Add> inputs{[](Files& files) { files.add_input("folder/new"); }};
  const std::vector<Add> outputs{[](Files& files) { files.add_output("folder/new"); }};
  const Add other = [](Files& files) { files.add_output("other/new"); };

  for (const auto& first : {inputs[0], outputs[0]}) {
    EXPECT_THAT(
        [&] {
          Files files;
          first(files);
          other(files);
        },
        refused);
    EXPECT_THAT(
        [&] {
          Files files;
          other(files);
          first(files);
        },
        refused);
  }
  Files files;
  files.add_input("a");
  files.add_input("link");  // two inputs may be one
  files.add_output("b");
  files.add_output("folder/b");
}

TEST_F(FilesTest, AnOutputMayReplaceTheInputThatItIsSaidToReplaceAndNoOther) {
  Files files;
  files.add_input("a");
  files.add_input("b");

  files.add_output("folder/../a", "a");

  EXPECT_THAT([&] { files.add_output("b", "a"); }, ThrowsMessage<Error>(HasSubstr("the input b")));
  EXPECT_THAT([&] { files.add_output("hard"); }, ThrowsMessage<Error>(HasSubstr("the input a")));
}

TEST_F(FilesTest, AFileOfASeriesIsKnownUnderAnyName) {
  std::ofstream("flow-0000010.hdf") << "old";
  fs::create_hard_link("flow-0000010.hdf", "linked.hdf");
  fs::create_symlink("flow-0000010.hdf", "points.hdf");

  for (const auto* name : {"linked.hdf", "points.hdf", "./flow-0000010.hdf"}) {
    Files outputs, inputs;
    outputs.add_series(series("flow", 7));
    inputs.add_input(name);
    EXPECT_THAT([&] { outputs.add_output(name); }, ThrowsMessage<Error>(HasSubstr("flow-0000010.hdf"))) << name;
    EXPECT_THAT([&] { inputs.add_series(series("flow", 7)); }, ThrowsMessage<Error>(HasSubstr("flow-0000010.hdf")))
        << name;
  }
  EXPECT_TRUE(is_file_of(series("flow", 7), "flow-0000010.hdf"));
  for (const auto* name : {"flow-10.hdf", "flow-0000010.vtu", "low-0000010.hdf", "flow-0000010"})
    EXPECT_FALSE(is_file_of(series("flow", 7), name)) << name;
}

TEST_F(FilesTest, AFolderThatIsReplacedHoldsNothingElse) {
  for (const auto* path : {"folder/x", "other/inner/x", "folder/inner/../x", "folder"}) {
    EXPECT_THAT(
        [&] {
          Files files;
          files.add_input(path);
          files.add_folder("folder");
        },
        ThrowsMessage<Error>(HasSubstr(std::string("folder: expected an output apart from inputs and other "
                                                   "outputs, found the input ") +
                                       path)));
    EXPECT_ANY_THROW({
      Files files;
      files.add_folder("folder");
      files.add_input(path);
    });
    EXPECT_ANY_THROW({
      Files files;
      files.add_output(path);
      files.add_folder("folder");
    });
    EXPECT_ANY_THROW({
      Files files;
      files.add_folder("folder");
      files.add_output(path);
    });
  }
  fs::create_symlink("folder/inner/x", "away");
  std::ofstream("folder/inner/x") << "x";
  EXPECT_ANY_THROW({
    Files files;
    files.add_input("away");
    files.add_folder("folder");
  });
  EXPECT_ANY_THROW({
    Files files;
    files.add_output("new");
    files.add_folder("new/constant/polyMesh");
  });
  Files files;
  files.add_input("a");
  files.add_output("folder2");
  files.add_folder("folder/inner");
  files.add_output("folder/x");
}

TEST_F(FilesTest, AnyFileOfASeriesIsAnOutput) {
  for (const auto* path : {"folder/flow-0000010.hdf", "other/flow-0000010.hdf", "folder/flow-12345678.hdf"}) {
    EXPECT_THAT(
        [&] {
          Files files;
          files.add_input(path);
          files.add_series(series("folder/flow", 7));
        },
        ThrowsMessage<Error>(HasSubstr(std::string("the same file as the input ") + path)));
    EXPECT_ANY_THROW({
      Files files;
      files.add_series(series("folder/flow", 7));
      files.add_output(path);
    });
  }
  EXPECT_THAT(
      [&] {
        Files files;
        files.add_series(series("x", 7));
        files.add_series(series("./x", 1));
      },
      ThrowsMessage<Error>(HasSubstr("x-1000000.hdf: expected an output of its own")));
  Files files;
  files.add_input("flow-10.hdf");
  files.add_input("flow-0000010.vtu");
  files.add_input("folder/flow-0000010.hdf");
  files.add_input("flow-.hdf");
  files.add_series(series("flow", 7));
  files.add_series(series("flow2", 7));
}

TEST_F(FilesTest, AFileOfASeriesMayReplaceTheInputThatItIsSaidToReplace) {
  Files files;
  files.add_input("c-500.hdf");

  EXPECT_NO_THROW(files.add_series(series("c", 1), "c-500.hdf"));
}

TEST_F(FilesTest, ExistingFilesOfASeriesComeByNumber) {
  for (const auto* name : {"s-9.hdf", "s-10.hdf", "s-100.hdf", "s-010.hdf", "s-11.vtu", "t-12.hdf"})
    std::ofstream(name) << "";

  EXPECT_THAT(existing_files(series("s", 1), 10), ElementsAre("s-10.hdf", "s-100.hdf"));
  EXPECT_THAT(existing_files(series("missing/s", 1), 0), ElementsAre());
}

}  // namespace files_test
}  // namespace pamr::cli
