// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/gate.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "pamr/base/error.hpp"
#include "pamr/check/report_text.hpp"

namespace pamr::check {
namespace gate_test {

check::QualityReport example() {
  check::QualityReport report;
  report.cells = 6;
  report.conforming = true;
  report.patches.push_back({"wall, left", "sphere", 2, 0.5, 1e-13, 0});
  check::MetricReport metric;
  metric.min = 0.25;
  metric.mean = 0.5;
  metric.max = 0.75;
  for (const auto& name : check::metric_names()) {
    metric.name = name;
    report.metrics.push_back(metric);
  }
  report.metrics[2].max = std::numeric_limits<double>::infinity();
  return report;
}

std::string failure(const std::string& gate) { return why_failed(parse_gate(gate), numbers_of(to_json(example()))); }

TEST(ParseGate, TakesTheLastTwoPartsOff) {
  const auto gate = parse_gate("patches.a:b.area:max:-1.5e3");

  EXPECT_EQ(gate.name, "patches.a:b.area");
  EXPECT_EQ(gate.kind, Gate::Kind::max);
  EXPECT_EQ(gate.bound, -1500);
}

TEST(ParseGate, RefusesEverythingElse) {
  for (const char* text : {"", "cells", "cells:min", "cells:min:", "cells:min:x", "cells:min:1x", "cells:least:1",
                           ":min:1", "cells:1", "cells:min:nan", "cells:min:inf"})
    EXPECT_THROW(parse_gate(text), Error) << text;
}

TEST(WhyFailed, ComparesNumbersByTheirPath) {
  EXPECT_EQ(failure("cells:min:6"), "");
  EXPECT_EQ(failure("cells:max:6"), "");
  EXPECT_NE(failure("cells:max:5").find("cells is 6"), std::string::npos);
  EXPECT_EQ(failure("patches.wall, left.worst_distance:max:1e-12"), "");
  EXPECT_NE(failure("patches.wall, left.worst_distance:max:1e-14"), "");
  EXPECT_EQ(failure("conforming:min:1"), "");
  EXPECT_NE(failure("neighbors_consistent:min:1"), "");
}

TEST(WhyFailed, TakesAMetricsNameForItsExtreme) {
  EXPECT_EQ(failure("mean_ratio:min:0.25"), "");
  EXPECT_NE(failure("mean_ratio:min:0.26"), "");
  EXPECT_EQ(failure("mean_ratio:max:0.75"), "");
  EXPECT_NE(failure("mean_ratio:max:0.74"), "");
  EXPECT_EQ(failure("mean_ratio.mean:max:0.5"), "");
  EXPECT_NE(failure("aspect_ratio:max:1e300"), "");
}

TEST(WhyFailed, RefusesUnknownNames) {
  for (const char* text :
       {"roundness:min:1", "patches.nose.area:min:0", "mean_ratio.median:min:0", "fingerprint:min:0"})
    EXPECT_THROW(failure(text), Error) << text;
}

TEST(ToJson, HasTheKeysOfTheManual) {
  const auto json = to_json(example());

  for (const char* key : {"cells", "nodes", "volume", "patches", "inverted_cells", "conforming", "neighbors_consistent",
                          "fingerprint", "radius_ratio", "mean_ratio", "aspect_ratio", "min_dihedral", "max_dihedral"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["mean_ratio"]["histogram"]["counts"].size(), 50U);
  EXPECT_EQ(json["mean_ratio"]["histogram"]["edges"].size(), 51U);
}

TEST(ToCsv, QuotesNamesWithCommas) {
  const auto text = to_csv({{"a.hdf", example()}, {"b,\"c\".hdf", example()}});

  EXPECT_EQ(text.substr(0, 5), "file,");
  EXPECT_NE(text.find("\"patches.wall, left.area\""), std::string::npos);
  EXPECT_NE(text.find("\n\"b,\"\"c\"\".hdf\","), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
}

}  // namespace gate_test
}  // namespace pamr::check
