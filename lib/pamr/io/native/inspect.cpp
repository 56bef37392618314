// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/inspect.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/native/layout.hpp"

namespace pamr::io {

namespace {

using hdf5::Handle;

/// Of fields of nodes, of cells, and of triangulated surfaces with two datasets each, and some others.
constexpr std::size_t max_sums = 4 * max_fields + 64;
constexpr hsize_t max_small_values = 16;
/// A compressed array is at most so many times longer than its compressed form: the limit of the deflate format.
constexpr std::uint64_t max_inflation = 1032;

/// Walks through one file. Every failure is an `Error` that names the file and the object.
class Inspector {
 public:
  explicit Inspector(const std::filesystem::path& file);
  Catalog run();

 private:
  [[noreturn]] void fail(const std::string& path, const std::string& trouble) const {
    throw Error("file '" + file_.string() + "', " + path + ": " + trouble);
  }
  std::string at(const std::string& path, const char* trouble) const {
    return "file '" + file_.string() + "', " + path + ": " + trouble;
  }

  Handle object_at(const std::string& path) const;
  bool has_link(const std::string& path) const;
  bool has_group(const std::string& path) const;
  bool is_empty(const std::string& path) const;
  /// At most one more than `most`: then there are more.
  std::vector<std::string> first_names_in(const std::string& group, std::size_t most) const;
  std::vector<std::string> names_in(const std::string& group) const;
  void others_in(const std::string& group, std::span<const std::string_view> known);
  void others();

  /// `max_values`: how many integers it may be at most, to be read at once; 0: any numbers, not read here.
  void array(const std::string& path, hsize_t max_values);
  mesh::StorageType number_type(hid_t type, const std::string& path) const;
  bool check_layout(hid_t dataset, std::uint64_t bytes, const std::string& path);
  void check_filters(hid_t properties, const std::string& path) const;

  bool has_texts(const std::string& path) const;
  void text(const std::string& path);
  std::vector<std::string> texts_from(hid_t object, hid_t type, hid_t space, bool is_attribute,
                                      const std::string& path) const;
  void text_attribute(const std::string& path, const char* name);
  void number_attribute(const std::string& path, const std::string& name);
  void all_number_attributes(const std::string& path);
  void pamr();

