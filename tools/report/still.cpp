// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/still.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/mesh/tet.hpp"
#include "report/camera.hpp"
#include "report/png.hpp"

namespace pamr::report {

namespace {

using geometry::Vec3;
using Rgb = std::array<double, 3>;

constexpr int width = picture_width, height = picture_height, fineness = 2;  // samples a side of a pixel
constexpr double edge_width = 1.2 * fineness;                                // to its end, in samples
constexpr double full_height = 10.0 * fineness;  // of a triangle whose edges have their full color
constexpr double edge_strength = 0.62;
constexpr Rgb edge_color{0x1d, 0x24, 0x30};
constexpr double before_section = 2.5;  // as in page/view.js: a section is looked at more along its axis
constexpr std::size_t cut_axis = 1;

Rgb color_of(std::string_view text) {
  Rgb color{};
  for (std::size_t i = 0; i < 3; ++i) color[i] = std::stoi(std::string(text.substr(1 + 2 * i, 2)), nullptr, 16);
  return color;
}

struct Triangle {
  std::array<Vec3, 3> corner;
  Rgb color{};
  bool is_lit = true;
  int inner = -1;  ///< the corner opposite an edge that is not drawn
};

/// Colors and depths of the samples.
struct Canvas {
  int columns = width * fineness, rows = height * fineness;
  std::vector<Rgb> color = std::vector<Rgb>(at(columns) * at(rows));
  std::vector<double> depth = std::vector<double>(color.size(), 0.0);  ///< inverse distance; 0: nothing
};

/// How much of an edge's color a sample has, by its distances from the three edges of its triangle, in samples.
double edge_part(const std::array<double, 3>& away, int inner, double min_height) {
  double nearest = edge_width;
  for (std::size_t i = 0; i < 3; ++i)
    if (static_cast<int>(i) != inner) nearest = std::min(nearest, away[i]);
  const double t = nearest / edge_width;
  return edge_strength * std::min(min_height / full_height, 1.0) * (1 - t * t * (3 - 2 * t));
}

/// `cut`: position on `cut_axis` in front of which nothing is drawn.
void draw(Canvas& canvas, const Triangle& triangle, const Camera& camera, int left, int columns, double cut) {
  auto [x, y, inverse] = project(triangle.corner, camera);
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = left + columns * x[i];
    y[i] *= canvas.rows;
  }
  const double twice_area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  if (!(std::abs(twice_area) > 1e-9)) return;
  std::array<double, 3> high{};  // of the triangle over each edge, in samples
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t a = (i + 1) % 3, b = (i + 2) % 3;
    high[i] = std::abs(twice_area) / std::hypot(x[b] - x[a], y[b] - y[a]);
  }
  const double least = *std::min_element(high.begin(), high.end());
  const auto& p = triangle.corner;
  const auto normal = cross(p[1] - p[0], p[2] - p[0]);
  const double facing = std::abs(dot(normal, camera.toward)) / std::max(norm(normal), 1e-300);
  const double light = triangle.is_lit ? 0.62 + 0.38 * facing : 1;
  const auto first = [](const std::array<double, 3>& v, int low) {
    return std::max(static_cast<int>(std::ceil(*std::min_element(v.begin(), v.end()) - 0.5)), low);
  };
  const auto last = [](const std::array<double, 3>& v, int end) {
    return std::min(static_cast<int>(std::floor(*std::max_element(v.begin(), v.end()) - 0.5)), end - 1);
  };
  for (int row = first(y, 0); row <= last(y, canvas.rows); ++row)
    for (int column = first(x, left); column <= last(x, left + columns); ++column) {
      const double u = column + 0.5, v = row + 0.5;
      std::array<double, 3> part{}, away{};
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t a = (i + 1) % 3, b = (i + 2) % 3;
        part[i] = ((x[a] - u) * (y[b] - v) - (x[b] - u) * (y[a] - v)) / twice_area;
        away[i] = part[i] * high[i];
      }
      if (std::min({part[0], part[1], part[2]}) < 0) continue;
      double near = 0, along = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        near += part[i] * inverse[i];
        along += part[i] * inverse[i] * p[i][cut_axis];
      }
      const auto sample = at(row) * at(canvas.columns) + at(column);
      if (near <= canvas.depth[sample] || along / near < cut) continue;
      canvas.depth[sample] = near;
      const double line = edge_part(away, triangle.inner, least);
      for (std::size_t c = 0; c < 3; ++c)
        canvas.color[sample][c] = (1 - line) * light * triangle.color[c] + line * edge_color[c];
    }
}

