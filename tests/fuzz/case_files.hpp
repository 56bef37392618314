// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

namespace pamr::fuzz {

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A case of the project, which stands for itself in a folder of its own.
inline std::string case_of_project(const std::string& name) {
  auto text = text_of(std::filesystem::path(PAMR_CASES) / name);
  if (text.empty()) throw std::runtime_error("no case " + name);
  const std::string up = "\"../species.toml\"", here = "\"species.toml\"";
  if (const auto found = text.find(up); found != std::string::npos) text.replace(found, up.size(), here);
  return text;
}

}  // namespace pamr::fuzz
