// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

namespace pamr::python {

/// The class `Mesh` of the module, and the functions that make one.
void bind_mesh(pybind11::module_& module);

}  // namespace pamr::python
