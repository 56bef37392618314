// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/read_cad.hpp"

#include "pamr/base/error.hpp"

#ifdef PAMR_CAD_LIBRARY
#include <dlfcn.h>

#include <string>

#include "pamr/geometry/cad/occt_reader.hpp"
#endif

namespace pamr::geometry {

#ifdef PAMR_CAD_LIBRARY

namespace {

/// Loads the library, which stays: what is read from a file has functions of it.
const CadReader* load_reader() {
  void* library = ::dlopen(PAMR_CAD_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  void* found = library == nullptr ? nullptr : ::dlsym(library, "pamr_cad_reader");
  if (found == nullptr) {
    const char* reason = ::dlerror();
    throw Error(std::string("expected the library by which PAMR reads CAD files (" PAMR_CAD_LIBRARY
                            ", installed with PAMR), found none that can be loaded: ") +
                (reason == nullptr ? "no reason is known" : reason));
  }
  return reinterpret_cast<decltype(&pamr_cad_reader)>(found)();
}

const CadReader& reader() {
  static const CadReader* const loaded = load_reader();
  return *loaded;
}

}  // namespace

bool can_read_cad() { return true; }
CadData read_cad(std::string_view text, double scale) { return reader().read(text, scale); }
CadTriangles triangulate_cad(std::string_view text, double scale, double deflection, bool is_assembly) {
  return reader().triangulate(text, scale, deflection, is_assembly);
}
CadAssembly assemble_cad(std::string_view text, double scale, std::span<const std::string> chosen) {
  return reader().assemble(text, scale, chosen);
}
CadMeasures measure_cad(std::string_view text, double scale) { return reader().measure(text, scale); }

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
CadTriangles triangulate_cad(std::string_view /*text*/, double /*scale*/, double /*deflection*/, bool /*is_assembly*/) {
  refuse_cad();
}
CadAssembly assemble_cad(std::string_view /*text*/, double /*scale*/, std::span<const std::string> /*chosen*/) {
  refuse_cad();
}
CadMeasures measure_cad(std::string_view /*text*/, double /*scale*/) { refuse_cad(); }

#endif

}  // namespace pamr::geometry
