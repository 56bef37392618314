// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/cgns/cgns_nodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/native/preflight.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io::cgns {

namespace {

constexpr const char* data_name = " data";
constexpr std::size_t longest_text = 1000;
constexpr std::size_t max_nodes = 100000;  ///< of one parent

}  // namespace

Tree::Tree(const std::filesystem::path& file, BeforeRead before_read) : before_read_(std::move(before_read)) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) throw Error("expected a file, found none");
  if (!has_hdf5_signature(file)) {
    const auto what = what_begins(file);
    throw Error("expected a CGNS file on HDF5, found " + (what.empty() ? "no HDF5 signature" : what));
  }
  file_bytes_ = static_cast<std::int64_t>(std::filesystem::file_size(file, none));
  const auto access = hdf5::take(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "cannot make a property list");
  H5Pset_file_locking(access.id(), true, true);
  h5_ = hdf5::take(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose,
                   "expected a complete HDF5 file, found another");
  if (attribute("/", "label") != "Root Node of HDF5 File") throw Error("expected a CGNS file, found other HDF5 data");
}

std::string Tree::attribute(const std::string& path, const char* name) const {
  if (H5Aexists_by_name(h5_.id(), path.c_str(), name, H5P_DEFAULT) <= 0) return {};
  const auto found = hdf5::take(H5Aopen_by_name(h5_.id(), path.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                                path + ": cannot read its attributes");
  const hdf5::Handle type(H5Aget_type(found.id()), H5Tclose), space(H5Aget_space(found.id()), H5Sclose);
  const auto size = H5Tget_size(type.id());
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0 || size == 0 || size > longest_text ||
      H5Sget_simple_extent_npoints(space.id()) != 1)
    throw Error(fmt::format("{}: expected a text as {}, found another type", path, name));
  std::string text(size, '\0');
  hdf5::require(H5Aread(found.id(), type.id(), text.data()) >= 0, path + ": cannot read its attributes");
  return text.substr(0, text.find('\0'));
}

std::vector<Node> Tree::children(const std::string& path, std::string_view label) const {
  struct Found {
    std::vector<std::string> names;
    bool has_links = false;
  } found;
  const auto add = [](hid_t, const char* name, const H5L_info_t* info, void* to) -> herr_t {
    auto& all = *static_cast<Found*>(to);
    if (name[0] == ' ') return 0;  // data
    if (info->type != H5L_TYPE_HARD)
      all.has_links = true;
    else
      all.names.emplace_back(name);
    return all.names.size() > max_nodes ? -1 : 0;
  };
  hsize_t start = 0;
  const auto group = hdf5::take(H5Gopen2(h5_.id(), path.c_str(), H5P_DEFAULT), H5Gclose, path + ": expected a group");
  if (H5Literate(group.id(), H5_INDEX_CRT_ORDER, H5_ITER_INC, &start, add, &found) < 0) {
    start = 0;
    found = {};
    hdf5::require(H5Literate(group.id(), H5_INDEX_NAME, H5_ITER_INC, &start, add, &found) >= 0,
                  path + ": cannot list it");
  }
  std::vector<Node> nodes;
  for (const auto& name : found.names) {
    const auto full = (path == "/" ? "" : path) + "/" + name;
    if (!is_clean_text(name, "")) throw Error(path + ": expected names without control characters, found another");
    if (attribute(full, "type") == "LK") throw Error(full + ": expected a node of this file, found a link to another");
    if (auto own = attribute(full, "label"); label.empty() || own == label)
      nodes.push_back({full, name, std::move(own)});
  }
  return nodes;
}

Node Tree::child(const std::string& path, std::string_view label, bool may_be_missing) const {
  auto all = children(path, label);
  if (all.empty() && may_be_missing) return {};
  if (all.size() != 1) throw Error(fmt::format("{}: expected one {}, found {}", path, label, all.size()));
  return std::move(all.front());
}

bool Tree::has_data(const Node& node) const {
  return !node.path.empty() && H5Lexists(h5_.id(), (node.path + "/" + data_name).c_str(), H5P_DEFAULT) > 0;
}

hdf5::Handle Tree::open_data(const Node& node) const {
  return hdf5::take(H5Dopen2(h5_.id(), (node.path + "/" + data_name).c_str(), H5P_DEFAULT), H5Dclose,
                    node.path + ": expected data");
}

std::int64_t Tree::n_values(const Node& node) const {
  const auto data = open_data(node);
  const hdf5::Handle space(H5Dget_space(data.id()), H5Sclose);
  return std::max<std::int64_t>(0, H5Sget_simple_extent_npoints(space.id()));
}

bool Tree::is_integer(const Node& node) const {
  const auto data = open_data(node);
  const hdf5::Handle type(H5Dget_type(data.id()), H5Tclose);
  return H5Tget_class(type.id()) == H5T_INTEGER;
}

template <class T>
std::vector<T> Tree::read(const Node& node, hid_t type) const {
  const auto data = open_data(node);
  const hdf5::Handle stored(H5Dget_type(data.id()), H5Tclose);
  const hdf5::Handle properties(H5Dget_create_plist(data.id()), H5Pclose);
  const auto kind = H5Tget_class(stored.id());
  if (kind != H5T_INTEGER && kind != H5T_FLOAT) throw Error(node.path + ": expected numbers, found other data");
  if (H5Pget_external_count(properties.id()) != 0)
    throw Error(node.path + ": expected the data inside the file, found a reference");
  const auto n = n_values(node), size = static_cast<std::int64_t>(std::max<std::size_t>(1, H5Tget_size(stored.id())));
  const auto in_file = std::min(file_bytes_, static_cast<std::int64_t>(H5Dget_storage_size(data.id())));
  const auto packing = H5Pget_nfilters(properties.id()) > 0 ? std::int64_t{1100} : std::int64_t{1};
  if (n > (packing > 1 ? packing * in_file : file_bytes_) / size)
    throw Error(fmt::format("{}: expected values that fit the file, found {}", node.path, n));
  if (before_read_) before_read_(static_cast<std::uint64_t>(n) * sizeof(T));
  std::vector<T> values;
  assign_array(values, static_cast<std::size_t>(n), T{});
  hdf5::require(H5Dread(data.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0,
                node.path + ": cannot read its data");
  return values;
}

std::vector<std::int64_t> Tree::integers(const Node& node) const {
  if (!is_integer(node)) throw Error(node.path + ": expected integers, found other data");
  return read<std::int64_t>(node, H5T_NATIVE_INT64);
}

std::vector<double> Tree::reals(const Node& node) const { return read<double>(node, H5T_NATIVE_DOUBLE); }

std::string Tree::text(const Node& node) const {
  if (!has_data(node)) return {};
  const auto bytes = read<std::int8_t>(node, H5T_NATIVE_INT8);
  std::string text;
  for (const auto byte : bytes) text += static_cast<char>(byte);
  return text.substr(0, text.find('\0'));
}

void count_others(const Tree& tree, const std::string& path, std::initializer_list<std::string_view> known,
                  std::map<std::string, std::int64_t>& left_out) {
  for (const auto& node : tree.children(path, ""))
    if (node.label != "Ordinal_t" && std::find(known.begin(), known.end(), node.label) == known.end())
      ++left_out[shown_text(node.label)];
}

}  // namespace pamr::io::cgns
