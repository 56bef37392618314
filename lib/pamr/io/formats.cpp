// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/io/cgns/read_cgns.hpp"
#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/export/write_boundary.hpp"
#include "pamr/io/export/write_cgns.hpp"
#include "pamr/io/export/write_foam.hpp"
#include "pamr/io/export/write_vtu.hpp"
#include "pamr/io/foam/read_foam.hpp"
#include "pamr/io/gmsh/read_gmsh.hpp"
#include "pamr/io/losses.hpp"
#include "pamr/io/medit/read_medit.hpp"
#include "pamr/io/medit/write_medit.hpp"
#include "pamr/io/mfem/read_mfem.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/io/native/write_native.hpp"
#include "pamr/io/su2/read_su2.hpp"
#include "pamr/io/su2/write_su2.hpp"
#include "pamr/io/ugrid/read_ugrid.hpp"
#include "pamr/io/ugrid/write_ugrid.hpp"
#include "pamr/io/vtk/read_legacy_vtk.hpp"
#include "pamr/io/vtk/read_vtu.hpp"
#include "pamr/mesh/untagged_patch.hpp"

namespace pamr::io {

namespace {

using Path = std::filesystem::path;
using Read = MeshReadOptions;
using Write = MeshWriteOptions;
using par::Comm;

void write_surface(const Comm& comm, const Path& file, const mesh::DistMesh& mesh, const Write& o) {
  write_boundary(comm, file, mesh, o.patches);
}

ElementOptions elements_of(const Read& o, CellOrder order = CellOrder::curve) {
  return {.repair = o.repair, .order = order, .split_prisms = o.split_prisms};
}

const std::vector<std::string_view> aerodynamic_kinds{"wall",     "symmetry", "symmetryPlane",
                                                      "farfield", "inflow",   "outflow"};

const std::vector<Format> table{
    {.name = "native",
     .endings = {".hdf", ".vtkhdf"},
     .read =
         [](const Comm& comm, const Path& file, const Read& o) {
           NativeFile native(comm, file, {.build_surfaces = o.build_surfaces, .remark = o.remark});
           ElementMesh read;
           read.mesh = assemble::assemble(comm, native.read());
           if (!native.is_of_pamr()) read.n_untagged_faces = mesh::count_untagged_faces(comm, read.mesh);
           return read;
         },
     .write =
         [](const Comm& comm, const Path& file, const mesh::DistMesh& mesh, const Write& o) {
           write_native(comm, file, mesh, {.provenance = o.provenance, .format = o.format, .remark = o.remark});
         },
     .is_native = true,
     .has_inner_patches = true,
     .has_fields = true,
     .has_regions = true},
    {.name = "Gmsh",
     .endings = {".msh"},
     .read = [](const Comm& comm, const Path& file, const Read& o) { return read_gmsh(comm, file, elements_of(o)); },
     .write =
         [](const Comm& comm, const Path& file, const mesh::DistMesh& mesh, const Write& o) {
           auto how = o.gmsh;
           if (!how.remark) how.remark = o.remark;
           write_gmsh(comm, file, mesh, how, o.second_order);
         },
     .has_elements = true,
     .has_inner_patches = true,
     .has_regions = true,
     .has_numbers = true,
     .has_region_names = true,
     .has_groups = true,
     .has_groups_inside = true,
     .has_empty_patches = true,
     .has_interfaces = true,
     .has_second_order = true,
     .has_text = true},
    {.name = "VTK",
     .endings = {".vtu"},
     .read = [](const Comm& comm, const Path& file, const Read& o) { return read_vtu(comm, file, elements_of(o)); },
     .write = [](const Comm& comm, const Path& file, const mesh::DistMesh& mesh,
                 const Write& o) { write_vtu(comm, file, mesh, o.second_order); },
     .has_elements = true,
     .has_inner_patches = true,
     .has_fields = true,
     .has_regions = true,
     .has_empty_patches = true,
     .has_untagged_name = true,
     .has_second_order = true},
    {.name = "legacy VTK",
     .endings = {".vtk"},
     .read = [](const Comm& comm, const Path& file,
                const Read& o) { return read_legacy_vtk(comm, file, elements_of(o)); },
     .write = nullptr,
     .has_elements = true},
    {.name = "Medit",
     .endings = {".mesh", ".meshb"},
     .read =
         [](const Comm& comm, const Path& file, const Read& o) {
           if (is_mfem(comm, file)) return read_mfem(comm, file, elements_of(o));  // both call it .mesh
           return read_medit(comm, file, {elements_of(o), o.solution, o.field_names});
         },
     .write = [](const Comm& comm, const Path& file, const mesh::DistMesh& mesh,
                 const Write& o) { write_medit(comm, file, mesh, o.gmsh.interfaces); },
     .has_elements = true,
     .has_inner_patches = true,
     .has_regions = true,
     .has_names = false,
     .has_numbers = true,
     .has_interfaces = true,
     .has_solutions = true},
    {.name = "MFEM",
     .endings = {".mfem"},
     .read = [](const Comm& comm, const Path& file, const Read& o) { return read_mfem(comm, file, elements_of(o)); },
     .write = nullptr,
     .has_elements = true},
    {.name = "SU2",
     .endings = {".su2"},
     .read = [](const Comm& comm, const Path& file, const Read& o) { return read_su2(comm, file, elements_of(o)); },
     .write = [](const Comm& comm, const Path& file, const mesh::DistMesh& mesh,
                 const Write& o) { write_su2(comm, file, mesh, o.remark); },
     .has_elements = true,
     .wants_every_face = true},
    {.name = "UGRID",
     .endings = {".lb8.ugrid", ".b8.ugrid"},
     .read = [](const Comm& comm, const Path& file, const Read& o) { return read_ugrid(comm, file, elements_of(o)); },
     .write = [](const Comm& comm, const Path& file, const mesh::DistMesh& mesh,
                 const Write& o) { write_ugrid(comm, file, mesh, o.remark); },
     .has_elements = true,
     .wants_every_face = true,
     .has_numbers = true,
     .kinds = aerodynamic_kinds,
     .file_beside = mapbc_file},
    {.name = "CGNS",
     .endings = {".cgns"},
     .read = [](const Comm& comm, const Path& file, const Read& o) { return read_cgns(comm, file, elements_of(o)); },
     .write = [](const Comm& comm, const Path& file, const mesh::DistMesh& mesh,
                 const Write& o) { write_cgns(comm, file, mesh, o.remark); },
     .has_elements = true,
     .has_inner_patches = true,
     .has_fields = true,
     .has_regions = true,
     .kinds = aerodynamic_kinds},
    {.name = "surface",
     .endings = {".stl", ".obj", ".ply", ".off"},
     .read = nullptr,
     .write = write_surface,
     .instead_of_reading = "a surface: pamr-mesh meshes the space in or around it (shape = \"surfaces\"), pamr-convert "
                           "--surface lets a patch of a mesh lie on it",
     .is_surface = true},
    {.name = "VTK PolyData", .endings = {".vtp"}, .read = nullptr, .write = write_surface, .is_surface = true},
    {.name = "OpenFOAM",
     .endings = {""},
     .read = [](const Comm& comm, const Path& file,
                const Read& o) { return read_foam(comm, file, elements_of(o, CellOrder::keep)); },
     .write = [](const Comm& comm, const Path& file, const mesh::DistMesh& mesh,
                 const Write& o) { write_foam(comm, file, mesh, o.remark); },
     .has_elements = true,
     .is_folder = true,
     .wants_every_face = true,
     .has_inner_patches = true,
     .has_regions = true,
     .has_region_names = true,
     .has_groups = true,
     .has_empty_patches = true,
     .has_untagged_name = true,
     .kinds = {"wall", "symmetry", "symmetryPlane"}},
};

std::string list(const std::vector<std::string_view>& endings, std::string_view before_last) {
  return listed(endings, {before_last, all_items});
}

/// The ending itself, and why no mesh is read from such a file.
std::string what_was_found(const Path& file) {
  const auto* format = find_format(file);
  const auto ending = fmt::format("\"{}\"", file.extension().string());
  if (format == nullptr) {
    const auto what = what_begins(file);
    return what.empty() ? ending : fmt::format("{} and {}", ending, what);
  }
  if (!format->instead_of_reading.empty()) return std::string(format->instead_of_reading);
  return fmt::format("{}: {} is only written", ending, format->name);
}

Error unknown_ending(const Path& file, const std::string& endings, const std::string& found) {
  return Error(fmt::format("file '{}': expected a name that ends in {}, found {}", file.string(), endings, found));
}

}  // namespace

std::span<const Format> formats() { return table; }

const Format* find_format(const Path& file) {
  const auto last = file.extension().string(), two = file.stem().extension().string() + last;
  const auto found = std::find_if(table.begin(), table.end(), [&](const Format& format) {
    return std::any_of(format.endings.begin(), format.endings.end(),
                       [&](auto ending) { return ending == last || (!ending.empty() && ending == two); });
  });
  return found == table.end() ? nullptr : &*found;
}

const Format& format_to_read(const Path& file) {
  std::error_code none;
  const auto* format = find_format(std::filesystem::is_directory(file, none) ? Path("folder") : file);
  if (format == nullptr || format->read == nullptr)
    throw unknown_ending(file, list_endings([](const Format& f) { return f.read != nullptr; }, ", "),
                         what_was_found(file));
  return *format;
}

const Format& format_to_write(const Comm& comm, const Path& file) {
  std::error_code none;
  const bool is_folder = comm.any(file.extension().empty() || std::filesystem::is_directory(file, none));
  const auto* format = is_folder ? find_format("folder") : find_format(file);
  if (format == nullptr || format->write == nullptr)
    throw unknown_ending(file, list_endings([](const Format& f) { return f.write != nullptr; }, ", "),
                         format == nullptr
                             ? fmt::format("\"{}\" (an OpenFOAM case is a folder)", file.extension().string())
                             : fmt::format("\"{}\": {} is only read", file.extension().string(), format->name));
  return *format;
}

bool is_foreign_name(const Path& file) {
  const auto last = file.extension().string();
  return !last.empty() && std::any_of(table.begin(), table.end(), [&](const Format& format) {
    return !format.is_native && std::any_of(format.endings.begin(), format.endings.end(),
                                            [&](auto ending) { return ending.ends_with(last); });
  });
}

std::string list_endings(const std::function<bool(const Format&)>& is_chosen, std::string_view before_last) {
  std::vector<std::string_view> all;
  for (const auto& format : table)
    if (is_chosen(format))
      std::copy_if(format.endings.begin(), format.endings.end(), std::back_inserter(all),
                   [](auto ending) { return !ending.empty(); });
  return list(all, before_last);
}

std::string list_endings(const Format& format, std::string_view before_last) {
  return list(format.endings, before_last);
}

ElementMesh read_mesh(const Comm& comm, const Path& file, const MeshReadOptions& options) {
  return format_to_read(file).read(comm, file, options);
}

void write_mesh(const Comm& comm, const Path& file, const mesh::DistMesh& mesh, const MeshWriteOptions& options) {
  const auto& format = format_to_write(comm, file);
  format.write(comm, file, mesh, options);
  for (const auto& text : texts_of_losses(comm, format, mesh, options)) options.remark(text);
  if (!options.note || format.is_surface) return;
  for (const auto& text : {text_of_named_faces(comm, format, mesh), text_of_lost_history(comm, format, mesh)})
    if (!text.empty()) options.note(text);
}

}  // namespace pamr::io
