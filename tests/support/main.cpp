// SPDX-License-Identifier: GPL-3.0-or-later
/// Main function of every test program. On several ranks `--serial=FILE` leaves out the tests of that source, and
/// `--leave-out=PATTERN` those of these names. MPI is called directly here, so that the verdict does not rest on the
/// code under test.
#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace {

/// Rank 0 prints as GoogleTest does; the other ranks print their failures only. An exception that leaves a test on one
/// rank would leave the others waiting for ever, so it ends the job.
class RankListener : public testing::EmptyTestEventListener {
 public:
  RankListener(int rank, int size) : rank_(rank), size_(size) {}

  // GoogleTest holds a lock while it reports a failure, so the running test is remembered, not asked for.
  void OnTestStart(const testing::TestInfo& test) override { test_ = &test; }

  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed()) return;
    if (rank_ != 0) {
      std::fprintf(stderr, "[rank %d of %d] %s.%s %s:%d\n%s\n", rank_, size_, test_ ? test_->test_suite_name() : "?",
                   test_ ? test_->name() : "?", result.file_name() ? result.file_name() : "exception",
                   result.line_number(), result.message());
    }
    const bool is_exception = result.file_name() == nullptr;
    if (is_exception && size_ > 1) {
      std::fflush(nullptr);
      MPI_Abort(MPI_COMM_WORLD, 1);
    }
  }

 private:
  int rank_;
  int size_;
  const testing::TestInfo* test_ = nullptr;
};

void leave_out_serial_tests(int argc, char** argv) {
  std::string names;
  const std::string_view leave_out = "--leave-out=";
  for (const std::string_view argument : std::vector<std::string_view>(argv + 1, argv + argc))
    if (argument.starts_with(leave_out)) names += ":" + std::string(argument.substr(leave_out.size()));
  const auto& tests = *testing::UnitTest::GetInstance();
  for (int s = 0; s < tests.total_test_suite_count(); ++s)
    for (int t = 0; t < tests.GetTestSuite(s)->total_test_count(); ++t) {
      const auto& test = *tests.GetTestSuite(s)->GetTestInfo(t);
      const auto file = std::filesystem::path(test.file()).filename().string();
      if (std::any_of(argv + 1, argv + argc, [&](const char* argument) { return "--serial=" + file == argument; }))
        names += std::string(":") + test.test_suite_name() + "." + test.name();
    }
  auto filter = GTEST_FLAG_GET(filter);
  if (!names.empty()) GTEST_FLAG_SET(filter, filter + (filter.find('-') == filter.npos ? "-" : "") + names);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  testing::InitGoogleTest(&argc, argv);
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  auto& listeners = testing::UnitTest::GetInstance()->listeners();
  if (rank != 0) std::unique_ptr<testing::TestEventListener>(listeners.Release(listeners.default_result_printer()));
  listeners.Append(new RankListener(rank, size));  // GoogleTest owns it

  if (size > 1) leave_out_serial_tests(argc, argv);

  const int here = RUN_ALL_TESTS();

  int anywhere = 0;
  MPI_Allreduce(&here, &anywhere, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
#ifdef __SANITIZE_ADDRESS__
  // Now, while the plugins of MPI are loaded: what they leave cannot be told by name later (lsan.supp).
  __lsan_do_leak_check();
#endif
  MPI_Finalize();
  return anywhere;
}
