// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

namespace pamr::python {

/// What is done with a mesh: marking, refining, balancing, measuring, locating, fetching data of parents.
void bind_stages(pybind11::module_& module);

}  // namespace pamr::python
