// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstring>
#include <vector>

#include "pamr/mesh/field.hpp"

/// Between arrays of ours and those of numpy. The Python part of the package has seen to types and shapes.
namespace pamr::python {

template <class T>
using Array = pybind11::array_t<T, pybind11::array::c_style>;

/// An array that shows memory of `owner` and keeps it alive.
template <class T>
pybind11::array show(pybind11::handle owner, const T* data, std::vector<pybind11::ssize_t> shape, bool is_writable) {
  pybind11::array array(pybind11::dtype::of<T>(), std::move(shape), data, owner);
  if (!is_writable) array.attr("flags").attr("writeable") = false;
  return array;
}

/// An array of its own.
template <class T>
Array<T> copy_out(const std::vector<T>& values) {
  return Array<T>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

template <class Row, class T>
std::vector<Row> rows_of(const Array<T>& array) {
  static_assert(sizeof(Row) % sizeof(T) == 0);
  std::vector<Row> rows(static_cast<std::size_t>(array.size()) / (sizeof(Row) / sizeof(T)));
  if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), array.data(), rows.size() * sizeof(Row));
  return rows;
}

/// A field from an array of doubles or of 64-bit integers.
inline mesh::Field field_of(const std::string& name, const std::string& unit, const pybind11::array& values,
                            mesh::StorageType storage) {
  mesh::Field field{name, unit, values.ndim() == 1 ? 1 : static_cast<int>(values.shape(1)), storage, {}};
  if (mesh::is_integer(storage))
    field.value = rows_of<std::int64_t>(Array<std::int64_t>(values));
  else
    field.value = rows_of<double>(Array<double>(values));
  return field;
}

}  // namespace pamr::python
