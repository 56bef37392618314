// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/report/level_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pamr::poisson_boltzmann {

namespace {

// Pixels: panels in two columns, and the axes within a panel.
constexpr double panel_width = 440, panel_height = 290, left = 92, right = 18, top = 34, bottom = 48, footer = 26;

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return result;
}

const char* unit_of(const std::string& quantity) {
  if (quantity.rfind("force", 0) == 0) return "\u03b5\u03b5\u2080(kT/Ze)\u00b2";
  return quantity == "charge" ? "\u03b5\u03b5\u2080(kT/Ze)/\u03ba" : "\u03b5\u03b5\u2080(kT/Ze)\u00b2/\u03ba";
}

struct Range {
  double low = HUGE_VAL, high = -HUGE_VAL;

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// With a margin on both sides, at least `least` wide.
  Range widened(double least) const {
    const double margin = std::max(0.08 * (high - low), 0.5 * (least - (high - low)));
    return {low - margin, high + margin};
  }
  double share(double value) const { return (value - low) / (high - low); }
};

/// 1, 2 or 5 times a power of ten that makes some five steps of a range.
double step_of(const Range& range) {
  const double rough = (range.high - range.low) / 5, power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (rough <= factor * power) return factor * power;
  return 10 * power;
}

std::string tick_text(double value, double step) {
  const int digits = static_cast<int>(std::floor(std::log10(step) + 1e-9));
  if (digits >= -7 && std::abs(value) < 1e6) return fmt::format("{:.{}f}", value + 0.0, std::max(0, -digits));
  const int places = value == 0 ? 0 : static_cast<int>(std::floor(std::log10(std::abs(value)))) - digits;
  return fmt::format("{:.{}e}", value, std::clamp(places, 0, 16));
}

/// One quantity over the levels.
class Panel {
 public:
  Panel(const std::vector<Level>& levels, const LevelValue& quantity, double x0, double y0)
      : quantity_(quantity), x0_(x0), y0_(y0) {
    for (const auto& level : levels)
      for (const auto& value : level.values)
        if (value.of == quantity.of && value.quantity == quantity.quantity)
          points_.push_back({static_cast<double>(level.cells), value.value, value.error});
    Range cells;
    for (const auto& level : levels) cells.add(std::log10(static_cast<double>(level.cells)));
    cells_ = cells.widened(0.5);
    for (const auto& point : points_)
      for (const double sign : {-1.0, 1.0}) values_.add(point.value + sign * point.error.value_or(0));
    const double size = std::max(std::abs(values_.low), std::abs(values_.high));
    values_ = values_.widened(size > 0 ? 1e-9 * size : 1e-9);
  }

  std::string svg() {
    text_ = fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
        "stroke=\"#555\"/>\n",
        x0_ + left, y0_ + top, panel_width - left - right, panel_height - top - bottom);
    write(x0_ + (panel_width + left - right) / 2, y0_ + top - 12, "middle",
          quantity_.of.empty() ? quantity_.quantity : quantity_.of + ": " + quantity_.quantity,
          " font-weight=\"bold\"");
    draw_ticks();
    draw_points();
    return text_;
  }

 private:
  struct Point {
    double cells, value;
    std::optional<double> error;
  };

  double x(double cells) const { return x0_ + left + (panel_width - left - right) * cells_.share(std::log10(cells)); }
  double y(double value) const {
    return y0_ + panel_height - bottom - (panel_height - top - bottom) * values_.share(value);
  }
  void line(double x1, double y1, double x2, double y2, const char* stroke) {
    text_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2,
                         y2, stroke);
  }
  void write(double at_x, double at_y, const char* anchor, const std::string& words, const std::string& more = "") {
    text_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", at_x, at_y, anchor, more,
                         escaped(words));
  }

  void draw_ticks() {
    const double step = step_of(values_), floor = y0_ + panel_height - bottom, wall = x0_ + left;
    for (double k = std::ceil(values_.low / step); k * step <= values_.high; ++k) {
      line(wall, y(k * step), wall + 5, y(k * step), "#555");
      write(wall - 6, y(k * step) + 4, "end", tick_text(k * step, step));
    }
    for (double power = std::pow(10, std::floor(cells_.low)); power <= std::pow(10, cells_.high); power *= 10)
      for (int digit = 1; digit <= 9; ++digit) {
        const double cells = digit * power, share = cells_.share(std::log10(cells));
        if (share < 0 || share > 1) continue;
        const bool has_text = digit == 1 || (cells_.high - cells_.low < 1.7 && (digit == 2 || digit == 5));
        line(x(cells), floor, x(cells), floor - (has_text ? 7 : 4), "#555");
        if (has_text) write(x(cells), floor + 16, "middle", fmt::format("{:.7g}", cells));
      }
    write(x0_ + (panel_width + left - right) / 2, floor + 36, "middle", "cells");
    const double label_x = x0_ + 14, label_y = y0_ + (panel_height + top - bottom) / 2;
    write(label_x, label_y, "middle", fmt::format("{} / {}", quantity_.quantity, unit_of(quantity_.quantity)),
          fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", label_x, label_y));
  }

  void draw_points() {
    std::string path;
    for (const auto& point : points_) path += fmt::format("{:.1f},{:.1f} ", x(point.cells), y(point.value));
    text_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"#9bb7d4\"/>\n", path);
    for (const auto& [cells, value, error] : points_) {
      if (error) {
        line(x(cells), y(value - *error), x(cells), y(value + *error), "#1f4e8c");
        for (const double end : {value - *error, value + *error})
          line(x(cells) - 4, y(end), x(cells) + 4, y(end), "#1f4e8c");
      }
      text_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\" stroke=\"#1f4e8c\"/>\n", x(cells),
                           y(value), error ? "#1f4e8c" : "white");
    }
  }

  const LevelValue& quantity_;
  double x0_, y0_;
  std::vector<Point> points_;
  Range cells_, values_;
  std::string text_;
};

}  // namespace

std::string levels_svg(const std::vector<Level>& levels) {
  const auto quantities = all_quantities(levels);
  const auto n_columns = std::min<std::size_t>(2, std::max<std::size_t>(1, quantities.size()));
  const auto n_rows = (quantities.size() + n_columns - 1) / n_columns;
  const double width = panel_width * static_cast<double>(n_columns);
  const double height = panel_height * static_cast<double>(n_rows) + footer;
  auto text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      width, height);
  for (std::size_t k = 0; k < quantities.size(); ++k) {
    const std::size_t row = k / n_columns, column = k % n_columns;
    text +=
        Panel(levels, quantities[k], panel_width * static_cast<double>(column), panel_height * static_cast<double>(row))
            .svg();
  }
  text += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\">Vertical lines: error bars; open points have none.</text>\n",
                      left, height - 10);
  return text + "</svg>\n";
}

}  // namespace pamr::poisson_boltzmann
