// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/error.hpp"
#include "pamr/base/version.hpp"
#include "python/bind_mesh.hpp"
#include "python/bind_stages.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() = "The compiled part of the package pamr: no checks, no comfort. Use pamr.";
  pybind11::register_exception<pamr::Error>(module, "Error", PyExc_ValueError);
  module.attr("version") = pamr::version();
  pamr::python::bind_mesh(module);
  pamr::python::bind_stages(module);
}
