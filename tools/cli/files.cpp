// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/files.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "pamr/base/error.hpp"

namespace pamr::cli {

namespace fs = std::filesystem;

namespace {

/// Absolute; where the file system does not tell, as it is spelled.
fs::path without_links(const fs::path& path) {
  std::error_code failed;
  auto absolute = fs::absolute(path, failed);
  if (failed) return path.lexically_normal();
  auto real = fs::weakly_canonical(absolute, failed);
  return failed ? absolute.lexically_normal() : real;
}

fs::path entry_of(fs::path path) {
  while (!path.has_filename() && path.has_relative_path()) path = path.parent_path();  // "folder/"
  const auto name = path.filename();
  if (name.empty() || name == "." || name == "..") return without_links(path);
  return without_links(path.has_parent_path() ? path.parent_path() : fs::path(".")) / name;
}

bool is_within(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// The number of a file of the series; nothing for other names.
std::optional<std::uint64_t> number_in(const SeriesName& series, const std::string& file_name) {
  const auto end = file_name.rfind('.') == std::string::npos ? file_name.size() : file_name.rfind('.');
  auto begin = end;
  while (begin > 0 && file_name[begin - 1] >= '0' && file_name[begin - 1] <= '9') --begin;
  std::uint64_t number = 0;
  const auto* const last = file_name.data() + end;
  const auto [stop, error] = std::from_chars(file_name.data() + begin, last, number);
  if (error != std::errc{} || stop != last || fs::path(series(number)).filename() != file_name) return {};
  return number;
}

}  // namespace

bool is_same_file(const std::string& a, const std::string& b) {
  return Files::are_same(Files::place_of(Files::Kind::input, a), Files::place_of(Files::Kind::input, b));
}

bool is_file_of(const SeriesName& series, const std::string& file_name) {
  return number_in(series, file_name).has_value();
}

std::vector<std::string> existing_files(const SeriesName& series, std::uint64_t first) {
  std::map<std::uint64_t, std::string> found;
  const auto folder = fs::path(series(first)).parent_path();
  std::error_code failed;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, failed), end; !failed && entry != end;
       entry.increment(failed))
    if (const auto number = number_in(series, entry->path().filename().string()); number && *number >= first)
      found[*number] = series(*number);
  std::vector<std::string> files;
  for (auto& [number, file] : found) files.push_back(std::move(file));
  return files;
}

Files::Place Files::place_of(Kind kind, const std::string& path) {
  return {kind, path, entry_of(path), without_links(path)};
}

bool Files::are_same(const Place& a, const Place& b) {
  std::error_code failed;
  return a.entry == b.entry || a.real == b.real || fs::equivalent(a.path, b.path, failed);
}

/// The file of the series that is also the other place, or a file of the other series, under any name; empty for none.
std::string Files::member_of(const Place& series, const Place& other) {
  const auto folder = series.entry.parent_path();
  if (other.kind == Kind::series) {
    if (folder != other.entry.parent_path()) return {};
    for (std::uint64_t number = 1; number < 1'000'000'000'000'000'000; number *= 10)
      if (const fs::path name = series.series(number); name.filename() == fs::path(other.series(number)).filename())
        return name.string();
    return {};
  }
  for (const auto& path : {other.entry, other.real})
    if (path.parent_path() == folder)
      if (const auto number = number_in(series.series, path.filename().string())) return series.series(*number);
  std::error_code failed;
  for (const auto& file : existing_files(series.series, 0))
    if (fs::equivalent(file, other.path, failed)) return file;
  return {};
}

/// Throws if the output would replace the other one.
void Files::require_apart(const Place& output, const Place& other) {
  const std::string what = other.kind == Kind::input ? "input " : "output ";
  if (output.kind == Kind::folder || other.kind == Kind::folder) return require_outside(output, other, what);
  auto name = output.path;
  if (output.kind == Kind::series)
    name = member_of(output, other);
  else if (other.kind == Kind::series)
    name = member_of(other, output);
  else if (!are_same(output, other))
    return;
  if (name.empty()) return;
  throw Error(name + ": expected an output of its own, found the same file as the " + what +
              (other.kind == Kind::series ? name : other.path));
}

/// The same where one of the two is a folder.
void Files::require_outside(const Place& output, const Place& other, const std::string& what) {
  const auto lies_in = [](const Place& place, const Place& folder) {
    return is_within(place.entry, folder.entry) || is_within(place.entry, folder.real) ||
           is_within(place.real, folder.real);
  };
  const bool replaces_other = output.kind == Kind::folder && lies_in(other, output);
  const bool is_replaced = other.kind == Kind::folder && lies_in(output, other);
  const bool is_in_the_way =
      other.kind != Kind::series && output.kind != Kind::series && (lies_in(other, output) || lies_in(output, other));
  if (replaces_other || is_replaced || is_in_the_way)
    throw Error(output.path + ": expected an output apart from inputs and other outputs, found the " + what +
                other.path + (replaces_other ? " in this folder, which would be replaced" : " around it or in it"));
}

void Files::add(Place place) {
  const auto may_replace = [](const Place& output, const Place& input) {
    return input.kind == Kind::input && !output.may_replace.empty() && is_same_file(output.may_replace, input.path);
  };
  for (const auto& other : places_) {
    if (place.kind == Kind::input && other.kind == Kind::input) continue;
    const bool is_first = other.kind != Kind::input && place.kind == Kind::input;  // the output is the one to name
    const auto& [output, second] = is_first ? std::pair(other, place) : std::pair(place, other);
    if (!may_replace(output, second)) require_apart(output, second);
  }
  places_.push_back(std::move(place));
}

void Files::add_input(const std::string& path) {
  add(place_of(Kind::input, path));
  inputs_.push_back(path);
}

void Files::add_output(const std::string& path, const std::string& may_replace) {
  auto place = place_of(Kind::output, path);
  place.may_replace = may_replace;
  add(std::move(place));
}

void Files::add_folder(const std::string& path) { add(place_of(Kind::folder, path)); }

void Files::add_series(const SeriesName& series, const std::string& may_replace) {
  auto place = place_of(Kind::series, series(0));
  place.series = series;
  place.may_replace = may_replace;
  add(std::move(place));
}

}  // namespace pamr::cli
