// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/io/native/hdf5.hpp"

/// The tree of a CGNS file on HDF5. Source: CGNS documentation, "SIDS File Mapping Manual" (HDF5). Local; nothing in the
/// file is trusted.
namespace pamr::io::cgns {

/// A node: a group with a label and, perhaps, data.
struct Node {
  std::string path, name, label;
};

/// Is called with the bytes that an array will have in memory, before it is read.
using BeforeRead = std::function<void(std::uint64_t bytes)>;

class Tree {
 public:
  /// Throws `Error`, without the name of the file, as all that follow do.
  explicit Tree(const std::filesystem::path& file, BeforeRead before_read = {});

  /// Children with this label, or all where it is empty, in the order in which they were made.
  std::vector<Node> children(const std::string& path, std::string_view label) const;
  /// The one child with this label. `none`: returns a node without a path where there is none.
  Node child(const std::string& path, std::string_view label, bool may_be_missing = false) const;
  bool has_data(const Node& node) const;
  std::string text(const Node& node) const;
  std::vector<std::int64_t> integers(const Node& node) const;
  std::vector<double> reals(const Node& node) const;
  /// Whether the data are integers.
  bool is_integer(const Node& node) const;
  std::int64_t n_values(const Node& node) const;

 private:
  hdf5::Handle open_data(const Node& node) const;
  template <class T>
  std::vector<T> read(const Node& node, hid_t type) const;
  std::string attribute(const std::string& path, const char* name) const;

  hdf5::Handle h5_;
  std::int64_t file_bytes_ = 0;
  BeforeRead before_read_;
};

/// Counts children that nothing is read of by their labels: units, reference states, texts, data of conditions, ...
/// Numbers that only order them are nothing. Local.
void count_others(const Tree& tree, const std::string& path, std::initializer_list<std::string_view> known,
                  std::map<std::string, std::int64_t>& left_out);

}  // namespace pamr::io::cgns
