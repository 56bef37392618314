// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/partial_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/partial_folder.hpp"
#include "pamr/io/unfinished_name.hpp"
#include "size_limit.hpp"

namespace pamr {
namespace partial_file_test {

namespace fs = std::filesystem;
using test::Folder;
using test::SizeLimit;

/// Every rank alone, in a folder of its own.
class UnfinishedFiles : public testing::Test {
 protected:
  UnfinishedFiles() { fs::create_directory(here_); }

  fs::path operator/(const std::string& name) const { return here_ / name; }
  std::size_t n_entries() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(here_), {})); }
  static std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

  const par::Comm comm_{MPI_COMM_WORLD};
  const Folder folder_{comm_};
  const fs::path here_ = folder_ / std::to_string(comm_.rank());
};

using PartialFile = UnfinishedFiles;
using PartialFolder = UnfinishedFiles;
using Leftovers = UnfinishedFiles;

/// The number of a process that has ended.
pid_t a_dead_process() {
  const auto child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

/// The name with this instead of the n-th part from the end: 1 number, 2 start, 3 process, 4 machine.
fs::path with_part(fs::path name, int n, const std::string& part) {
  auto text = name.string();
  text.resize(text.size() - std::string(".partial").size());
  auto end = text.size();
  for (; n > 1; --n) end = text.rfind('-', end - 1);
  const auto begin = text.rfind('-', end - 1) + 1;
  return text.substr(0, begin) + part + text.substr(end) + ".partial";
}

TEST_F(PartialFile, OfTwoWritersAreTwoFilesAndTheLastOneToEndWins) {
  io::PartialFile a(*this / "out"), b(*this / "out");
  a.make(0);
  b.make(0);

  a.write("a, longer than the other");
  b.write("b");
  a.commit();

  EXPECT_EQ(text_of(*this / "out"), "a, longer than the other");
  b.commit();
  EXPECT_EQ(text_of(*this / "out"), "b");
  EXPECT_EQ(n_entries(), 1U);
}

TEST_F(PartialFile, LeavesAloneWhateverHasANameLikeIt) {
  write(*this / "precious", "precious");
  write(*this / "out.partial", "mine");
  io::PartialFile first(*this / "out");
  first.make(0);
  const auto number = first.path().string();
  const auto last = static_cast<std::size_t>(number.rfind('-')) + 1;
  const auto next = fmt::format("{}{}.partial", number.substr(0, last), std::stoul(number.substr(last)) + 1);
  fs::create_symlink(*this / "precious", next);

  io::PartialFile second(*this / "out");

  EXPECT_THROW(second.make(0), Error);  // a link has the name that comes next: exclusive means that it is refused
  EXPECT_EQ(text_of(*this / "precious"), "precious");
  EXPECT_EQ(text_of(*this / "out.partial"), "mine");
  EXPECT_TRUE(fs::is_symlink(next));
}

TEST_F(PartialFile, HasTheRightsOfTheFileThatItReplaces) {
  const auto rights_of = [](const fs::path& path) { return fs::status(path).permissions(); };
  for (const auto mode : {0600, 0640, 0444, 0666}) {
    write(*this / "out", "old");
    fs::permissions(*this / "out", static_cast<fs::perms>(mode));
    io::PartialFile file(*this / "out");
    file.make(0);
    EXPECT_EQ(rights_of(file.path()), fs::perms{0600}) << "read by others before it is complete";
    file.write("new");
    file.commit();
    EXPECT_EQ(rights_of(*this / "out"), static_cast<fs::perms>(mode));
    EXPECT_EQ(text_of(*this / "out"), "new");
  }
  write(*this / "plain", "");
  io::PartialFile file(*this / "another");
  file.make(0);
  file.commit();
  EXPECT_EQ(rights_of(*this / "another"), rights_of(*this / "plain")) << "a new file has those of any new file";
}

TEST_F(PartialFolder, HasTheRightsOfTheFolderThatItReplacesAndSoHaveTheFilesInIt) {
  const auto rights_of = [](const fs::path& path) { return fs::status(path).permissions(); };
  fs::create_directory(*this / "out");
  write(*this / "out/points", "old");
  fs::permissions(*this / "out/points", fs::perms{0600});
  fs::permissions(*this / "out", fs::perms{0750});
  io::PartialFolder folder(*this / "out");
  folder.make();
  write(folder.path() / "points", "new");
  write(folder.path() / "faces", "new");

  folder.commit();

  EXPECT_EQ(rights_of(*this / "out"), fs::perms{0750});
  EXPECT_EQ(rights_of(*this / "out/points"), fs::perms{0600});
  EXPECT_EQ(text_of(*this / "out/points"), "new");
}

TEST_F(Leftovers, OfASeriesGoWithoutTheirNumbersBeingKnown) {
  const auto owner = with_part(io::unfinished_name(*this / "c-50.hdf"), 3, std::to_string(a_dead_process()));
  const auto other = with_part(io::unfinished_name(*this / "d-50.hdf"), 3, std::to_string(a_dead_process()));
  const auto alive = io::unfinished_name(*this / "c-60.hdf");
  for (const auto& file : {owner, other, alive}) write(file, "");

  io::remove_leftovers(*this / "",
                       [](const std::string& name, bool is_cut) { return !is_cut && name.starts_with("c-"); }, {});

  EXPECT_FALSE(fs::exists(owner));
  EXPECT_TRUE(fs::exists(other));
  EXPECT_TRUE(fs::exists(alive));
}

TEST_F(PartialFile, GoesWithoutCommit) {
  {
    io::PartialFile file(*this / "out");
    file.make(10);
    EXPECT_EQ(n_entries(), 1U);
  }
  EXPECT_EQ(n_entries(), 0U);
}

TEST_F(PartialFile, IsNotRenamedWhenItIsAnotherOne) {
  io::PartialFile file(*this / "out");
  file.make(10);
  fs::remove(file.path());
  write(file.path(), "something else");

  EXPECT_THROW(file.commit(), Error);
  EXPECT_FALSE(fs::exists(*this / "out"));
}

TEST_F(PartialFile, GoesWhenTheProcessIsInterrupted) {
  io::PartialFile file(*this / "out");
  file.make(10);

  io::remove_unfinished();

  EXPECT_EQ(n_entries(), 0U);
}

TEST_F(PartialFile, HasAShorterNameWhereTheNameIsAsLongAsItMayBe) {
  std::string name;
  while (name.size() < 254) name += "\xc3\xa9";
  io::PartialFile file(*this / name);

  file.make(0);
  const auto unfinished = file.path().filename().string();
  file.commit();

  EXPECT_LE(unfinished.size(), 255U);
  EXPECT_TRUE(fs::exists(*this / name));
  const auto dead = with_part(*this / unfinished, 3, std::to_string(a_dead_process()));
  write(dead, "");
  if (dead.filename().string().size() + 4 <= 255) return;  // the number has fewer digits: taken for a name in full
  io::remove_leftovers(*this / name, {});
  EXPECT_FALSE(fs::exists(dead));
}

TEST_F(PartialFile, FindsTheDiskFullByWritingWhereTheFileSystemCannotTell) {
  io::PartialFile file(*this / "a");
  file.make(100);

  const SizeLimit limit(5000000);

  EXPECT_NO_THROW(file.occupy(0, 5000000));
  EXPECT_THROW(file.occupy(0, 5000001), Error);
  EXPECT_EQ(fs::file_size(file.path()), 5000000U);
}

TEST_F(Leftovers, OfDeadProcessesAreRemoved) {
  const auto ours = io::unfinished_name(*this / "out");
  const auto dead = with_part(ours, 3, std::to_string(a_dead_process())), recycled = with_part(ours, 2, "1");
  const auto folder = with_part(recycled, 1, "77");
  for (const auto& file : {ours, dead, recycled}) write(file, "half");
  fs::create_directories(folder / "inner");

  io::remove_leftovers(*this / "out", {});

  EXPECT_TRUE(fs::exists(ours));
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_FALSE(fs::exists(recycled));  // another process has the number now
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(Leftovers, OfOtherMachinesAreRemovedWhenNothingWasWrittenForADay) {
  const auto theirs = with_part(io::unfinished_name(*this / "out"), 4, "00c0ffee");
  write(theirs, "half");

  io::remove_leftovers(*this / "out", {});

  EXPECT_TRUE(fs::exists(theirs));
  fs::last_write_time(theirs, fs::file_time_type::clock::now() - std::chrono::hours(25));
  io::remove_leftovers(*this / "out", {});
  EXPECT_FALSE(fs::exists(theirs));
}

TEST_F(Leftovers, AreNothingElse) {
  const auto dead = with_part(io::unfinished_name(*this / "out"), 3, std::to_string(a_dead_process()));
  const auto other = with_part(io::unfinished_name(*this / "out.b"), 3, std::to_string(a_dead_process()));
  const auto link = with_part(dead, 1, "78");
  fs::create_symlink(*this / "target", link);
  for (const auto* name : {"target", "out", "out.partial", "out.x.partial", "out.1-2-3-4.partial",
                           "out.h-g-1-2-3.partial", "out.h-1-1-2-.partial"})
    write(*this / name, "mine");
  write(dead, "half");
  write(other, "half");
  const auto before = n_entries();

  io::remove_leftovers(*this / "out", {dead.string()});

  EXPECT_EQ(n_entries(), before);  // an input stays as well
}

TEST_F(PartialFolder, ReplacesOneThatIsThere) {
  fs::create_directory(*this / "out");
  write(*this / "out" / "old", "");
  {
    io::PartialFolder folder(*this / "out");
    folder.make();
    write(folder.path() / "new", "");
    folder.commit();
  }
  EXPECT_EQ(n_entries(), 1U);
  EXPECT_TRUE(fs::exists(*this / "out" / "new"));
  EXPECT_FALSE(fs::exists(*this / "out" / "old"));
}

TEST_F(PartialFolder, OfTwoWritersAreTwoFoldersAndTheLastOneToEndWins) {
  io::PartialFolder a(*this / "case" / "out"), b(*this / "case" / "out");
  a.make();
  b.make();
  write(a.path() / "a", "");
  write(b.path() / "b", "");

  a.commit();
  b.commit();

  EXPECT_TRUE(fs::exists(*this / "case" / "out" / "b"));
  EXPECT_FALSE(fs::exists(*this / "case" / "out" / "a"));
  EXPECT_EQ(std::distance(fs::directory_iterator(*this / "case"), {}), 1);
}

TEST_F(PartialFolder, GoesWithoutCommitAndSoDoTheFoldersMadeForIt) {
  {
    io::PartialFolder folder(*this / "case" / "constant" / "out");
    folder.make();
    write(folder.path() / "half", "");
  }
  EXPECT_EQ(n_entries(), 0U);
  {
    io::PartialFolder folder(*this / "case" / "constant" / "out");
    folder.make();
    write(*this / "case" / "mine", "");
  }
  EXPECT_TRUE(fs::exists(*this / "case" / "mine"));
  EXPECT_FALSE(fs::exists(*this / "case" / "constant"));
}

TEST_F(PartialFolder, GoesWhenTheProcessIsInterrupted) {
  io::PartialFolder folder(*this / "case" / "constant" / "out");
  folder.make();
  folder.hold({"whole", "not begun"});
  io::PartialFile whole(folder.path() / "whole");
  whole.make(10);
  whole.commit();
  io::PartialFile file(folder.path() / "half");
  file.make(10);

  io::remove_unfinished();

  EXPECT_EQ(n_entries(), 0U);
}

}  // namespace partial_file_test
}  // namespace pamr
