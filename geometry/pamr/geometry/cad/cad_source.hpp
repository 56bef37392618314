// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/geometry/cad/cad_model.hpp"
#include "pamr/geometry/cad/read_cad.hpp"
#include "pamr/geometry/surface_set.hpp"

namespace pamr::geometry {

/// A CAD file as it travels with a mesh: its name without folder and its text.
struct CadSource {
  std::string file;
  std::string text;  ///< UTF-8
};

/// True for a name that ends in .step, .stp, .iges, .igs or .brep.
bool is_cad_file(const std::filesystem::path& file);

/// Reads a STEP, IGES or BREP file as text. What is not UTF-8 is taken for Latin-1. Throws `Error` for a file that is
/// not there, has another extension (see `is_cad_file`) or holds control characters.
CadSource read_cad_source(const std::filesystem::path& file);

/// The shape, coordinates in `unit`: mm, cm, m, um, in or ft. `is_assembly`: the text is that of a `CadAssembly`.
/// Throws `Error` if the text is not sound. OpenCASCADE may crash on a damaged one: the tools have had it read in a
/// process of its own before.
std::shared_ptr<const CadModel> make_cad_model(const CadSource& source, std::string_view unit,
                                               bool is_assembly = false);

/// The solids of the file, or the chosen ones, as regions (`assemble_cad`). Throws `Error`.
CadAssembly make_cad_assembly(const CadSource& source, std::string_view unit, std::span<const std::string> chosen);

/// Areas of its faces and its volume, in that unit. Throws `Error`.
CadMeasures measure_cad_source(const CadSource& source, std::string_view unit);

/// The unit in which OpenCASCADE and Gmsh give coordinates if nobody asks for another one.
inline constexpr const char* usual_cad_unit = "mm";
bool is_cad_unit(std::string_view unit);

/// A table `[[surface]]` of faces of a shape, numbered from 1.
std::string cad_surface_table(const std::string& name, const CadSource& source, const std::string& unit,
                              std::span<const int> faces);

/// The table `[[cad]]` that holds the text in a description of surfaces.
std::string cad_table(const CadSource& source);

/// Faces of a shape, numbered from 1, that make one surface.
struct CadPart {
  std::string name;
  std::vector<int> faces;
};

/// The surfaces of parts of a shape, which `model` is in `unit`, with their description, which holds the text. `where`
/// is what they belong to. Throws `Error` for a name that stands twice and for faces as `CadSurface` does.
SurfaceSet cad_surfaces(const CadSource& source, const std::string& unit, const std::shared_ptr<const CadModel>& model,
                        std::span<const CadPart> parts, const std::string& where);

}  // namespace pamr::geometry
