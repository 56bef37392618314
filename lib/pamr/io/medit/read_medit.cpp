// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/medit/read_medit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <system_error>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/io/elements/read_shares.hpp"
#include "pamr/io/medit/gmf.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io {

namespace {

/// Counts a section of a keyword that is not known.
void leave(ElementParts& parts, const std::string& name) {
  constexpr std::size_t most = 20;  // names: a damaged text may have any
  ++parts.left_out[parts.left_out.size() < most || parts.left_out.contains(name) ? name : "other keywords"];
}

/// What this rank's vertices are numbered with.
struct VertexReferences {
  std::int64_t least = std::numeric_limits<std::int64_t>::max(), greatest = std::numeric_limits<std::int64_t>::min();
  std::int64_t n_others = 0;  ///< than 0

  void add(std::int64_t reference) {
    least = std::min(least, reference);
    greatest = std::max(greatest, reference);
    n_others += reference != 0 ? 1 : 0;
  }
};

/// Reads the rows of vertices, triangles and tetrahedra.
class MeshSections {
 public:
  MeshSections(gmf::Reader& in, Share share) : in_(in), share_(share) {}

  ElementParts read() {
    in_.for_each_section([this](const gmf::KnownKeyword& keyword, std::int64_t n) { take(keyword, n); },
                         [this](const std::string& name) { leave(parts_, name); });
    return std::move(parts_);
  }
  const VertexReferences& references() const { return references_; }

 private:
  void take(const gmf::KnownKeyword& keyword, std::int64_t n) {
    if (keyword.refused_type == gmf::left_out) {
      if (n > 0) parts_.left_out[std::string(keyword.name)] += n;
    } else if (keyword.refused_type != 0) {
      if (n > 0 && share_.rank == 0) parts_.refused[keyword.refused_type] += n;
    } else if (keyword.name.starts_with("Periodic")) {
      if (n > 0) in_.fail("no periodic links", fmt::format("{}", n));
    } else if (keyword.name.starts_with("Sol")) {
      in_.fail("a mesh", std::string(keyword.name) + ", which belongs into a .sol");
    } else if (!seen_.insert(keyword.code).second) {
      in_.fail(std::string(keyword.name) + " once", "it again");
    } else if (keyword.code == gmf::vertices) {
      read_vertices(n);
    } else if (keyword.code == gmf::triangles) {
      in_.rows(n, share_.of(n), {"triangles", 0, 4}, [this](std::int64_t) {
        auto& triangle = parts_.triangle.emplace_back();
        for (auto& node : triangle.node) node = in_.integer("a node of a triangle");
        triangle.group = in_.integer("the reference of a triangle");
      });
    } else if (keyword.code != gmf::tetrahedra) {
      read_cut(keyword, n);
    } else {
      in_.rows(n, share_.of(n), {"tetrahedra", 0, 5}, [this](std::int64_t) {
        auto& cell = parts_.tetrahedron.emplace_back();
        for (auto& node : cell.node) node = in_.integer("a node of a tetrahedron");
        cell.group = in_.integer("the reference of a tetrahedron");
      });
      parts_.n_elements = n;
    }
  }

  /// Quadrilaterals, prisms and pyramids.
  void read_cut(const gmf::KnownKeyword& keyword, std::int64_t n) {
    const int type = keyword.code == gmf::prisms     ? element_type::prism
                     : keyword.code == gmf::pyramids ? element_type::pyramid
                                                     : element_type::quadrangle;
    const int n_nodes = n_nodes_of_type(type);
    in_.rows(n, share_.of(n), {keyword.name, 0, n_nodes + 1}, [&](std::int64_t) {
      std::array<std::int64_t, max_nodes> nodes{};
      for (int k = 0; k < n_nodes; ++k) nodes[static_cast<std::size_t>(k)] = in_.integer("a node of an element");
      keep_element(parts_, type, nodes, in_.integer("the reference of an element"));
    });
  }

  void read_vertices(std::int64_t n) {
    parts_.n_nodes = n;
    in_.rows(n, share_.of(n), {"vertices", 3, 1}, [this](std::int64_t row) {
      const double x = in_.real("x"), y = in_.real("y"), z = in_.real("z");
      references_.add(in_.integer("the reference of a vertex"));
      parts_.node_tag.push_back(row + 1);
      parts_.position.push_back({x, y, z});
    });
  }

  gmf::Reader& in_;
  Share share_;
  ElementParts parts_;
  VertexReferences references_;
  std::set<std::int32_t> seen_;
};

/// Reads the fields that belong to a mesh of so many vertices and tetrahedra.
class SolutionSections {
 public:
  SolutionSections(gmf::Reader& in, Share share, std::int64_t n_nodes, std::int64_t n_cells)
      : in_(in), share_(share), n_nodes_(n_nodes), n_cells_(n_cells) {}

