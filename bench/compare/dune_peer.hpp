// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dune/common/parallel/mpihelper.hh>
#include <dune/grid/common/boundarysegment.hh>
#include <dune/grid/common/gridfactory.hh>
#include <memory>
#include <type_traits>

#include "workload.hpp"

/// The common part of the codes behind DUNE's interface. The wall of a hole is given to them as a surface: new nodes
/// of its faces are put onto the sphere.
namespace peer {

class WallSegment : public Dune::BoundarySegment<3, 3> {
 public:
  explicit WallSegment(std::array<Point, 3> corner) : corner_(corner) {}
  Dune::FieldVector<double, 3> operator()(const Dune::FieldVector<double, 2>& local) const override {
    Dune::FieldVector<double, 3> x;
    for (std::size_t axis = 0; axis < 3; ++axis)
      x[axis] =
          (1 - local[0] - local[1]) * corner_[0][axis] + local[0] * corner_[1][axis] + local[1] * corner_[2][axis];
    return x *= hole_radius / x.two_norm();
  }

 private:
  std::array<Point, 3> corner_;
};

template <class Grid>
class DunePeer {
 public:
  explicit DunePeer(const std::string& mesh_name) {
    const auto plain = mesh_named(mesh_name);
    Dune::GridFactory<Grid> factory;
    for (const auto& p : plain.node) factory.insertVertex({p[0], p[1], p[2]});
    for (const auto& n : plain.cell) {
      const std::vector<unsigned> corners(n.begin(), n.end());
      factory.insertElement(Dune::GeometryTypes::tetrahedron, corners);
    }
    if (domain_of(mesh_name) == Domain::hole) {
      for (const auto& face : boundary_of(plain)) {
        std::array<Point, 3> p{};
        for (std::size_t i = 0; i < 3; ++i) p[i] = plain.node[static_cast<std::size_t>(face[i])];
        if (!std::all_of(p.begin(), p.end(), [](const Point& q) { return distance(q, hole_center) < on_wall; }))
          continue;
        factory.insertBoundarySegment({face.begin(), face.end()}, std::make_shared<WallSegment>(p));
      }
    }
    grid_ = std::shared_ptr<Grid>(factory.createGrid());
  }

  std::size_t n_cells() const { return static_cast<std::size_t>(grid_->leafGridView().size(0)); }

  template <class Visit>
  void corners(Visit&& visit) const {
    for (const auto& cell : elements(grid_->leafGridView())) {
      Corners p;
      const auto geometry = cell.geometry();
      for (int i = 0; i < 4; ++i) {
        const auto x = geometry.corner(i);
        p[static_cast<std::size_t>(i)] = {x[0], x[1], x[2]};
      }
      visit(p);
    }
  }

  void mark(const std::vector<std::int8_t>& flags) {
    std::size_t number = 0;
    for (const auto& cell : elements(grid_->leafGridView())) {
      const int flag = flags.empty() ? 1 : flags[number];
      if (flag > 0) grid_->mark(1, cell);
      if (flag < 0 && cell.level() > 0) grid_->mark(-1, cell);
      ++number;
    }
  }

  void refine() {
    grid_->preAdapt();
    grid_->adapt();
    grid_->postAdapt();
  }
  bool mark_more() { return false; }
  static int coarsening_calls() { return 1; }
  bool relate() { return false; }

 protected:
  std::shared_ptr<Grid> grid_;
};

}  // namespace peer
