// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: CGNS documentation, "Standard Interface Data Structures" and "SIDS File Mapping Manual" (HDF5);
// attributes and storage of nodes as the library of CGNS (github.com/CGNS/CGNS, src/adfh) has them.
#include "pamr/io/export/write_cgns.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/io/elements/numbers.hpp"
#include "pamr/io/export/exported_fields.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/rows_in_order.hpp"
#include "pamr/io/shared_output.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::io {

namespace {

constexpr std::size_t name_length = 32;

/// An array that all ranks write: where it is, as soon as the first rank has made it, and this rank's part of each of its
/// pieces, which follow one another.
struct LargeArray {
  std::int64_t begin = -1;  ///< byte in the file, on the first rank
  std::vector<std::function<std::string()>> parts;
};

/// Makes the nodes of the tree on the first rank: a group with attributes, and its data in a dataset.
class CgnsTree {
 public:
  /// `path`: where it is made; `file`: its name for messages.
  CgnsTree(const std::filesystem::path& path, const std::filesystem::path& file)
      : file_("file '" + file.string() + "'") {
    const auto creation = hdf5::take(H5Pcreate(H5P_FILE_CREATE), H5Pclose, file_);
    const auto access = hdf5::take(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, file_);
    group_ = hdf5::take(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, file_);
    contiguous_ = hdf5::take(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, file_);
    compact_ = hdf5::take(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, file_);
    constexpr unsigned ordered = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
    hdf5::require(
        H5Pset_link_creation_order(creation.id(), ordered) >= 0 && H5Pset_obj_track_times(creation.id(), false) >= 0 &&
            H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18) >= 0 &&
            H5Pset_link_creation_order(group_.id(), ordered) >= 0 && H5Pset_obj_track_times(group_.id(), false) >= 0 &&
            H5Pset_obj_track_times(contiguous_.id(), false) >= 0 &&
            H5Pset_alloc_time(contiguous_.id(), H5D_ALLOC_TIME_EARLY) >= 0 &&
            H5Pset_fill_time(contiguous_.id(), H5D_FILL_TIME_NEVER) >= 0 &&
            H5Pset_obj_track_times(compact_.id(), false) >= 0 && H5Pset_layout(compact_.id(), H5D_COMPACT) >= 0,
        file_ + ": cannot choose how it is stored");
    h5_ = hdf5::take(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose,
                     file_ + ": cannot create it");
    const auto root = hdf5::take(H5Gopen2(h5_.id(), "/", H5P_DEFAULT), H5Gclose, file_);
    describe(root.id(), "HDF5 MotherNode", "Root Node of HDF5 File", "MT");
    put(root.id(), " format", H5T_NATIVE_CHAR, {15}, "IEEE_LITTLE_32", 15);
    std::string version = "HDF5 Version 1.8.0";  // the lowest that reads it; that of the library would change the bytes
    version.resize(name_length + 1);
    put(root.id(), " hdf5version", H5T_NATIVE_CHAR, {name_length + 1}, version.data(), version.size());
  }

  /// A node without data. `path` ends in its name.
  void node(const std::string& path, const char* label) { (void)make(path, label, "MT"); }
  void text(const std::string& path, const char* label, std::string_view value) {
    const auto group = make(path, label, "C1");
    put(group.id(), " data", H5T_NATIVE_CHAR, {value.size()}, value.data(), value.size());
  }
  void real(const std::string& path, const char* label, float value) {
    const auto group = make(path, label, "R4");
    put(group.id(), " data", H5T_NATIVE_FLOAT, {1}, &value, sizeof(value));
  }
  void integers(const std::string& path, const char* label, const std::vector<std::int64_t>& values,
                const std::vector<hsize_t>& extent, bool is_wide) {
    const auto group = make(path, label, is_wide ? "I8" : "I4");
    std::string bytes;
    for (const auto value : values)
      is_wide ? append_bytes(bytes, value) : append_bytes(bytes, static_cast<std::int32_t>(value));
    put(group.id(), " data", is_wide ? H5T_NATIVE_INT64 : H5T_NATIVE_INT32, extent, bytes.data(), bytes.size());
  }
  /// Makes room for `n` numbers of a type ("R8", "I4", "I8"); returns where they begin in the file.
  std::int64_t room(const std::string& path, const char* label, const char* type, std::int64_t n) {
    const auto group = make(path, label, type);
    const auto count = static_cast<hsize_t>(n);
    const auto space = hdf5::take(H5Screate_simple(1, &count, nullptr), H5Sclose, file_);
    const std::string_view name = type;
    const hid_t stored = name == "R8" ? H5T_NATIVE_DOUBLE : name == "I8" ? H5T_NATIVE_INT64 : H5T_NATIVE_INT32;
    const auto dataset =
        hdf5::take(H5Dcreate2(group.id(), " data", stored, space.id(), H5P_DEFAULT, contiguous_.id(), H5P_DEFAULT),
                   H5Dclose, file_ + ": cannot make " + path);
    const auto begin = H5Dget_offset(dataset.id());
    hdf5::require(n == 0 || begin != HADDR_UNDEF, file_ + ": cannot make room for " + path);
    return static_cast<std::int64_t>(begin);
  }
  void close() { hdf5::require(h5_.reset(), file_ + ": cannot complete it"); }

