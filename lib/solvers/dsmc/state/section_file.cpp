// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/section_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/io/partial_file.hpp"
#include "solvers/dsmc/state/header_values.hpp"

namespace pamr::dsmc {

namespace {

constexpr std::uint64_t magic = 0x434d5344524d4150U;  // "PAMRDSMC"
constexpr std::uint64_t last_format = 2;
constexpr std::size_t n_fixed = 4;  ///< words before the text
constexpr std::uint64_t longest_text = std::uint64_t{1} << 30U;

class Descriptor {
 public:
  Descriptor(const std::string& path, int flags) : number_(::open(path.c_str(), flags | O_CLOEXEC)) {
    if (number_ < 0) throw Error(fmt::format("file '{}': cannot be opened: {}", path, std::strerror(errno)));
  }
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

void put(int descriptor, const std::string& file, std::uint64_t offset, const void* data, std::size_t bytes) {
  const auto* from = static_cast<const char*>(data);
  while (bytes > 0) {
    const auto n = ::pwrite(descriptor, from, bytes, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw Error(fmt::format("file '{}': cannot be written: {}", file, std::strerror(errno)));
    from += n;
    offset += static_cast<std::uint64_t>(n);
    bytes -= static_cast<std::size_t>(n);
  }
}

void get(int descriptor, const std::string& file, std::uint64_t offset, void* data, std::size_t bytes) {
  auto* to = static_cast<char*>(data);
  while (bytes > 0) {
    const auto n = ::pread(descriptor, to, bytes, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw Error(fmt::format("file '{}': expected {} more bytes at {}, found none", file, bytes, offset));
    to += n;
    offset += static_cast<std::uint64_t>(n);
    bytes -= static_cast<std::size_t>(n);
  }
}

/// Hash of a table: a sum over its words, each mixed with its place. Collective.
std::uint64_t checksum(const par::Comm& comm, const Section& section) {
  const auto range = par::block_range(section.rows, comm.rank(), comm.size());
  const auto first = static_cast<std::uint64_t>(range.begin) * section.width;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < section.block.size(); ++i) sum += combine(first + i, section.block[i]);
  return static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(sum)));
}

std::uint64_t hash_of(const std::string& text) {
  std::uint64_t h = 0;
  for (const char c : text) h = combine(h, static_cast<unsigned char>(c));
  return h;
}

std::uint64_t bytes_of(const Section& section) { return 8 * static_cast<std::uint64_t>(section.rows) * section.width; }

/// Bytes of the tables that a header lists, one behind the other, none larger than the file. Throws `Error`.
std::uint64_t bytes_of_tables(const std::string& file, const std::string& text, std::uint64_t bytes_of_file) {
  try {
    const auto header = nlohmann::json::parse(text);
    std::uint64_t data = 0;
    for (const auto& section : array_of(member(header, "sections"), "sections")) {
      (void)string_of(member(section, "name"), "name");
      (void)word_of(member(section, "checksum"), "checksum");
      const auto most = static_cast<std::int64_t>(bytes_of_file / 8);
      const auto rows = count_of(member(section, "rows"), "rows", most),
                 width = count_of(member(section, "width"), "width", most);
      if (count_of(member(section, "offset"), "offset") != static_cast<std::int64_t>(data) ||
          (width > 0 && rows > most / width))
        throw Error("checkpoint: expected tables one behind the other, found others");
      data += 8 * static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(width);
      if (data > bytes_of_file) break;
    }
    return data;
  } catch (const nlohmann::json::exception& wrong) {
    throw Error(fmt::format("file '{}': expected a header in JSON, found: {}", file, wrong.what()));
  } catch (const Error& error) {
    throw Error(fmt::format("file '{}': {}", file, error.what()));
  }
}

/// The header of a file of the length that it states. Throws `Error`.
std::string text_of_header(const std::string& file) {
  const Descriptor in(file, O_RDONLY);
  const auto end = ::lseek(in.number(), 0, SEEK_END);
  std::array<std::uint64_t, n_fixed> fixed{};
  const auto bytes = static_cast<std::uint64_t>(end < 0 ? 0 : end);
  if (bytes >= sizeof(fixed)) get(in.number(), file, 0, fixed.data(), sizeof(fixed));
  if (fixed[0] != magic || fixed[1] < 1 || fixed[1] > last_format)
    throw Error(fmt::format("file '{}': expected a checkpoint of pamr-dsmc (format 1 or {}), found another file", file,
                            last_format));
  if (fixed[2] > longest_text || fixed[2] > bytes - sizeof(fixed))
    throw Error(fmt::format("file '{}': expected a header of {} bytes, found a file of {}", file, fixed[2], bytes));
  std::string text(fixed[2], ' ');
  get(in.number(), file, sizeof(fixed), text.data(), text.size());
  if (hash_of(text) != fixed[3])
    throw Error(fmt::format("file '{}': expected a header with hash {:x}, found a damaged one", file, fixed[3]));
  const auto data = bytes_of_tables(file, text, bytes);
  const auto whole = sizeof(fixed) + text.size() + data;
  if (data > bytes || whole != bytes)
    throw Error(
        fmt::format("file '{}': expected {} bytes, found {}: the file is cut off or damaged", file, whole, bytes));
  return text;
}

}  // namespace

nlohmann::json header_of_sections(const std::string& file) { return nlohmann::json::parse(text_of_header(file)); }

void write_sections(const par::Comm& comm, const std::string& file, const nlohmann::json& header,
                    const std::vector<const Section*>& sections, std::uint64_t format) {
  auto text_of = header;
  text_of["sections"] = nlohmann::json::array();
  std::uint64_t at = 0;  // behind the text
  for (const auto* section : sections) {
    text_of["sections"].push_back({{"name", section->name},
                                   {"rows", section->rows},
                                   {"width", section->width},
                                   {"offset", at},
                                   {"checksum", checksum(comm, *section)}});
    at += bytes_of(*section);
  }
  auto text = text_of.dump();
  text.resize((text.size() + 7) / 8 * 8, ' ');
  const std::array<std::uint64_t, n_fixed> fixed{magic, format, text.size(), hash_of(text)};
  const auto data = sizeof(fixed) + text.size();

  io::PartialFile partial(file);
  par::agree(comm, [&] {
    if (!comm.is_first()) return;
    if (!partial.make(data + at)) partial.occupy(0, data + at);
  });
  partial.share(comm);
  par::agree(comm, [&] {
    const Descriptor out(partial.path().string(), O_WRONLY | O_NOFOLLOW);
    if (comm.is_first()) {
      put(out.number(), file, 0, fixed.data(), sizeof(fixed));
      put(out.number(), file, sizeof(fixed), text.data(), text.size());
    }
    std::uint64_t offset = data;
    for (const auto* section : sections) {
      const auto range = par::block_range(section->rows, comm.rank(), comm.size());
      put(out.number(), file, offset + 8 * static_cast<std::uint64_t>(range.begin) * section->width,
          section->block.data(), 8 * section->block.size());
      offset += bytes_of(*section);
    }
    if (::fsync(out.number()) != 0)
      throw Error(fmt::format("file '{}': cannot be written: {}", file, std::strerror(errno)));
  });
  par::agree(comm, [&] {
    if (comm.is_first()) partial.commit();
  });
}

SectionFile::SectionFile(const par::Comm& comm, std::string file) : comm_(&comm), file_(std::move(file)), header_() {
  std::string text;
  par::agree(comm, [&] {
    if (comm.is_first()) text = text_of_header(file_);
  });
  header_ = std::make_unique<nlohmann::json>(nlohmann::json::parse(comm.broadcast(text)));
}

SectionFile::~SectionFile() = default;

const nlohmann::json* SectionFile::entry_of(const std::string& name) const {
  const nlohmann::json* found = nullptr;
  for (const auto& entry : header()["sections"])  // verified when the file was opened
    if (entry["name"] == name) found = &entry;
  return found;
}

std::int64_t SectionFile::n_rows(const std::string& name) const {
  const auto* entry = entry_of(name);
  return entry == nullptr ? 0 : entry->at("rows").get<std::int64_t>();
}

Section SectionFile::read(const std::string& name, std::size_t width) const {
  const auto* entry = entry_of(name);
  if (entry == nullptr || entry->at("width") != width)
    throw Error(fmt::format("file '{}': expected a table {} with {} words a row, found none", file_, name, width));
  Section section{name, entry->at("rows"), width, {}};
  const std::uint64_t offset = entry->at("offset"), expected = entry->at("checksum");
  const auto range = par::block_range(section.rows, comm_->rank(), comm_->size());
  par::agree(*comm_, [&] {
    const Descriptor in(file_, O_RDONLY);
    std::array<std::uint64_t, n_fixed> fixed{};
    get(in.number(), file_, 0, fixed.data(), sizeof(fixed));
    section.block.resize(static_cast<std::size_t>(range.count()) * width);
    get(in.number(), file_, sizeof(fixed) + fixed[2] + offset + 8 * static_cast<std::uint64_t>(range.begin) * width,
        section.block.data(), 8 * section.block.size());
  });
  if (checksum(*comm_, section) != expected)
    throw Error(fmt::format("file '{}', {}: expected checksum {:x}, found damaged data", file_, name, expected));
  return section;
}

}  // namespace pamr::dsmc