  std::filesystem::path file_;
  Handle h5_;
  std::uint64_t file_bytes_ = 0;
  std::uint64_t claimed_bytes_ = 0;
  Catalog catalog_;
};

Inspector::Inspector(const std::filesystem::path& file) : file_(file) {
  std::error_code failed;
  file_bytes_ = std::filesystem::file_size(file, failed);
  if (failed) throw Error("file '" + file.string() + "': expected a file on a disk, found: " + failed.message());
  const int probe = open(file.c_str(), O_RDONLY | O_CLOEXEC);  // HDF5 would say why in its own words
  if (probe < 0)
    throw Error("file '" + file.string() + "': expected a file that can be opened, found: " + std::strerror(errno));
  close(probe);
  auto access = hdf5::take(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "cannot make a property list");
  H5Pset_file_locking(access.id(), true, true);
  h5_ = Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
  if (!h5_.is_open())
    throw Error("file '" + file.string() + "': expected a complete HDF5 file, HDF5 says: " + hdf5::last_error());
}

Catalog Inspector::run() {
  if (!has_group("/VTKHDF")) fail("/VTKHDF", "expected this group, found none");
  number_attribute("/VTKHDF", "Version");
  text_attribute("/VTKHDF", "Type");
  for (const auto* name : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
    array(std::string("/VTKHDF/") + name, max_small_values);
  for (const auto* name : {"Points", "Connectivity", "Offsets", "Types"}) array(std::string("/VTKHDF/") + name, 0);
  for (const std::string group : {"/VTKHDF/PointData", "/VTKHDF/CellData"}) {
    if (!has_group(group)) continue;
    for (const auto& name : names_in(group)) {
      const auto path = group + "/" + name;
      if (has_texts(path)) {
        catalog_.others.push_back(path);
        continue;
      }
      array(path, 0);
      text_attribute(path, "unit");
    }
  }
  if (has_group("/VTKHDF/Steps")) number_attribute("/VTKHDF/Steps", "NSteps");
  if (has_group("/PAMR")) pamr();
  others();
  return std::move(catalog_);
}

/// Objects beside those of the format, in its own groups. Attributes are not looked at.
void Inspector::others() {
  using Names = std::initializer_list<std::string_view>;
  const auto look = [&](const std::string& group, Names known) {
    if (group == "/" || has_group(group)) others_in(group, std::span(known.begin(), known.size()));
  };
  look("/", {"VTKHDF", "PAMR"});
  look("/VTKHDF", {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds", "Points", "Connectivity", "Offsets",
                   "Types", "PointData", "CellData", "Steps"});
  if (!catalog_.has_pamr_group) return;
  look("/PAMR", {"cell_to_cell", "boundary", "lineage", "patches", "regions", "surfaces", "surface_data", "level0",
                 "provenance", "checksums"});
  look("/PAMR/patches", {"names", "kinds", "surfaces", "numbers", "conditions", "groups"});
  look("/PAMR/regions", {"numbers", "names", "groups"});
  look(path::boundary, {"triangles", "patch"});
  look(path::checksums, {});
  if (has_group("/PAMR/surface_data"))
    for (const auto& name : names_in("/PAMR/surface_data")) look("/PAMR/surface_data/" + name, {"points", "triangles"});
  if (!has_group(path::level0)) return;
  std::vector<std::string_view> columns;
  for (const auto& column : level0_columns) columns.emplace_back(column.name);
  others_in(path::level0, columns);
}

void Inspector::others_in(const std::string& group, std::span<const std::string_view> known) {
  constexpr std::size_t most = 1000;
  constexpr std::array<std::string_view, 5> of_vtk{"FieldData", "FaceConnectivity", "FaceOffsets", "PolyhedronToFaces",
                                                   "PolyhedronOffsets"};  // which it makes for nothing, too
  const auto names = first_names_in(group, most);
  for (const auto& name : names) {
    const auto path = (group == "/" ? "" : group) + "/" + name;
    const auto is_one_of = [&](const auto& all) { return std::find(all.begin(), all.end(), name) != all.end(); };
    if (is_one_of(known) || (group == "/VTKHDF" && is_one_of(of_vtk) && is_empty(path))) continue;
    if (catalog_.others.size() < most) catalog_.others.push_back(path);
  }
}

void Inspector::pamr() {
  catalog_.has_pamr_group = true;
  number_attribute("/PAMR", "format");
  number_attribute("/PAMR", "fingerprint");
  number_attribute("/PAMR", "first_id");
  text_attribute("/PAMR", "length_unit");
  for (const auto* name : {"cell_to_cell", "lineage"})
    if (has_link(std::string("/PAMR/") + name)) array(std::string("/PAMR/") + name, 0);
  for (const auto* name : {"surfaces", "provenance"})
    if (has_link(std::string("/PAMR/") + name)) text(std::string("/PAMR/") + name);
  if (has_group("/PAMR/patches"))
    for (const auto* name : {"names", "kinds", "surfaces", "groups"})
      if (has_link(std::string("/PAMR/patches/") + name)) text(std::string("/PAMR/patches/") + name);
  for (const auto* path : {path::patch_numbers, path::patch_conditions})
    if (has_group("/PAMR/patches") && has_link(path)) array(path, max_patch_numbers);
  if (has_group(path::boundary)) {
    array(path::boundary_triangles, 0);
    array(path::boundary_patch, 0);
  }
  if (has_group("/PAMR/regions")) {
    array("/PAMR/regions/numbers", max_regions);
    text("/PAMR/regions/names");
    if (has_link(path::region_groups)) text(path::region_groups);
  }
  if (has_group("/PAMR/surface_data"))
    for (const auto& name : names_in("/PAMR/surface_data")) {
      const auto path = "/PAMR/surface_data/" + name;
      if (!has_group(path)) fail(path, "expected a group, found another object");
      array(path + "/points", 0);
      array(path + "/triangles", 0);
    }
  if (has_group(path::level0))
    for (const auto& column : level0_columns) array(column.path(), 0);
  if (has_group("/PAMR/checksums")) all_number_attributes("/PAMR/checksums");
}

Handle Inspector::object_at(const std::string& path) const {
  return hdf5::take(H5Oopen(h5_.id(), path.c_str(), H5P_DEFAULT), H5Oclose, at(path, "cannot open it"));
}

/// Whether an object hangs there by a plain link; a soft or external link could lead anywhere, so it is refused.
bool Inspector::has_link(const std::string& path) const {
  const auto exists = H5Lexists(h5_.id(), path.c_str(), H5P_DEFAULT);
  hdf5::require(exists >= 0, at(path, "cannot look it up"));
  if (exists == 0) return false;
  H5L_info_t info;
  hdf5::require(H5Lget_info(h5_.id(), path.c_str(), &info, H5P_DEFAULT) >= 0, at(path, "cannot look it up"));
  if (info.type != H5L_TYPE_HARD) fail(path, "expected the object itself, found a soft or external link");
  return true;
}

bool Inspector::has_group(const std::string& path) const {
  if (!has_link(path)) return false;
  const auto object = object_at(path);
  if (H5Iget_type(object.id()) != H5I_GROUP) fail(path, "expected a group, found a dataset or type");
  return true;
}

/// Whether a group, or a dataset, has nothing in it.
bool Inspector::is_empty(const std::string& path) const {
  if (!has_link(path)) return true;
  const auto object = object_at(path);
  if (H5Iget_type(object.id()) == H5I_GROUP) {
    H5G_info_t info;
    return H5Gget_info(object.id(), &info) >= 0 && info.nlinks == 0;
  }
  if (H5Iget_type(object.id()) != H5I_DATASET) return false;
  const Handle space(H5Dget_space(object.id()), H5Sclose);
  return H5Sget_simple_extent_npoints(space.id()) <= 0;
}

std::vector<std::string> Inspector::first_names_in(const std::string& group, std::size_t most) const {
  struct List {
    std::size_t most;
    std::vector<std::string> names;
  } list{most, {}};
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
    auto& to = *static_cast<List*>(data);
    to.names.emplace_back(name);
    return to.names.size() > to.most ? 1 : 0;
  };
  hsize_t start = 0;
  hdf5::require(
      H5Literate_by_name(h5_.id(), group.c_str(), H5_INDEX_NAME, H5_ITER_INC, &start, add, &list, H5P_DEFAULT) >= 0,
      at(group, "cannot list it"));
  return std::move(list.names);
}

std::vector<std::string> Inspector::names_in(const std::string& group) const {
  auto names = first_names_in(group, max_fields);
  if (names.size() > max_fields) fail(group, fmt::format("expected at most {} objects, found more", max_fields));
  return names;
}

mesh::StorageType Inspector::number_type(hid_t type, const std::string& path) const {
  using mesh::StorageType;
  for (int i = 0; i <= static_cast<int>(StorageType::uint16); ++i) {
    const auto candidate = static_cast<StorageType>(i);
    const auto little = hdf5::file_type(candidate);
    const Handle big(H5Tcopy(little), H5Tclose);
    if (H5Tget_size(little) > 1) H5Tset_order(big.id(), H5T_ORDER_BE);
    if (H5Tequal(type, little) > 0 || H5Tequal(type, big.id()) > 0) return candidate;
  }
  const auto kind = H5Tget_class(type);
  fail(path, std::string("expected numbers (float32, float64 or integers of 8 to 64 bits), found ") +
                 (kind == H5T_ENUM     ? "an enumeration (a Boolean field has to be written as uint8)"
                  : kind == H5T_STRING ? "text"
                                       : "another type"));
}

/// Whether a dataset hangs there whose values are texts.
bool Inspector::has_texts(const std::string& path) const {
  if (!has_link(path)) return false;
  const auto object = object_at(path);
  if (H5Iget_type(object.id()) != H5I_DATASET) return false;
  const Handle type(H5Dget_type(object.id()), H5Tclose);
  return H5Tget_class(type.id()) == H5T_STRING;
}

void Inspector::array(const std::string& path, hsize_t max_values) {
  if (!has_link(path)) fail(path, "expected this dataset, found none");
  const auto dataset =
      hdf5::take(H5Dopen2(h5_.id(), path.c_str(), H5P_DEFAULT), H5Dclose, at(path, "expected a dataset"));
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
  const Handle space(H5Dget_space(dataset.id()), H5Sclose);
  ArrayEntry entry{path, number_type(type.id(), path), {}, {}, false};
  const int rank = H5Sget_simple_extent_ndims(space.id());
  if (H5Sget_simple_extent_type(space.id()) != H5S_SIMPLE || rank < 1 || rank > 2)
    fail(path, fmt::format("expected 1 or 2 dimensions, found {}", std::max(rank, 0)));
  std::array<hsize_t, 2> dims{1, 1};
  H5Sget_simple_extent_dims(space.id(), dims.data(), nullptr);
  constexpr hsize_t limit = hsize_t{1} << 56U;
  if (dims[0] > limit || dims[1] > limit || (dims[1] > 0 && dims[0] > limit / dims[1]))
    fail(path, fmt::format("expected a possible shape, found {} x {}", dims[0], dims[1]));
  for (int d = 0; d < rank; ++d) entry.shape.push_back(static_cast<std::int64_t>(dims[static_cast<std::size_t>(d)]));
  entry.is_chunked = check_layout(dataset.id(), dims[0] * dims[1] * hdf5::size_of(entry.type), path);
  if (max_values > 0) {
    if (!mesh::is_integer(entry.type) || dims[0] * dims[1] > max_values)
      fail(path, fmt::format("expected a few integers, found {} and {} values", hdf5::to_text(entry.type),
                             dims[0] * dims[1]));
    entry.values.resize(dims[0] * dims[1]);
    hdf5::require(H5Dread(dataset.id(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, entry.values.data()) >= 0,
                  at(path, "cannot read it"));
  }
  catalog_.arrays.push_back(std::move(entry));
}

/// The dataset lies inside this file, and all of them together are no longer than it. Whether it is in chunks.
bool Inspector::check_layout(hid_t dataset, std::uint64_t bytes, const std::string& path) {
  const auto properties = hdf5::take(H5Dget_create_plist(dataset), H5Pclose, at(path, "cannot read how it is stored"));
  const auto layout = H5Pget_layout(properties.id());
  const std::uint64_t stored = H5Dget_storage_size(dataset);
  if (layout == H5D_CONTIGUOUS) {
    if (H5Pget_external_count(properties.id()) != 0) fail(path, "expected the data inside the file, found a reference");
    const auto offset = H5Dget_offset(dataset);
    if (bytes > 0 && (offset == HADDR_UNDEF || offset > file_bytes_ || bytes > file_bytes_ - offset))
      fail(path, fmt::format("expected {} bytes of data inside a file of {} bytes, found less", bytes, file_bytes_));
  } else if (layout == H5D_CHUNKED) {
    check_filters(properties.id(), path);
    if (bytes / max_inflation > stored) fail(path, fmt::format("expected {} bytes of data, found {}", bytes, stored));
  } else if (layout != H5D_COMPACT) {
    fail(path, "expected contiguous or chunked data, found a virtual dataset");
  }
  if (layout != H5D_CHUNKED && stored != bytes)
    fail(path, fmt::format("expected {} bytes of data, found {}", bytes, stored));
  claimed_bytes_ += std::min(stored, file_bytes_ + 1);
  if (claimed_bytes_ > file_bytes_)
    fail(path, fmt::format("expected datasets that fit the file of {} bytes, found that they claim more", file_bytes_));
  return layout == H5D_CHUNKED;
}

void Inspector::check_filters(hid_t properties, const std::string& path) const {
  std::array<hsize_t, 2> chunk{1, 1};
  const int rank = H5Pget_chunk(properties, 2, chunk.data());
  constexpr hsize_t limit = hsize_t{1} << 26U;
  if (rank < 1 || rank > 2 || chunk[0] > limit || chunk[1] > limit || chunk[0] * chunk[1] > limit)
    fail(path, fmt::format("expected chunks of at most {} values, found larger ones", limit));
  const int n_filters = H5Pget_nfilters(properties);
  for (int i = 0; i < n_filters; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t n_values = 0;
    const auto filter =
        H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &n_values, nullptr, 0, nullptr, &config);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
      fail(path,
           fmt::format("expected the filters deflate, shuffle and fletcher32 at most, found filter number {}", filter));
  }
}

void Inspector::text(const std::string& path) {
  const auto dataset =
      hdf5::take(H5Dopen2(h5_.id(), path.c_str(), H5P_DEFAULT), H5Dclose, at(path, "expected a dataset"));
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
  const Handle space(H5Dget_space(dataset.id()), H5Sclose);
  catalog_.texts.push_back({path, texts_from(dataset.id(), type.id(), space.id(), false, path)});
}

std::vector<std::string> Inspector::texts_from(hid_t object, hid_t type, hid_t space, bool is_attribute,
                                               const std::string& path) const {
  if (H5Tget_class(type) != H5T_STRING) fail(path, "expected text, found another type");
  if (H5Sget_simple_extent_type(space) == H5S_NULL) return {};
  const auto n_signed = H5Sget_simple_extent_npoints(space);
  if (n_signed < 0 || H5Sget_simple_extent_ndims(space) > 1) fail(path, "expected one text or a list, found a table");
  const auto n = static_cast<std::uint64_t>(n_signed);
  const auto size = H5Tget_size(type);
  if (size == 0 || n > file_bytes_ / size) fail(path, "expected texts that fit the file, found longer ones");
  const bool is_variable = H5Tis_variable_str(type) > 0;
  std::vector<char> bytes(n * size + 1, '\0');
  if (n > 0 && !is_variable) {
    const Handle memory(H5Tcopy(type), H5Tclose);
    const auto done = is_attribute ? H5Aread(object, memory.id(), bytes.data())
                                   : H5Dread(object, memory.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
    hdf5::require(done >= 0, at(path, "cannot read it"));
  }
  std::vector<char*> pointers(n, nullptr);
  if (n > 0 && is_variable) {
    const auto done = is_attribute ? H5Aread(object, type, pointers.data())
                                   : H5Dread(object, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data());
    hdf5::require(done >= 0, at(path, "cannot read it"));
  }
  // Only a text of this kind ends at its first NUL; what the others hold behind one would be lost without a word.
  const bool ends_at_nul = is_variable || H5Tget_strpad(type) == H5T_STR_NULLTERM;
  std::vector<std::string> texts;
  for (std::uint64_t i = 0; i < n; ++i) {
    const char* begin = is_variable ? pointers[i] : bytes.data() + i * size;
    const auto limit = is_variable ? std::numeric_limits<std::size_t>::max() : size;
    texts.emplace_back(
        begin == nullptr ? "" : std::string(begin, is_variable ? std::strlen(begin) : ::strnlen(begin, limit)));
    if (!ends_at_nul && std::any_of(begin + texts.back().size(), begin + size, [](char c) { return c != '\0'; }))
      fail(path,
           fmt::format("expected texts without NUL characters, found '{}' before one in row {}", texts.back(), i));
    if (is_variable && begin != nullptr) H5free_memory(pointers[i]);
  }
  return texts;
}

void Inspector::text_attribute(const std::string& path, const char* name) {
  const auto full = path + "@" + name;
  const auto exists = H5Aexists_by_name(h5_.id(), path.c_str(), name, H5P_DEFAULT);
  hdf5::require(exists >= 0, at(full, "cannot look it up"));
  if (exists == 0) return;
  const auto attribute = hdf5::take(H5Aopen_by_name(h5_.id(), path.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                                    at(full, "cannot open it"));
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  catalog_.texts.push_back({full, texts_from(attribute.id(), type.id(), space.id(), true, full)});
}

void Inspector::number_attribute(const std::string& path, const std::string& name) {
  const auto full = path + "@" + name;
  const auto exists = H5Aexists_by_name(h5_.id(), path.c_str(), name.c_str(), H5P_DEFAULT);
  hdf5::require(exists >= 0, at(full, "cannot look it up"));
  if (exists == 0) return;
  const auto attribute = hdf5::take(H5Aopen_by_name(h5_.id(), path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                                    H5Aclose, at(full, "cannot open it"));
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  const auto n = H5Sget_simple_extent_npoints(space.id());
  if (H5Tget_class(type.id()) != H5T_INTEGER || n < 1 || n > static_cast<hssize_t>(max_small_values))
    fail(full, "expected a few integers, found another type or number");
  const bool is_unsigned = H5Tget_sign(type.id()) == H5T_SGN_NONE;
  NumberEntry entry{full, std::vector<std::int64_t>(static_cast<std::size_t>(n))};
  hdf5::require(H5Aread(attribute.id(), is_unsigned ? H5T_NATIVE_UINT64 : H5T_NATIVE_INT64, entry.values.data()) >= 0,
                at(full, "cannot read it"));
  catalog_.numbers.push_back(std::move(entry));
}

void Inspector::all_number_attributes(const std::string& path) {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5A_info_t*, void* data) -> herr_t {
    auto& list = *static_cast<std::vector<std::string>*>(data);
    list.emplace_back(name);
    return list.size() > max_sums ? 1 : 0;
  };
  hsize_t start = 0;
  hdf5::require(
      H5Aiterate_by_name(h5_.id(), path.c_str(), H5_INDEX_NAME, H5_ITER_INC, &start, add, &names, H5P_DEFAULT) >= 0,
      at(path, "cannot list its attributes"));
  if (names.size() > max_sums) fail(path, fmt::format("expected at most {} attributes, found more", max_sums));
  for (const auto& name : names) number_attribute(path, name);
}

}  // namespace

Catalog inspect(const std::filesystem::path& file) {
  const hdf5::Silence silence;
  return Inspector(file).run();
}

}  // namespace pamr::io
