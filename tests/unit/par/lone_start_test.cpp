// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/lone_start.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "pamr/base/process.hpp"

namespace pamr::par {
namespace lone_start_test {

namespace fs = std::filesystem;

/// The environment of a test, without what the launcher of the tests and their settings have put there.
class LoneStartTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (char** entry = environ; *entry != nullptr; ++entry) before_.emplace_back(*entry);
    clearenv();
  }
  void TearDown() override {
    clearenv();
    for (const auto& entry : before_) {
      const auto end = entry.find('=');
      setenv(entry.substr(0, end).c_str(), entry.substr(end + 1).c_str(), 1);
    }
  }
  static std::string value(const char* name) {
    const char* text = std::getenv(name);
    return text == nullptr ? "" : text;
  }

 private:
  std::vector<std::string> before_;
};

TEST_F(LoneStartTest, AsksForNoDaemonAndNoNetworkWhileItLives) {
  {
    const LoneStart alone;
    EXPECT_EQ(value("OMPI_MCA_ess_singleton_isolated"), "1");
    EXPECT_EQ(value("OMPI_MCA_btl"), "self");
    EXPECT_EQ(value("OMPI_MCA_pml"), "ob1");
  }

  for (const auto* name : {"OMPI_MCA_ess_singleton_isolated", "OMPI_MCA_btl", "OMPI_MCA_pml", "OMPI_MCA_osc",
                           "OMPI_MCA_orte_jobfam_session_dir"})
    EXPECT_EQ(std::getenv(name), nullptr) << "a program started later inherits " << name;
}

TEST_F(LoneStartTest, EachHasAFolderOfItsOwn) {
  setenv("TMPDIR", "/var/tmp", 1);
  std::string first, second;
  {
    const LoneStart alone;
    first = value("OMPI_MCA_orte_jobfam_session_dir");
  }
  {
    const LoneStart alone;
    second = value("OMPI_MCA_orte_jobfam_session_dir");
  }

  EXPECT_NE(first, second);
  for (const auto& folder : {first, second}) EXPECT_TRUE(folder.starts_with("/var/tmp/ompi.alone.")) << folder;
}

TEST_F(LoneStartTest, RemovesFoldersOfThisUsersProcessesThatHaveEnded) {
  std::string here = (fs::temp_directory_path() / "lone XXXXXX").string();
  ASSERT_NE(mkdtemp(here.data()), nullptr);
  const auto child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  const auto us = this_process();
  const auto folder_of = [&](std::uint64_t machine, std::uint64_t process, std::uint64_t start) {
    return fs::path(here) / fmt::format("ompi.alone.{}.{:08x}-{}-{}.abc", getuid(), machine, process, start);
  };
  const auto dead = folder_of(us.machine, static_cast<std::uint64_t>(child), 7);
  const std::vector<fs::path> to_stay{folder_of(us.machine, us.process, us.start),
                                      folder_of(us.machine ^ 1U, static_cast<std::uint64_t>(child), 7),
                                      dead.string() + ".txt", fs::path(here) / "ompi.alone.mine"};
  fs::create_directories(dead / "1/0");
  for (const auto& folder : to_stay) fs::create_directories(folder);
  setenv("TMPDIR", here.c_str(), 1);

  const LoneStart alone;

  EXPECT_FALSE(fs::exists(dead));
  for (const auto& folder : to_stay) EXPECT_TRUE(fs::exists(folder)) << folder;
  fs::remove_all(here);
}

TEST_F(LoneStartTest, KeepsWhatTheUserHasSet) {
  setenv("OMPI_MCA_btl", "tcp,self", 1);
  {
    const LoneStart alone;
    EXPECT_EQ(value("OMPI_MCA_btl"), "tcp,self");
    EXPECT_EQ(value("OMPI_MCA_pml"), "ob1");
  }

  EXPECT_EQ(value("OMPI_MCA_btl"), "tcp,self");
}

TEST_F(LoneStartTest, LeavesProcessesOfALauncherAlone) {
  for (const auto* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_FD", "SLURM_PROCID"}) {
    setenv(name, "0", 1);
    const LoneStart alone;
    EXPECT_EQ(value("OMPI_MCA_btl"), "") << name;
    unsetenv(name);
  }
}

}  // namespace lone_start_test
}  // namespace pamr::par
