// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/cad_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/base/read_file.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"
#include "pamr/geometry/described_surface.hpp"
#include "pamr/geometry/surface_toml.hpp"

namespace pamr::geometry {

namespace {

constexpr std::array<std::pair<std::string_view, double>, 6> units_in_mm{
    {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"um", 1e-3}, {"in", 25.4}, {"ft", 304.8}}};

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    const int more = lead < 0x80 ? 0 : lead >= 0xc2 && lead < 0xe0 ? 1 : lead >= 0xe0 && lead < 0xf0 ? 2 : -1;
    if (more < 0 || (lead == 0xe0 && i < text.size() && static_cast<unsigned char>(text[i]) < 0xa0)) return false;
    for (int k = 0; k < more; ++k, ++i)
      if (i >= text.size() || (static_cast<unsigned char>(text[i]) & 0xc0U) != 0x80U) return false;
  }
  return true;
}

std::string from_latin_1(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x80) {
      result += c;
    } else if (code < 0xa0) {
      result += '?';  // a control character
    } else {
      result += static_cast<char>(0xc0U | (code >> 6U));
      result += static_cast<char>(0x80U | (code & 0x3fU));
    }
  }
  return result;
}

double millimeters(std::string_view unit) {
  for (const auto& [name, length] : units_in_mm)
    if (name == unit) return length;
  throw Error(fmt::format("unit: expected mm, cm, m, um, in or ft, found \"{}\"", unit));
}

}  // namespace

bool is_cad_unit(std::string_view unit) {
  return std::any_of(units_in_mm.begin(), units_in_mm.end(), [&](const auto& known) { return known.first == unit; });
}

bool is_cad_file(const std::filesystem::path& file) {
  auto extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 5> known{".step", ".stp", ".iges", ".igs", ".brep"};
  return std::find(known.begin(), known.end(), extension) != known.end();
}

CadSource read_cad_source(const std::filesystem::path& file) {
  if (!is_cad_file(file))
    throw Error(fmt::format("file '{}': expected a name that ends in .step, .stp, .iges, .igs or .brep, found \"{}\"",
                            file.string(), file.extension().string()));
  auto text = read_file(file);
  if (!text) throw Error(fmt::format("file '{}': expected a file that may be read, found none", file.string()));
  CadSource source{file.filename().string(), std::move(*text)};
  if (!is_utf8(source.text)) source.text = from_latin_1(source.text);
  const auto is_strange = [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return (code < 0x20 && c != '\t' && c != '\r' && c != '\n') || code == 0x7f;
  };
  if (source.text.empty() || std::any_of(source.text.begin(), source.text.end(), is_strange))
    throw Error(fmt::format("file '{}': expected text, found {}", file.string(),
                            source.text.empty() ? "nothing" : "control characters"));
  return source;
}

std::shared_ptr<const CadModel> make_cad_model(const CadSource& source, std::string_view unit, bool is_assembly) {
  const double length = millimeters(unit);
  try {
    auto data = read_cad(source.text, 1 / length);
    data.origin = {std::make_shared<const std::string>(source.text), 1 / length, is_assembly};
    return std::make_shared<const CadModel>(std::move(data));
  } catch (const Error& error) {
    throw Error(fmt::format("file '{}': {}", source.file, error.what()));
  }
}

CadAssembly make_cad_assembly(const CadSource& source, std::string_view unit, std::span<const std::string> chosen) {
  try {
    return assemble_cad(source.text, 1 / millimeters(unit), chosen);
  } catch (const Error& error) {
    throw Error(fmt::format("file '{}': {}", source.file, error.what()));
  }
}

CadMeasures measure_cad_source(const CadSource& source, std::string_view unit) {
  try {
    return measure_cad(source.text, 1 / millimeters(unit));
  } catch (const Error& error) {
    throw Error(fmt::format("file '{}': {}", source.file, error.what()));
  }
}

std::string cad_surface_table(const std::string& name, const CadSource& source, const std::string& unit,
                              std::span<const int> faces) {
  const auto numbers = listed(faces, {.most = all_items}, [](int face) { return std::to_string(face); });
  return fmt::format("[[surface]]\nname = {}\nkind = \"cad\"\nfile = {}\nunit = \"{}\"\nfaces = [{}]\n",
                     toml_text(name), toml_text(source.file), unit, numbers);
}

std::string cad_table(const CadSource& source) {
  const auto escaped = [](std::string_view text) {
    std::string result;
    for (const char c : text) {
      if (c == '\\' || c == '"') result += '\\';
      if (c == '\r')
        result += "\\r";
      else
        result += c;
    }
    return result;
  };
  return fmt::format("[[cad]]\nfile = \"{}\"\ntext = \"\"\"\n{}\"\"\"\n", escaped(source.file), escaped(source.text));
}

SurfaceSet cad_surfaces(const CadSource& source, const std::string& unit, const std::shared_ptr<const CadModel>& model,
                        std::span<const CadPart> parts, const std::string& where) {
  std::vector<DescribedSurface> described;
  for (const auto& [name, faces] : parts) {
    auto from_0 = faces;
    for (auto& face : from_0) --face;
    described.push_back(
        {name, std::make_shared<CadSurface>(model, std::move(from_0)), cad_surface_table(name, source, unit, faces)});
  }
  auto set = set_of(described, where);
  if (!parts.empty()) set.toml += "\n" + cad_table(source);
  return set;
}

}  // namespace pamr::geometry
