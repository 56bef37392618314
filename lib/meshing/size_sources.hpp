// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/box.hpp"
#include "pamr/geometry/cad/cad_model.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::meshing {

/// Points with wanted edge lengths, from which lengths grow with the distance.
class SizeSources {
 public:
  struct Source {
    geometry::Vec3 point;
    double size = 0;
  };
  /// `growth`: of the length per distance, under 1; a length holds within one such length of its point.
  SizeSources(std::vector<Source> sources, double growth);

  /// The least length that any point asks for, at most `limit`. Cost: of a search in a tree.
  double at(geometry::Vec3 point, double limit) const;

 private:
  struct Node {
    geometry::Box box;
    double least = 0;  ///< size in this part
    int begin = 0, end = 0, right = -1;
  };
  int build(int begin, int end);
  double grown(double size, double distance) const;
  void search(int node, geometry::Vec3 point, double& best) const;

  std::vector<Source> source_;
  std::vector<Node> node_;
  double growth_;
};

/// The larger of the absolute principal curvatures of a surface, whatever its parameters; negative where it has none
/// (a pole).
double curvature(const geometry::SurfaceJet& at_point);

/// Points on the curved faces of a shape, each with `factor` times the smaller radius of curvature there, between
/// `least` and `most`; larger ones are left out.
std::vector<SizeSources::Source> curvature_sizes(const geometry::CadModel& model, double factor, double least,
                                                 double most);

}  // namespace pamr::meshing
