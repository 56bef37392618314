// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pamr/par/comm.hpp"

/// A flat file of tables that any number of ranks writes and reads (docs/tools/pamr-dsmc.md). All words have 64 bits,
/// little endian: "PAMRDSMC", format (1, or 2 of a gas that vibrates, whose
/// tables have more columns), length of a JSON header in bytes, hash of the header, the header padded to whole words,
/// and the tables, row by row, at the offsets given in the header.
namespace pamr::dsmc {

/// A table of words. `block`: this rank's rows in the canonical distribution (`par::block_range`) of `rows`.
struct Section {
  std::string name;
  std::int64_t rows = 0;
  std::size_t width = 1;  ///< words a row
  std::vector<std::uint64_t> block;
};

/// Writes `header` with the tables: the file appears complete or not at all, and its bytes do not depend on the number
/// of ranks if the blocks' contents do not. Collective; throws the same `Error` on every rank when it cannot be
/// written.
void write_sections(const par::Comm& comm, const std::string& file, const nlohmann::json& header,
                    const std::vector<const Section*>& sections, std::uint64_t format = 1);

/// The header of a file of tables. Throws `Error` for one that is damaged, cut off or of another kind. Local.
nlohmann::json header_of_sections(const std::string& file);

/// Opened for reading: header and lengths have been verified.
class SectionFile {
 public:
  /// Collective; throws the same `Error` on every rank for a file that is damaged, cut off or of another kind.
  SectionFile(const par::Comm& comm, std::string file);
  ~SectionFile();
  SectionFile(const SectionFile&) = delete;
  SectionFile& operator=(const SectionFile&) = delete;
  SectionFile(SectionFile&&) = delete;
  SectionFile& operator=(SectionFile&&) = delete;

  const nlohmann::json& header() const { return *header_; }
  /// Rows of a table; 0 where there is none of this name. Local.
  std::int64_t n_rows(const std::string& name) const;
  /// Reads a table of this width; its words are compared with their checksum. Collective; throws `Error`.
  Section read(const std::string& name, std::size_t width) const;

 private:
  const nlohmann::json* entry_of(const std::string& name) const;

  const par::Comm* comm_;
  std::string file_;
  std::unique_ptr<nlohmann::json> header_;
};

}  // namespace pamr::dsmc
