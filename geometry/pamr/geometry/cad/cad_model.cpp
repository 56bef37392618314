// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/cad_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

constexpr double edge_sagitta = 1e-3;  // of the size: chords of edges, as seeds
constexpr double max_gap = 1e-3;       // of the size: edges farther from their faces are no edges of them

}  // namespace

CadModel::CadModel(CadData data)
    : n_solids_(data.n_solids), unit_of_file_(std::move(data.unit_of_file)), origin_(std::move(data.origin)) {
  if (data.faces.empty()) throw Error("expected a shape with faces, found none");
  Box box;
  for (const auto& face : data.faces)
    for (const auto uv : face.sample) box.extend(face.surface->point(uv));
  size_ = box.diagonal();
  magnitude_ = std::max(largest_coordinate(box.low), largest_coordinate(box.high));
  if (!(size_ > 0 && size_ < 1e300)) throw Error(fmt::format("expected a shape of finite size, found {}", size_));
  edges_.reserve(data.edges.size());
  for (auto& edge : data.edges) edges_.emplace_back(std::move(edge), edge_sagitta * size_, size_);
  for (const auto& edge : edges_)
    for (std::size_t k = 0; k < 2; ++k) {
      if (edge.data().vertex[k] < 0) continue;
      const double gap =
          norm((k == 0 ? edge.points().front() : edge.points().back()) - data.vertices[at(edge.data().vertex[k])]);
      if (!(gap <= max_gap * size_))
        throw Error(fmt::format("expected edges that end at their vertices, found one that is {:.3g} off", gap));
    }
  // corners are the ends of the last edges there, as they were before the others were joined to them
  auto corner = data.vertices;
  const auto for_each_end = [this](auto visit) {
    for (auto& edge : edges_)
      for (std::size_t k = 0; k < 2; ++k)
        if (edge.data().vertex[k] >= 0) visit(edge, k, at(edge.data().vertex[k]));
  };
  for_each_end([&](const CadEdge& edge, std::size_t k, std::size_t vertex) {
    corner[vertex] = k == 0 ? edge.points().front() : edge.points().back();
  });
  for_each_end([&](CadEdge& edge, std::size_t k, std::size_t vertex) { edge.join(k, corner[vertex]); });
  faces_of_edge_.resize(edges_.size());
  faces_.reserve(data.faces.size());
  for (std::size_t f = 0; f < data.faces.size(); ++f) {
    try {
      faces_.emplace_back(std::move(data.faces[f]), edges_, size_);
    } catch (const Error& error) {
      throw Error(fmt::format("face {}: {}", f + 1, error.what()));
    }
    const auto& border = faces_.back().data().border;
    for (std::size_t b = 0; b < border.size(); ++b) {
      const double gap = faces_.back().gap(static_cast<int>(b));
      if (!(gap <= max_gap * size_))
        throw Error(fmt::format("face {}: expected edges on it, found one that is {:.3g} off", f + 1, gap));
      edges_[at(border[b].edge)].widen(gap);
      auto& faces = faces_of_edge_[at(border[b].edge)];
      if (faces.empty() || faces.back() != static_cast<int>(f)) faces.push_back(static_cast<int>(f));
    }
  }
}

double CadModel::largest_tolerance() const {
  double largest = 0;
  for (const auto& edge : edges_) largest = std::max(largest, edge.tolerance());
  return largest;
}

int CadModel::n_open_edges() const {
  return static_cast<int>(
      std::count_if(faces_of_edge_.begin(), faces_of_edge_.end(), [](const auto& f) { return f.size() == 1; }));
}

std::vector<int> CadModel::faces_near(Vec3 point, double tolerance) const {
  std::vector<int> near;
  for (std::size_t f = 0; f < faces_.size(); ++f)
    if (faces_[f].distance_at_least(point, tolerance) <= tolerance && faces_[f].project(point).distance <= tolerance)
      near.push_back(static_cast<int>(f));
  return near;
}

}  // namespace pamr::geometry
