// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
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

/// A face as a solid has it.
struct CadSide {
  int face = 0;             ///< from 0 on
  bool is_flipped = false;  ///< the outside of this solid is the inside of the one that has the face first
};

/// The solids of a shape.
struct CadSolids {
  struct Solid {
    std::string name;  ///< empty where the file has none
    Vec3 middle;       ///< of its box
    std::vector<CadSide> sides;
    double volume = 0;  ///< good to some 1e-4
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

/// Triangles not farther from their faces than `deflection` times the size of the shape. `is_assembly`: the text is
/// that of a `CadAssembly`, whose solids may touch; no contact is looked for. Throws `Error`.
CadTriangles triangulate_cad(std::string_view text, double scale, double deflection, bool is_assembly = false);

/// A face of an assembly.
struct CadAssemblyFace {
  std::string name;                  ///< of the face of the file that it is a part of; empty where that has none
  std::string color;                 ///< of that face, likewise
  int number = 0;                    ///< of that face, from 1 on
  std::array<int, 2> region{0, -1};  ///< at its sides, ascending; the second -1: outside
};

/// The solids of a file as regions that share the faces between them.
struct CadAssembly {
  std::string text;  ///< of the solids, in BREP format
  std::string unit_of_file;
  std::vector<std::string> region;       ///< names, each another: of a solid of the file
  std::vector<int> region_of_solid;      ///< of the text, in the order of the text
  std::vector<CadAssemblyFace> face;     ///< of the text, in the order of the text
  std::vector<CadLooseFace> loose_face;  ///< of the file: faces that belong to no solid
};

/// Makes regions of the solids of a file by OpenCASCADE's general fuse: faces that are shared, coincide or touch become
/// one, within the tolerance that the file states (1e-6 to 1e-5 of the size of the solids). A solid wholly inside
/// another is cut out of it. A region has the name of the part that its solid is, of the solid itself where the part
/// has several, or solid_N, N its number in the file; solids of one name are numbered (gear_1, gear_2). `chosen`: names
/// of the solids to take, or what numbered ones are called without the number; empty: all. `scale` as for `read_cad`,
/// for positions in messages. Throws `Error` for solids that overlap, for names that no solid has, and where there is
/// no solid. The same bits in every process.
CadAssembly assemble_cad(std::string_view text, double scale, std::span<const std::string> chosen = {});

/// Area of each face and volume inside of a shape, integrated by OpenCASCADE to 1e-8 (its usual rules are good to some
/// 1e-4). The volume of an open shape means nothing.
struct CadMeasures {
  std::vector<double> area;
  double volume = 0;
};
CadMeasures measure_cad(std::string_view text, double scale);

}  // namespace pamr::geometry
