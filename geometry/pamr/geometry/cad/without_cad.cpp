// SPDX-License-Identifier: GPL-3.0-or-later
/// What a build without OpenCASCADE has in the place of `read_cad.cpp`.
#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/read_cad.hpp"

namespace pamr::geometry {

bool can_read_cad() { return false; }

CadData read_cad(std::string_view /*text*/, double /*scale*/) {
  throw Error(
      "expected a build of PAMR with OpenCASCADE for a surface of kind \"cad\", found one without: install "
      "libocct-data-exchange-dev and build with -DPAMR_CAD=ON (docs/building.md)");
}

}  // namespace pamr::geometry