/// The triangles of a mesh that the first view has.
class Triangles {
 public:
  Triangles(const check::MeshView& view, const FirstView& first, const std::vector<std::string>& names)
      : view_(&view), middle_(view.box.center()) {
    const auto& level = view.faces.columns.front().value;
    for (std::size_t face = 0; face < view.faces.node.size(); ++face) {
      const auto& name = view.patches[at(view.faces.patch[face])].name;
      if (std::find(first.hidden.begin(), first.hidden.end(), name) != first.hidden.end()) continue;
      const auto number = std::find(names.begin(), names.end(), name) - names.begin();
      const auto& n = view.faces.node[face];
      triangle.push_back({{point(n[0]), point(n[1]), point(n[2])},
                          first.color == "patch" ? color_of(patch_colors[at(number) % patch_colors.size()])
                                                 : level_color(level[face])});
    }
    if (first.show == "y") cut();
  }

  std::vector<Triangle> triangle;

 private:
  Vec3 point(std::int64_t node) const { return view_->nodes.position[at(node)] - middle_; }
  static Rgb level_color(double level) {
    return color_of(level_colors[static_cast<std::size_t>(level) % level_colors.size()]);
  }

  /// Adds what the plane through the middle cuts of the cells: as sectionOf() of page/sections.js.
  void cut() {
    const auto& level = view_->cells.columns.front().value;
    for (std::size_t cell = 0; cell < view_->cells.node.size(); ++cell) {
      std::vector<Vec3> p;
      for (const auto [i, k] : mesh::tet::edge_to_corner) {
        const auto a = point(view_->cells.node[cell][at(i)]), b = point(view_->cells.node[cell][at(k)]);
        const double here = a[cut_axis], there = b[cut_axis];
        if ((here >= 0) != (there >= 0)) p.push_back(a + (here / (here - there)) * (b - a));
      }
      const auto color = level_color(level[cell]);
      if (p.size() == 3) triangle.push_back({{p[0], p[1], p[2]}, color, false});
      if (p.size() != 4) continue;
      triangle.push_back({{p[0], p[1], p[3]}, color, false, 1});
      triangle.push_back({{p[0], p[3], p[2]}, color, false, 2});
    }
  }

  const check::MeshView* view_;
  Vec3 middle_;
};

std::string png_of(const Canvas& canvas) {
  std::vector<unsigned char> pixels;
  pixels.reserve(std::size_t{4} * width * height);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      Rgb sum{};
      int n = 0;
      for (int k = 0; k < fineness * fineness; ++k) {
        const auto sample =
            at(row * fineness + k / fineness) * at(canvas.columns) + at(column * fineness + k % fineness);
        if (canvas.depth[sample] == 0) continue;
        ++n;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += canvas.color[sample][c];
      }
      for (const double c : sum) pixels.push_back(static_cast<unsigned char>(std::lround(n == 0 ? 0 : c / n)));
      pixels.push_back(static_cast<unsigned char>(255 * n / (fineness * fineness)));
    }
  return png(width, height, pixels);
}

}  // namespace

std::string still_picture(const std::vector<ReportedMesh>& meshes, const FirstView& first) {
  const auto names = patch_names(meshes);
  const auto shown = first_meshes(meshes);
  const bool is_cut = first.show == "y";
  std::vector<Triangles> panels;
  std::vector<Vec3> points;
  for (const auto mesh : shown) {
    panels.emplace_back(meshes[mesh].view, first, names);
    for (const auto& triangle : panels.back().triangle)
      for (const auto p : triangle.corner)
        if (!is_cut || p[cut_axis] >= 0) points.push_back(p);
  }
  Canvas canvas;
  const int columns = canvas.columns / static_cast<int>(panels.size());
  auto direction = first.direction;
  if (is_cut) direction.from[cut_axis] *= before_section;
  Camera camera(direction, static_cast<double>(columns) / canvas.rows);
  camera.fit(points);
  const double cut = is_cut ? -1e-9 * camera.distance : -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < panels.size(); ++i)
    for (const auto& triangle : panels[i].triangle)
      draw(canvas, triangle, camera, static_cast<int>(i) * columns, columns, cut);
  return png_of(canvas);
}

}  // namespace pamr::report