 private:
  hdf5::Handle make(const std::string& path, const char* label, const char* type) {
    auto group = hdf5::take(H5Gcreate2(h5_.id(), path.c_str(), H5P_DEFAULT, group_.id(), H5P_DEFAULT), H5Gclose,
                            file_ + ": cannot make " + path);
    describe(group.id(), path.substr(path.rfind('/') + 1), label, type);
    const hsize_t one = 1;
    const auto space = hdf5::take(H5Screate_simple(1, &one, nullptr), H5Sclose, file_);
    const auto attribute = hdf5::take(
        H5Acreate2(group.id(), "flags", H5T_NATIVE_INT, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose, file_);
    const int flags = 1;
    hdf5::require(H5Awrite(attribute.id(), H5T_NATIVE_INT, &flags) >= 0, file_);
    return group;
  }
  void describe(hid_t group, const std::string& name, const char* label, const char* type) const {
    text_attribute(group, "name", name, name_length + 1);
    text_attribute(group, "label", label, name_length + 1);
    text_attribute(group, "type", type, 3);
  }
  void text_attribute(hid_t group, const char* name, std::string value, std::size_t size) const {
    value.resize(size);
    const auto type = hdf5::take(H5Tcopy(H5T_C_S1), H5Tclose, file_);
    H5Tset_size(type.id(), size);
    const auto space = hdf5::take(H5Screate(H5S_SCALAR), H5Sclose, file_);
    const auto attribute =
        hdf5::take(H5Acreate2(group, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose, file_);
    hdf5::require(H5Awrite(attribute.id(), type.id(), value.data()) >= 0, file_ + ": cannot write a name");
  }
  void put(hid_t group, const char* name, hid_t type, const std::vector<hsize_t>& extent, const void* data,
           std::size_t n_bytes) const {
    if (n_bytes == 0) return;
    const auto space =
        hdf5::take(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose, file_);
    const auto dataset =
        hdf5::take(H5Dcreate2(group, name, type, space.id(), H5P_DEFAULT, compact_.id(), H5P_DEFAULT), H5Dclose, file_);
    hdf5::require(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0, file_ + ": cannot write it");
  }

  std::string file_;
  hdf5::Handle h5_, group_, contiguous_, compact_;
};

/// Names of nodes of the tree beside those that are `taken`.
NameRule rule_of(const char* what, std::vector<std::string> taken) {
  taken.insert(taken.end(), {".", ".."});
  return {.format = "CGNS",
          .what = what,
          .is_allowed = [](char c) { return c != '/'; },
          .longest = name_length,
          .taken = std::move(taken),
          .has_outer_blanks = false};  // names with a blank before them are the format's own
}

const char* condition_of(const std::string& kind) {
  if (kind == "wall") return "BCWall";
  if (kind == "symmetry" || kind == "symmetryPlane") return "BCSymmetryPlane";
  if (kind == "farfield") return "BCFarfield";
  if (kind == "inflow") return "BCInflow";
  if (kind == "outflow") return "BCOutflow";
  return "UserDefined";
}

class CgnsWriter {
 public:
  CgnsWriter(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh, const Remark& remark)
      : comm_(comm),
        mesh_(mesh),
        remark_(remark),
        rows_(rows_in_order(comm, mesh, nullptr, Interfaces::patches)),
        out_(comm, file) {
    leave_out_untagged(rows_, mesh.info);
    is_inside_ = mesh::patches_inside_alone(comm, mesh);
    collect_faces();
    std::int64_t n_elements = mesh.info.n_global_cells;
    for (const auto& patch : faces_) n_elements += n_faces_.emplace_back(comm.sum(std::ssize(patch)));
    for (const auto& patch : inner_faces_) n_elements += n_inner_.emplace_back(comm.sum(std::ssize(patch)));
    is_wide_ = std::max(n_elements, rows_.n_nodes) > std::numeric_limits<std::int32_t>::max();
  }

  void write() {
    par::agree(comm_, [&] {
      const hdf5::Silence silence;
      if (comm_.is_first()) tree_.emplace_back(out_.path(), out_.file());
    });
    par::agree(comm_, [&] {
      const hdf5::Silence silence;
      head();
      coordinates();
      elements();
      conditions();
      fields("NodeFields", "Vertex", exported_fields(mesh_.node_fields), rows_.n_nodes,
             [this](const mesh::Field& f) { return nodes_in_order(comm_, mesh_, f); });
      fields("CellFields", "CellCenter", exported_fields(mesh_.cell_fields), mesh_.info.n_global_cells,
             [this](const mesh::Field& f) { return cells_in_order(comm_, mesh_, f); });
      for (auto& tree : tree_) tree.close();
    });
    for (const auto& array : arrays_) {
      auto begin = array.begin;
      for (const auto& make : array.parts) {
        const auto part = make();
        begin = out_.write_at(begin, std::as_bytes(std::span<const char>(part.data(), part.size())));
      }
    }
    out_.commit();
  }

 private:
  static constexpr const char* zone = "/Base/Zone1";  // the name that programs expect where there is one

  /// Faces inside of a patch that lies on the boundary, too, are apart: its condition is for the boundary alone.
  /// Collective.
  void collect_faces() {
    const auto n_patches = mesh_.info.patches.size();
    faces_.resize(n_patches);
    inner_faces_.resize(n_patches);
    const auto n_inside = mesh::count_inner_faces(comm_, mesh_);
    bool has_mixed = false;
    for (std::size_t p = 0; p < n_inside.size(); ++p) has_mixed = has_mixed || (n_inside[p] > 0 && !is_inside_[p]);
    const auto of_boundary = has_mixed ? rows_in_order(comm_, mesh_).group : std::vector<std::array<std::int32_t, 4>>();
    for (std::size_t c = 0; c < rows_.group.size(); ++c)
      for (std::size_t slot = 0; slot < 4; ++slot) {
        if (rows_.group[c][slot] < 0) continue;
        const auto patch = at(rows_.group[c][slot]);
        const bool is_apart = has_mixed && of_boundary[c][slot] < 0 && !is_inside_[patch];
        auto& node = (is_apart ? inner_faces_ : faces_)[patch].emplace_back();
        for (std::size_t k = 0; k < 3; ++k) node[k] = rows_.cell_to_node[c][at(mesh::tet::face_to_corner[slot][k])];
      }
  }

  template <class Make>
  void on_first(Make&& make) {
    for (auto& tree : tree_) make(tree);
  }
  const char* integer_type() const { return is_wide_ ? "I8" : "I4"; }
  void large(const std::string& path, const char* label, const char* type, std::int64_t n,
             std::vector<std::function<std::string()>> parts) {
    LargeArray array{.parts = std::move(parts)};
    on_first([&](CgnsTree& tree) { array.begin = tree.room(path, label, type, n); });
    arrays_.push_back(std::move(array));
  }
  void append_id(std::string& bytes, GlobalId id) const {
    is_wide_ ? append_bytes(bytes, id) : append_bytes(bytes, static_cast<std::int32_t>(id));
  }

  void head() {
    on_first([&](CgnsTree& tree) {
      tree.real("/CGNSLibraryVersion", "CGNSLibraryVersion_t", 3.4F);
      tree.integers("/Base", "CGNSBase_t", {3, 3}, {2}, false);
      tree.integers(zone, "Zone_t", {rows_.n_nodes, mesh_.info.n_global_cells, 0}, {3, 1}, is_wide_);
      tree.text(std::string(zone) + "/ZoneType", "ZoneType_t", "Unstructured");
      tree.node(std::string(zone) + "/GridCoordinates", "GridCoordinates_t");
    });
  }

  void coordinates() {
    for (const int axis : {0, 1, 2})
      large(fmt::format("{}/GridCoordinates/Coordinate{}", zone, "XYZ"[axis]), "DataArray_t", "R8", rows_.n_nodes,
            {[this, axis] {
              std::string bytes;
              bytes.reserve(8 * rows_.position.size());
              for (const auto p : rows_.position) append_bytes(bytes, axis == 0 ? p.x : axis == 1 ? p.y : p.z);
              return bytes;
            }});
  }

  /// A section of elements `first .. first + n`, counted from 1.
  void section(const std::string& name, std::int64_t type, std::int64_t first, std::int64_t n, std::int64_t n_corners,
               std::vector<std::function<std::string()>> parts) {
    const auto path = fmt::format("{}/{}", zone, name);
    on_first([&](CgnsTree& tree) {
      tree.integers(path, "Elements_t", {type, 0}, {2}, false);
      tree.integers(path + "/ElementRange", "IndexRange_t", {first, first + n - 1}, {2}, is_wide_);
    });
    large(path + "/ElementConnectivity", "DataArray_t", integer_type(), n_corners * n, std::move(parts));
  }

  template <class Rows>
  std::string corners(const Rows& rows) const {
    std::string bytes;
    for (const auto& row : rows)
      for (const auto node : row) append_id(bytes, node + 1);
    return bytes;
  }

  void elements() {
    section("GridElements", 10, 1, mesh_.info.n_global_cells, 4, {[this] { return corners(rows_.cell_to_node); }});
    const auto rule =
        rule_of("patch", {"ZoneType", "GridCoordinates", "GridElements", "ZoneBC", "NodeFields", "CellFields"});
    patch_name_ = written_names(rule, rows_.group_name, remark_);
    auto first = mesh_.info.n_global_cells + 1;
    for (std::size_t p = 0; p < faces_.size(); ++p) {
      first_face_.push_back(first);
      const auto n = n_faces_[p] + n_inner_[p];
      if (n == 0) continue;
      section(patch_name_[p], 5, first, n, 3,
              {[this, p] { return corners(faces_[p]); }, [this, p] { return corners(inner_faces_[p]); }});
      first += n;
    }
  }

  /// Patches inside alone have none: they are the sections of their names, as is the part inside of others.
  void conditions() {
    on_first([&](CgnsTree& tree) {
      const auto all = std::string(zone) + "/ZoneBC";
      tree.node(all, "ZoneBC_t");
      for (std::size_t p = 0; p < faces_.size(); ++p) {
        if (n_faces_[p] == 0 || is_inside_[p]) continue;
        const auto path = all + "/" + patch_name_[p];
        tree.text(path, "BC_t", condition_of(mesh_.info.patches[p].kind));
        tree.integers(path + "/PointRange", "IndexRange_t", {first_face_[p], first_face_[p] + n_faces_[p] - 1}, {2, 1},
                      is_wide_);
        tree.text(path + "/GridLocation", "GridLocation_t", "FaceCenter");
      }
    });
  }

  void fields(const std::string& name, const char* location, const std::vector<const mesh::Field*>& all, std::int64_t n,
              const std::function<mesh::Field(const mesh::Field&)>& in_order) {
    if (all.empty()) return;
    const auto path = fmt::format("{}/{}", zone, name);
    on_first([&](CgnsTree& tree) {
      tree.node(path, "FlowSolution_t");
      tree.text(path + "/GridLocation", "GridLocation_t", location);
    });
    std::vector<std::string> names, endings;
    for (const auto* field : all)
      for (int k = 0; k < field->n_components; ++k) {
        names.push_back(field->name);
        endings.push_back(field->n_components == 1   ? std::string()
                          : field->n_components == 3 ? std::string(1, "XYZ"[k])
                                                     : fmt::format("_{}", k + 1));
      }
    const auto written = written_names(rule_of("component of a field", {"GridLocation"}), names, remark_, endings);
    auto next = written.begin();
    for (const auto* field : all)
      for (int k = 0; k < field->n_components; ++k)
        large(path + "/" + *next++, "DataArray_t", field->holds_integers() ? "I8" : "R8", n,
              {[in_order, field, k] { return component(in_order(*field), k); }});
  }

  static std::string component(const mesh::Field& field, int k) {
    std::string bytes;
    std::visit(
        [&](const auto& values) {
          for (std::size_t i = at(k); i < values.size(); i += at(field.n_components)) append_bytes(bytes, values[i]);
        },
        field.value);
    return bytes;
  }

  const par::Comm& comm_;
  const mesh::DistMesh& mesh_;
  const Remark& remark_;
  RowsInOrder rows_;
  SharedOutput out_;
  std::vector<std::vector<std::array<GlobalId, 3>>> faces_;        ///< of each patch, this rank's
  std::vector<std::vector<std::array<GlobalId, 3>>> inner_faces_;  ///< of those on the boundary what lies inside
  std::vector<std::int64_t> n_faces_, n_inner_, first_face_;       ///< all ranks'
  std::vector<bool> is_inside_;                                    ///< of each patch whether it lies inside alone
  std::vector<std::string> patch_name_;
  bool is_wide_ = false;
  std::vector<CgnsTree> tree_;  ///< one on the first rank, none elsewhere
  std::vector<LargeArray> arrays_;
};

}  // namespace

void write_cgns(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                const Remark& remark) {
  CgnsWriter(comm, file, mesh, remark).write();
}

}  // namespace pamr::io