  ElementParts read() {
    in_.for_each_section(
        [this](const gmf::KnownKeyword& keyword, std::int64_t n) {
          if (keyword.code == gmf::sol_at_vertices)
            read_fields(n, n_nodes_, "vertices", parts_.node_fields);
          else if (keyword.code == gmf::sol_at_tetrahedra)
            read_fields(n, n_cells_, "tetrahedra", parts_.cell_fields);
          else if (n > 0)
            in_.fail("fields on vertices or tetrahedra (SolAtVertices, SolAtTetrahedra)", std::string(keyword.name));
        },
        [this](const std::string& name) { leave(parts_, name); });
    if (parts_.node_fields.empty() && parts_.cell_fields.empty())
      in_.fail("SolAtVertices or SolAtTetrahedra", "none of them");
    return std::move(parts_);
  }

 private:
  void read_fields(std::int64_t n, std::int64_t of_mesh, const char* what, std::vector<mesh::Field>& fields) {
    if (!fields.empty()) in_.fail(fmt::format("fields on {} once", what), "them again");
    if (n != of_mesh) in_.fail(fmt::format("values on the {} {} of the mesh", of_mesh, what), fmt::format("{}", n));
    const auto n_fields = in_.small("a number of fields");
    if (n_fields < 1 || n_fields > 1000) in_.fail("1 to 1000 fields", fmt::format("{}", n_fields));
    int width = 0;
    for (std::int64_t f = 0; f < n_fields; ++f) {
      const auto type = in_.small("the type of a field");
      if (type < 1 || type > 4)
        in_.fail("1 (scalar), 2 (vector), 3 (symmetric tensor) or 4 (tensor)", fmt::format("{}", type));
      const int n_components = type == 1 ? 1 : type == 2 ? 3 : type == 3 ? 6 : 9;
      fields.push_back({"", "", n_components, mesh::StorageType::float64, std::vector<double>()});
      width += n_components;
    }
    in_.rows(n, share_.of(n), {what, width, 0}, [&](std::int64_t) {
      for (auto& field : fields)
        for (int k = 0; k < field.n_components; ++k) field.real().push_back(in_.real("a value"));
    });
  }

  gmf::Reader& in_;
  Share share_;
  std::int64_t n_nodes_, n_cells_;
  ElementParts parts_;
};

ElementParts read_gmf(const par::Comm& comm, const std::filesystem::path& file,
                      const std::function<ElementParts(gmf::Reader&, Share)>& read) {
  bool is_binary = false;
  return read_shares(
      comm, file, [&](TextCursor& in) { return !(is_binary = gmf::Reader::is_binary(in)); },
      [&](TextCursor& in, Share share) {
        gmf::Reader reader(in, is_binary);
        return read(reader, share);
      });
}

void name_fields(ElementParts& parts, const MeditOptions& options) {
  const auto n = parts.node_fields.size() + parts.cell_fields.size();
  const auto& names = options.field_names;
  if (!names.empty() && names.size() != n)
    throw Error(fmt::format("file '{}': expected {} fields as there are names, found {}", options.solution.string(),
                            names.size(), n));
  std::size_t next = 0;
  for (auto* fields : {&parts.node_fields, &parts.cell_fields})
    for (auto& field : *fields) {
      field.name = names.empty() ? fmt::format("sol_{}", next + 1) : names[next];
      ++next;
    }
}

/// Fields that lie beside a mesh under its name, as Medit itself looks for them. Collective.
void tell_of_solutions(const par::Comm& comm, std::filesystem::path file, std::vector<std::string>& notes) {
  for (const auto* ending : {".sol", ".solb"}) {
    std::error_code none;
    if (comm.any(comm.is_first() && std::filesystem::exists(file.replace_extension(ending), none)))
      notes.push_back(fmt::format("the fields of {} were left out (--sol-in of pamr-convert reads them)",
                                  shown_text(file.replace_extension(ending).filename().string())));
  }
}

}  // namespace

ElementMesh read_medit(const par::Comm& comm, const std::filesystem::path& file, const MeditOptions& options) {
  VertexReferences references;
  auto parts = read_gmf(comm, file, [&](gmf::Reader& in, Share share) {
    MeshSections sections(in, share);
    auto read = sections.read();
    references = sections.references();
    return read;
  });
  if (const auto n = comm.sum(references.n_others); comm.min(references.least) != comm.max(references.greatest))
    parts.left_out["references of vertices"] = n;  // one for all of them says nothing
  if (!options.solution.empty()) {
    auto fields = read_gmf(comm, options.solution, [&](gmf::Reader& in, Share share) {
      return SolutionSections(in, share, parts.n_nodes, parts.n_elements).read();
    });
    parts.node_fields = std::move(fields.node_fields);
    parts.cell_fields = std::move(fields.cell_fields);
    if (options.split_prisms && !parts.cell_fields.empty() && comm.any(!parts.cut.empty()))
      throw Error(
          fmt::format("{}: expected fields on vertices, found some on the tetrahedra of a mesh that has other elements",
                      source_of(options.solution)));
    for (const auto& [name, n] : fields.left_out) parts.left_out[name] += n;
    name_fields(parts, options);
  }
  parts.has_signed_regions = true;
  auto read = mesh_of_elements(comm, std::move(parts), source_of(file), options, [](std::int64_t reference) {
    return mesh::Patch{
        .name = fmt::format("ref_{}", reference), .kind = "", .number = std::max<std::int64_t>(reference, -1)};
  });
  if (options.solution.empty()) tell_of_solutions(comm, file, read.notes);
  return read;
}

}  // namespace pamr::io
