// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/report/level_plot.hpp"

#include <gmock/gmock.h>

#include <string>

namespace pamr::poisson_boltzmann {
namespace level_plot_test {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// Numbers of an attribute in the order of the text, of elements that have `with`.
std::vector<double> numbers(const std::string& text, const std::string& with, const std::string& name) {
  std::vector<double> result;
  for (auto at = text.find(with); at != std::string::npos; at = text.find(with, at + 1))
    result.push_back(std::stod(text.substr(text.find(name + "=\"", at) + name.size() + 2)));
  return result;
}

TEST(LevelPlot, HasAPanelForEachQuantityAndAPointForEachOfItsLevels) {
  const std::vector<Level> levels{
      {1000, 300, {{"a<b", "charge", 2, 0.5, true}, {"", "energy", -1, std::nullopt, true}}},
      {10000, 2000, {{"a<b", "charge", 2.5, 0.25, true}, {"", "energy", -1.1, 0.1, true}}},
      {100000, 20000, {{"a<b", "charge", 2.25, 0.125, true}}},
  };

  const auto text = levels_svg(levels);

  EXPECT_EQ(count(text, ">a&lt;b: charge<"), 1);
  EXPECT_EQ(count(text, ">energy<"), 1);
  EXPECT_EQ(count(text, "<circle"), 5);
  EXPECT_EQ(count(text, "fill=\"white\" stroke"), 1);         // without a bar
  EXPECT_EQ(count(text, "stroke=\"#1f4e8c\"/>") - 5, 3 * 4);  // a bar and its two ends
  // Equal steps for equal factors; twice the height for twice the value.
  const auto x = numbers(text, "<circle", "cx"), y = numbers(text, "<circle", "cy");
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.2);
  EXPECT_GT(x[1], x[0]);
  EXPECT_NEAR(y[0] - y[1], 2 * (y[0] - y[2]), 0.3);
  EXPECT_GT(y[0], y[1]);
  const auto first = text.substr(0, text.find(">energy<"));
  const auto low = numbers(first, "<line", "y1"), high = numbers(first, "<line", "y2");
  double longest = 0;
  for (std::size_t k = 0; k < low.size(); ++k) longest = std::max(longest, low[k] - high[k]);
  EXPECT_NEAR(longest, 2 * (y[0] - y[1]), 0.3);  // +- 0.5 beside a difference of 0.5
}

TEST(LevelPlot, DrawsOneLevelAndValuesThatAreEqual) {
  for (const double value : {0.0, -3e-20, 1e15}) {
    const auto text = levels_svg({{96, 50, {{"wall", "charge", value, 0.0, true}}}});
    EXPECT_EQ(count(text, "<circle"), 1);
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("nan")));
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("inf")));
  }
  EXPECT_THAT(levels_svg({{96, 50, {}}}), testing::HasSubstr("</svg>"));
}

}  // namespace level_plot_test
}  // namespace pamr::poisson_boltzmann
