// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/medit/write_medit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/elements/boundary_rows.hpp"
#include "pamr/io/elements/numbers.hpp"
#include "pamr/io/medit/gmf.hpp"
#include "pamr/io/rows_in_order.hpp"
#include "pamr/io/shared_output.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::io {

namespace {

/// One keyword with its rows, of which each rank has a part.
struct Section {
  gmf::Keyword keyword{};
  const char* name = "";
  std::int64_t n = 0;  ///< rows of all ranks
  int n_reals = 0, n_integers = 0;
  std::vector<std::int64_t> types = {};  ///< of fields, before the rows
  std::string text = {};                 ///< this rank's rows as they are written
};

/// Prints rows as text, or as bytes of a version.
class Rows {
 public:
  explicit Rows(int version) : version_(version) {}
  void integer(std::int64_t value) {
    if (version_ == 0)
      append_text(data_, value);
    else if (version_ == 4)
      append_bytes(data_, value);
    else
      append_bytes(data_, static_cast<std::int32_t>(value));
  }
  void real(double value) { version_ == 0 ? append_text(data_, value) : append_bytes(data_, value); }
  void end() {
    if (version_ == 0) data_ += '\n';
  }
  std::string take() { return std::exchange(data_, {}); }

 private:
  int version_;  ///< 0: text
  std::string data_;
};

bool is_text(const std::filesystem::path& file) { return !file.extension().string().ends_with('b'); }

std::int64_t size_of(const Section& s, int version) {
  const std::int64_t place = version >= 3 ? 8 : 4, integer = version == 4 ? 8 : 4;
  return 4 + place + integer + (s.types.empty() ? 0 : 4 * (1 + std::ssize(s.types))) +
         s.n * (std::int64_t{8} * s.n_reals + integer * s.n_integers);
}

/// The version that the sections need, 0 for text.
int version_of(const std::filesystem::path& file, const std::vector<Section>& sections) {
  if (is_text(file)) return 0;
  std::int64_t n_bytes = 64, max_count = 0;
  for (const auto& s : sections) {
    n_bytes += size_of(s, 4);
    max_count = std::max(max_count, s.n);
  }
  return gmf::version_for(n_bytes, max_count);
}

void write_text(SharedOutput& out, const std::vector<Section>& sections) {
  out.append_once("MeshVersionFormatted 2\n\nDimension 3\n");
  for (const auto& s : sections) {
    auto head = fmt::format("\n{}\n{}\n", s.name, s.n);
    if (!s.types.empty()) {
      head += fmt::format("{}", s.types.size());
      for (const auto type : s.types) append_text(head, type);
      head += '\n';
    }
    out.append_once(head);
    out.append(s.text);
  }
  out.append_once("\nEnd\n");
}

void append_place(std::string& bytes, std::int64_t place, int version) {
  version >= 3 ? append_bytes(bytes, place) : append_bytes(bytes, static_cast<std::int32_t>(place));
}

void write_binary(SharedOutput& out, const std::vector<Section>& sections, int version) {
  std::string head;
  append_bytes(head, std::int32_t{1});
  append_bytes(head, static_cast<std::int32_t>(version));
  append_bytes(head, static_cast<std::int32_t>(gmf::dimension));
  std::int64_t place = version >= 3 ? 24 : 20;
  append_place(head, place, version);
  append_bytes(head, std::int32_t{3});
  for (const auto& s : sections) {
    place += size_of(s, version);
    append_bytes(head, static_cast<std::int32_t>(s.keyword));
    append_place(head, place, version);
    version == 4 ? append_bytes(head, s.n) : append_bytes(head, static_cast<std::int32_t>(s.n));
    if (!s.types.empty()) append_bytes(head, static_cast<std::int32_t>(s.types.size()));
    for (const auto type : s.types) append_bytes(head, static_cast<std::int32_t>(type));
    out.append_once(std::exchange(head, {}));
    out.append(s.text);
  }
  append_bytes(head, static_cast<std::int32_t>(gmf::end));
  append_place(head, 0, version);
  out.append_once(head);
}

void write_sections(const par::Comm& comm, const std::filesystem::path& file, const std::vector<Section>& sections,
                    int version) {
  SharedOutput out(comm, file);
  version == 0 ? write_text(out, sections) : write_binary(out, sections, version);
  out.commit();
}

/// The region of each cell of this rank's block. Collective.
std::vector<std::int64_t> regions_of(const par::Comm& comm, const mesh::DistMesh& mesh, std::size_t n) {
  auto regions = regions_in_order(comm, mesh);
  if (!regions.has_field) return std::vector<std::int64_t>(n, 0);
  for (const auto number : regions.all)
    if (number != static_cast<std::int32_t>(number))
      throw Error(fmt::format("Medit: expected regions of 32 bits, found {}", number));
  return std::move(regions.of_cell);
}

int type_of(const mesh::Field& field) {
  switch (field.n_components) {
    case 1:
      return 1;
    case 3:
      return 2;
    case 6:
      return 3;
    case 9:
      return 4;
    default:
      return 0;
  }
}

/// The fields of nodes or of cells that are asked for, in order; those found leave `missing`.
std::vector<const mesh::Field*> chosen(const std::vector<mesh::Field>& fields, const std::vector<std::string>& names,
                                       std::vector<std::string>& missing) {
  std::vector<const mesh::Field*> result;
  if (names.empty()) {
    for (const auto& field : fields)
      if (!field.holds_integers() && type_of(field) != 0) result.push_back(&field);
    return result;
  }
  for (const auto& name : names)
    for (const auto& field : fields) {
      if (field.name != name) continue;
      if (type_of(field) == 0)
        throw Error(fmt::format("Medit: expected a field of 1, 3, 6 or 9 components, found {} in '{}'",
                                field.n_components, name));
      result.push_back(&field);
      std::erase(missing, name);
    }
  return result;
}

Section section_of(gmf::Keyword keyword, const char* name, std::int64_t n,
                   const std::vector<const mesh::Field*>& fields,
                   const std::function<mesh::Field(const mesh::Field&)>& in_order, bool as_text) {
  Section section{.keyword = keyword, .name = name, .n = n};
  std::vector<mesh::Field> ordered;
  for (const auto* field : fields) {
    section.types.push_back(type_of(*field));
    section.n_reals += field->n_components;
    ordered.push_back(in_order(*field));
  }
  if (ordered.empty()) return section;
  const auto n_rows =
      std::visit([](const auto& v) { return v.size(); }, ordered[0].value) / at(ordered[0].n_components);
  Rows rows(as_text ? 0 : 2);
  for (std::size_t i = 0; i < n_rows; ++i) {
    for (const auto& field : ordered) {
      const auto width = at(field.n_components);
      std::visit(
          [&](const auto& values) {
            for (std::size_t k = 0; k < width; ++k) rows.real(static_cast<double>(values[i * width + k]));
          },
          field.value);
    }
    rows.end();
  }
  section.text = rows.take();
  return section;
}

}  // namespace

