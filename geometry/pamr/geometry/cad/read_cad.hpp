// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/geometry/cad/cad_data.hpp"

namespace pamr::geometry {

/// False in a build without OpenCASCADE, in which `read_cad` throws.
bool can_read_cad();

/// Reads the text of a STEP, IGES or BREP file with OpenCASCADE, samples its faces and finds its edges. `scale`: length
/// units of the result in a millimeter (STEP and IGES say their own unit; BREP has none and counts as millimeters).
/// Throws `Error` with what is wrong. A damaged text may crash OpenCASCADE. Deterministic: the same bits in every
/// process.
CadData read_cad(std::string_view text, double scale);

/// A face that belongs to no solid, from 0 on, and a point near it.
struct CadLooseFace {
  int face = 0;
  Vec3 where;
};

/// Two solids, from 1 on, that touch or overlap, or of which the first lies in the second.
struct CadContact {
  int first = 0, second = 0;
  bool is_nested = false;
  Vec3 where;
};

/// The solids of a shape.
struct CadSolids {
  struct Solid {
    std::string name;  ///< empty where the file has none
    Vec3 middle;       ///< of its box
  };
  std::vector<Solid> solid;
  std::vector<CadLooseFace> loose_face;
  std::vector<CadContact> contact;  ///< the first few
  double volume = 0;                ///< of all solids, good to some 1e-4
};

/// Triangles on the faces of a shape whose corners are one where faces meet: a closed, oriented surface where the shape
/// is closed.
struct CadTriangles {
  std::vector<Vec3> point;
  std::vector<std::array<int, 3>> corner;  ///< of each triangle, counter-clockwise seen from outside of the body
  std::vector<int> face;                   ///< of each triangle, from 0 on
  CadSolids solids;
};

/// Triangles not farther from their faces than `deflection` times the size of the shape. Throws `Error`.
CadTriangles triangulate_cad(std::string_view text, double scale, double deflection);

/// Area of each face and volume inside of a shape, integrated by OpenCASCADE to 1e-8 (its usual rules are good to some
/// 1e-4). The volume of an open shape means nothing.
struct CadMeasures {
  std::vector<double> area;
  double volume = 0;
};
CadMeasures measure_cad(std::string_view text, double scale);

}  // namespace pamr::geometry
