// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/preflight.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>

#include "pamr/base/error.hpp"
#include "pamr/base/subprocess.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/io/native/inspect.hpp"

namespace pamr::io {

namespace {

/// Answers start with one of these.
constexpr char good = 'G', bad = 'B';

/// The catalog or the reason why there is none: one of these letters, then what it stands for.
std::string answer_for(const std::filesystem::path& file) {
  try {
    return good + pack(inspect(file));
  } catch (const Error& error) {
    return bad + std::string(error.what());
  }
}

/// The same where memory is limited to what the file's size justifies.
std::string answer_within_limits(const std::filesystem::path& file) {
  try {
    return answer_for(file);
  } catch (const std::bad_alloc&) {
    return bad + fmt::format(
                     "file '{}': expected contents in keeping with its size, found a claim of more, or no memory "
                     "to look at them",
                     file.string());
  }
}

std::uintmax_t size_of_regular_file(const std::filesystem::path& file) {
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status))
    throw Error(fmt::format("file '{}': expected a file, found none", file.string()));
  if (!std::filesystem::is_regular_file(status))
    throw Error(fmt::format("file '{}': expected a file, found {}", file.string(),
                            std::filesystem::is_directory(status) ? "a folder" : "something else"));
  if (access(file.c_str(), R_OK) != 0)
    throw Error(
        fmt::format("file '{}': expected a file that may be read, found: {}", file.string(), std::strerror(errno)));
  return std::filesystem::file_size(file);
}

/// The first bytes of an HDF5 file; HDF5 also allows them at offsets 512, 1024, 2048 ...
void require_signature(const std::filesystem::path& file, std::uintmax_t bytes) {
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw Error(
        fmt::format("file '{}': expected a file that can be opened, found: {}", file.string(), std::strerror(errno)));
  for (std::uintmax_t offset = 0; offset + 8 <= bytes; offset = offset == 0 ? 512 : 2 * offset) {
    std::array<char, 8> found{};
    stream.seekg(static_cast<std::streamoff>(offset));
    if (stream.read(found.data(), found.size()) && found == signature) return;
  }
  const std::string gmsh = "$MeshFormat";
  std::string begin(gmsh.size(), '\0');
  stream.clear();
  stream.seekg(0);
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  const auto* format = begin == gmsh ? find_format("mesh.msh") : find_format(file);
  if (format != nullptr && format->read != nullptr && !format->is_native)
    throw Error(fmt::format("file '{0}': expected an HDF5 file, found one of {1}: pamr-convert {0} {2}", file.string(),
                            format->name, std::filesystem::path(file).replace_extension(".hdf").string()));
  throw Error(fmt::format("file '{}': expected an HDF5 file, found no HDF5 signature", file.string()));
}

/// The answer from a process of its own.
std::string answer_of_process(const std::filesystem::path& file, std::uintmax_t bytes) {
  Subprocess process([&](const Subprocess::Send& send) { send(answer_within_limits(file)); },
                     {.processor_seconds = 2, .memory_bytes = Subprocess::memory_for(bytes)});
  auto answer = process.receive_all();
  const auto trouble = process.end();
  if (!trouble.empty() || answer.empty())
    throw Error(fmt::format("file '{}': expected a sound HDF5 file, found a damaged one: HDF5 failed on it ({})",
                            file.string(), trouble.empty() ? "no answer" : trouble));
  return answer;
}

std::string packed_catalog(const std::filesystem::path& file) {
  const auto bytes = size_of_regular_file(file);
  require_signature(file, bytes);
  const auto answer = may_fork() ? answer_of_process(file, bytes) : answer_for(file);
  if (answer.front() == bad) throw Error(answer.substr(1));
  return answer.substr(1);
}

}  // namespace

Catalog catalog_of(const par::Comm& comm, const std::filesystem::path& file) {
  std::string packed;
  Catalog catalog;
  par::agree(comm, [&] {
    if (!comm.is_first()) return;
    packed = packed_catalog(file);
    catalog = unpack(packed);
  });
  packed = comm.broadcast(std::move(packed));
  if (!comm.is_first()) catalog = unpack(packed);
  return catalog;
}

}  // namespace pamr::io