std::vector<std::int64_t> medit_references(const mesh::MeshInfo& info, std::vector<std::string> names,
                                           std::vector<std::int64_t> numbers) {
  const auto untagged = static_cast<std::ptrdiff_t>(mesh::find_untagged(info.patches));
  const bool has_untagged = untagged < std::ssize(info.patches);
  if (has_untagged) {
    names.erase(names.begin() + untagged);
    numbers.erase(numbers.begin() + untagged);
  }
  auto references = patch_numbers(names, "ref_", 0, numbers);
  if (has_untagged) references.insert(references.begin() + untagged, -1);
  return references;
}

void write_medit(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                 Interfaces interfaces) {
  auto in_order = rows_in_order(comm, mesh, nullptr, interfaces);
  leave_out_untagged(in_order, mesh.info);
  const auto boundary = boundary_rows(in_order);
  const auto region = regions_of(comm, mesh, in_order.cell_to_node.size());
  const auto reference = medit_references(mesh.info, in_order.group_name, in_order.patch_number);
  std::vector<Section> sections{
      {.keyword = gmf::vertices, .name = "Vertices", .n = in_order.n_nodes, .n_reals = 3, .n_integers = 1},
      {.keyword = gmf::triangles, .name = "Triangles", .n = comm.sum(std::ssize(boundary)), .n_integers = 4},
      {.keyword = gmf::tetrahedra, .name = "Tetrahedra", .n = mesh.info.n_global_cells, .n_integers = 5}};
  const int version = version_of(file, sections);
  Rows rows(version);
  for (const auto p : in_order.position) {
    for (const auto x : {p.x, p.y, p.z}) rows.real(x);
    rows.integer(0);
    rows.end();
  }
  sections[0].text = rows.take();
  for (const auto& face : boundary) {
    for (const auto node : face.node) rows.integer(node + 1);
    rows.integer(reference[at(face.patch)]);
    rows.end();
  }
  sections[1].text = rows.take();
  for (std::size_t c = 0; c < in_order.cell_to_node.size(); ++c) {
    for (const auto node : in_order.cell_to_node[c]) rows.integer(node + 1);
    rows.integer(region[c]);
    rows.end();
  }
  sections[2].text = rows.take();
  write_sections(comm, file, sections, version);
}

MeditFields choose_medit_fields(const mesh::DistMesh& mesh, const std::vector<std::string>& names) {
  auto missing = names;
  MeditFields fields{chosen(mesh.node_fields, names, missing), chosen(mesh.cell_fields, names, missing)};
  if (!missing.empty()) throw Error(fmt::format("Medit: expected a field '{}', found none of that name", missing[0]));
  return fields;
}

void write_medit_fields(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                        const MeditFields& fields) {
  const auto& [of_nodes, of_cells] = fields;
  if (of_nodes.empty() && of_cells.empty())
    throw Error("Medit: expected fields of reals with 1, 3, 6 or 9 components to write, found none");
  par::agree(comm, [&] {
    for (const auto* list : {&fields.of_nodes, &fields.of_cells})
      for (const auto* field : *list)
        if (!field->holds_integers() &&
            !std::all_of(field->real().begin(), field->real().end(), [](double x) { return std::isfinite(x); }))
          throw Error(fmt::format("Medit: expected finite values to write, found others in field '{}'", field->name));
  });
  const bool as_text = is_text(file);
  std::vector<Section> sections;
  if (!of_nodes.empty())
    sections.push_back(section_of(
        gmf::sol_at_vertices, "SolAtVertices", mesh.info.n_global_nodes, of_nodes,
        [&](const mesh::Field& field) { return nodes_in_order(comm, mesh, field); }, as_text));
  if (!of_cells.empty())
    sections.push_back(section_of(
        gmf::sol_at_tetrahedra, "SolAtTetrahedra", mesh.info.n_global_cells, of_cells,
        [&](const mesh::Field& field) { return cells_in_order(comm, mesh, field); }, as_text));
  write_sections(comm, file, sections, version_of(file, sections));
}

}  // namespace pamr::io
