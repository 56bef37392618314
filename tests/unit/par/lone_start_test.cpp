// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/lone_start.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace pamr::par {
namespace lone_start_test {

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
