// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/read_cad.hpp"

#ifdef PAMR_HAS_CAD
#include "pamr/geometry/cad/occt_reader.hpp"
#else
#include "pamr/base/error.hpp"
#endif

namespace pamr::geometry {

#ifdef PAMR_HAS_CAD

bool can_read_cad() { return true; }
CadData read_cad(std::string_view text, double scale) { return occt_read(text, scale); }
CadTriangles triangulate_cad(std::string_view text, double scale, double deflection) {
  return occt_triangles(text, scale, deflection);
}
CadMeasures measure_cad(std::string_view text, double scale) { return occt_measure(text, scale); }

#else

namespace {

[[noreturn]] void refuse_cad() {
  throw Error(
      "expected a build of PAMR with OpenCASCADE for a surface of kind \"cad\", found one without: install "
      "libocct-data-exchange-dev and build with -DPAMR_CAD=ON (docs/building.md)");
}

}  // namespace

bool can_read_cad() { return false; }
CadData read_cad(std::string_view /*text*/, double /*scale*/) { refuse_cad(); }
CadTriangles triangulate_cad(std::string_view /*text*/, double /*scale*/, double /*deflection*/) { refuse_cad(); }
CadMeasures measure_cad(std::string_view /*text*/, double /*scale*/) { refuse_cad(); }

#endif

}  // namespace pamr::geometry
