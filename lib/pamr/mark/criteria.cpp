// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/criteria.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>

#include "pamr/base/error.hpp"

namespace pamr::mark {

namespace {

template <class Number>
bool read_number(std::string_view text, Number& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

double number_of(const Given& given) {
  double value = 0;
  if (!read_number(given.text, value) || !std::isfinite(value))
    throw Error(fmt::format("{}: expected a number, found \"{}\"", given.option, given.text));
  return value;
}

int count_of(const Given& given, int least) {
  int value = 0;
  if (!read_number(given.text, value) || value < least)
    throw Error(fmt::format("{}: expected an integer of at least {}, found \"{}\"", given.option, least, given.text));
  return value;
}

std::vector<double> numbers_of(const Given& given, std::size_t n, const char* names) {
  std::vector<double> values;
  std::string_view rest = given.text;
  for (bool more = true; more;) {
    const auto comma = rest.find(',');
    more = comma != std::string_view::npos;
    double value = 0;
    if (!read_number(rest.substr(0, comma), value) || !std::isfinite(value)) break;
    values.push_back(value);
    if (more) rest.remove_prefix(comma + 1);
    if (!more && values.size() == n) return values;
  }
  throw Error(fmt::format("{}: expected {} numbers {}, found \"{}\"", given.option, n, names, given.text));
}

Sphere sphere_of(const Given& given, const std::vector<double>& v) {
  if (v[3] < 0) throw Error(fmt::format("{}: expected a radius of at least 0, found {}", given.option, v[3]));
  return {{v[0], v[1], v[2]}, v[3]};
}

/// `FIELD:above:V` or `FIELD:below:V`; the field's name may hold colons.
Threshold threshold_of(const Given& given) {
  const auto second = given.text.rfind(':');
  const auto first = second == std::string::npos || second == 0 ? std::string::npos : given.text.rfind(':', second - 1);
  if (first != std::string::npos && first > 0) {
    const auto side = given.text.substr(first + 1, second - first - 1);
    if (side == "above" || side == "below")
      return {given.text.substr(0, first), side == "above" ? Side::above : Side::below,
              number_of({given.option, given.text.substr(second + 1)})};
  }
  throw Error(fmt::format("{}: expected FIELD:above:V or FIELD:below:V, found \"{}\"", given.option, given.text));
}

/// `FIELD` or `FIELD:TIMES`; the field's name may hold colons when a number follows.
Certainty certainty_of(const Given& given) {
  Certainty certainty;
  const auto colon = given.text.rfind(':');
  certainty.field = given.text.substr(0, colon);
  if (colon != std::string::npos) certainty.times = number_of({given.option, given.text.substr(colon + 1)});
  if (certainty.field.empty() || certainty.times < 0)
    throw Error(
        fmt::format("--error: expected FIELD or FIELD:TIMES with TIMES of at least 0, found \"{}\"", given.text));
  return certainty;
}

/// `FIELD` or `FIELD:FRACTION`; the field's name may hold colons when a fraction follows.
BulkOf bulk_of(const Given& given) {
  constexpr double usual_fraction = 0.3;
  const auto colon = given.text.rfind(':');
  if (colon == std::string::npos && !given.text.empty()) return {given.text, usual_fraction};
  if (colon == std::string::npos || colon == 0)
    throw Error(fmt::format("{}: expected FIELD or FIELD:FRACTION, found \"{}\"", given.option, given.text));
  const BulkOf rule{given.text.substr(0, colon), number_of({given.option, given.text.substr(colon + 1)})};
  if (!(rule.fraction > 0 && rule.fraction <= 1))
    throw Error(
        fmt::format("{}: expected a fraction above 0 and of at most 1, found {:g}", given.option, rule.fraction));
  return rule;
}

/// The first option that a second one belongs to; nothing for other options.
const char* first_of(std::string_view second) {
  if (second == "--layers") return "--patch";
  if (second == "--above" || second == "--below") return "--field";
  if (second == "--ratio") return "--size-over";
  if (second == "--error") return "--only-where";
  if (second == "--theta" || second == "--target" || second == "--bulk") return "--recovered-error";
  return nullptr;
}

/// Gives `second` to the nearest option before it that `fits` and has none yet, else to the first after it. `what`: for
/// the message that there is none.
template <class Fits>
void pair_one(const std::vector<Given>& given, std::size_t i, const char* what, const Fits& fits,
              std::vector<const Given*>& second) {
  std::optional<std::size_t> found;
  const auto try_it = [&](std::size_t j) {
    if (!found && fits(given[j].option) && second[j] == nullptr) found = j;
  };
  for (std::size_t j = i; j-- > 0;) try_it(j);
  for (std::size_t j = i + 1; j < given.size(); ++j) try_it(j);
  if (!found)
    throw Error(fmt::format("{} {}: expected a {} that it belongs to, found none without its own", given[i].option,
                            given[i].text, what));
  second[*found] = &given[i];
}

/// For each option, the second one that belongs to it, or null.
std::vector<const Given*> pair_up(const std::vector<Given>& given) {
  std::vector<const Given*> second(given.size(), nullptr);
  for (std::size_t i = 0; i < given.size(); ++i)
    if (const char* first = first_of(given[i].option); first != nullptr)
      pair_one(
          given, i, first, [first](const std::string& option) { return option == first; }, second);
  return second;
}

/// For each criterion with a value, the `--coarsen-below` that belongs to it, or null.
std::vector<const Given*> pair_coarsening(const std::vector<Given>& given) {
  std::vector<const Given*> coarsening(given.size(), nullptr);
  const auto has_value = [](const std::string& option) {
    return option == "--field" || option == "--size-over" || option == "--recovered-error" || option == "--bulk-of";
  };
  for (std::size_t i = 0; i < given.size(); ++i)
    if (given[i].option == "--coarsen-below")
      pair_one(given, i, "criterion with a value (--field, --size-over, --recovered-error, --bulk-of)", has_value,
               coarsening);
  return coarsening;
}

/// The same criterion with another value.
struct WithValue {
  double value;
  template <class Rule>
  void operator()(Rule&) const {}
  void operator()(Threshold& rule) const { rule.value = value; }
  void operator()(SizeOver& rule) const { rule.ratio = value; }
  void operator()(ErrorOver& rule) const { rule.value = value; }
  void operator()(BulkOf& rule) const { rule.fraction = value; }
};

struct ValueOf {
  template <class Rule>
  double operator()(const Rule&) const {
    return 0;
  }
  double operator()(const Threshold& rule) const { return rule.value; }
  double operator()(const SizeOver& rule) const { return rule.ratio; }
  double operator()(const ErrorOver& rule) const { return rule.value; }
  double operator()(const BulkOf& rule) const { return rule.fraction; }
};

/// A value that marks fewer cells, see `scaled`.
struct Stricter {
  double value, factor;
  template <class Rule>
  double operator()(const Rule&) const {
    return value;
  }
  double operator()(const Threshold& rule) const {
    const double by = (factor - 1) * (value == 0 ? 1 : std::fabs(value));
    return rule.side == Side::above ? value + by : value - by;
  }
  double operator()(const SizeOver&) const { return factor * value; }
  double operator()(const ErrorOver& rule) const {
    if (rule.bar == ErrorOver::Bar::bulk) return std::min(1.0, value / factor);
    return value * (rule.bar == ErrorOver::Bar::target ? std::sqrt(factor) : factor);
  }
  double operator()(const BulkOf&) const { return std::min(1.0, value / factor); }
};

/// Whether a larger value marks more cells.
struct MarksMoreAbove {
  template <class Rule>
  bool operator()(const Rule&) const {
    return false;
  }
  bool operator()(const Threshold& rule) const { return rule.side == Side::below; }
  bool operator()(const ErrorOver& rule) const { return rule.bar == ErrorOver::Bar::bulk; }
  bool operator()(const BulkOf&) const { return true; }
};

/// Cells between the two values stay: the second one marks at least the cells that the first one marks.
void set_coarsening(const Given& given, Criterion& criterion) {
  const double mark = std::visit(ValueOf(), criterion.rule), coarsen = number_of(given);
  const bool is_more = std::visit(MarksMoreAbove(), criterion.rule);
  const bool is_fraction =
      std::holds_alternative<BulkOf>(criterion.rule) || (std::holds_alternative<ErrorOver>(criterion.rule) && is_more);
  if (is_more ? coarsen < mark : coarsen > mark)
    throw Error(fmt::format("{} {}: expected at {} the {:g} from which on cells are marked (\"{}\")", given.option,
                            given.text, is_more ? "least" : "most", mark, criterion.text));
  if (is_fraction && coarsen > 1)
    throw Error(fmt::format("{}: expected a fraction of at most 1, found {:g}", given.option, coarsen));
  if (!std::holds_alternative<Threshold>(criterion.rule) && !(coarsen > 0))
    throw Error(fmt::format("{}: expected a positive number, found \"{}\"", given.option, given.text));
  criterion.coarsen_below = coarsen;
  criterion.text += fmt::format(" {} {}", given.option, given.text);
}

ErrorOver recovered_error_of(const Given& given, const Given& second) {
  using Bar = ErrorOver::Bar;
  ErrorOver rule{given.text, Bar::theta, number_of(second)};
  if (second.option == "--target") rule.bar = Bar::target;
  if (second.option == "--bulk") rule.bar = Bar::bulk;
  if (!(rule.value > 0) || (rule.bar == Bar::bulk && rule.value > 1))
    throw Error(fmt::format("{}: expected a positive number{}, found \"{}\"", second.option,
                            rule.bar == Bar::bulk ? " of at most 1" : "", second.text));
  return rule;
}

/// The criterion that an option states, with the option that belongs to it or null; nothing for other options.
std::optional<Criterion> criterion_of(const Given& given, const Given* second) {
  std::string text = given.text.empty() ? given.option : given.option + " " + given.text;
  if (second != nullptr) text += " " + second->option + " " + second->text;
  if (given.option == "--all") return Criterion{text, AllCells{}};
  if (given.option == "--crossing-sphere")
    return Criterion{text, CrossingSphere{sphere_of(given, numbers_of(given, 4, "X,Y,Z,R"))}};
  if (given.option == "--centroid-shell") {
    const auto v = numbers_of(given, 5, "X,Y,Z,R,W");
    if (v[4] < 0) throw Error(fmt::format("{}: expected a width of at least 0, found {}", given.option, v[4]));
    return Criterion{text, CentroidShell{sphere_of(given, v), v[4]}};
  }
  if (given.option == "--box") {
    const auto v = numbers_of(given, 6, "X0,Y0,Z0,X1,Y1,Z1");
    if (v[0] > v[3] || v[1] > v[4] || v[2] > v[5])
      throw Error(fmt::format("--box: expected X0 <= X1, Y0 <= Y1 and Z0 <= Z1, found \"{}\"", given.text));
    return Criterion{text, Box{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}};
  }
  if (given.option == "--bulk-of") return Criterion{text, bulk_of(given)};
  if (given.option == "--patch")
    return Criterion{text, NearPatch{given.text, second != nullptr ? count_of(*second, 1) : 1}};
  if (given.option == "--field") {
    if (second == nullptr)
      throw Error(fmt::format("--field {}: expected --above V or --below V with it, found none", given.text));
    const auto side = second->option == "--above" ? Side::above : Side::below;
    return Criterion{text, Threshold{given.text, side, number_of(*second)}};
  }
  if (given.option == "--size-over") {
    if (second == nullptr)
      throw Error(fmt::format("--size-over {}: expected --ratio A with it, found none", given.text));
    const double ratio = number_of(*second);
    if (!(ratio > 0)) throw Error(fmt::format("--ratio: expected a positive number, found \"{}\"", second->text));
    return Criterion{text, SizeOver{given.text, ratio}};
  }
  if (given.option == "--recovered-error") {
    if (second == nullptr)
      throw Error(fmt::format(
          "--recovered-error {}: expected --theta T, --target EPS or --bulk FRACTION with it, found none", given.text));
    return Criterion{text, recovered_error_of(given, *second)};
  }
  return std::nullopt;
}

/// Refuses options of the whole request that are given twice, and those that change nothing without others.
void require_used(const std::vector<Given>& given, const Request& request) {
  const auto count = [&](std::string_view option) {
    return std::count_if(given.begin(), given.end(), [&](const Given& one) { return one.option == option; });
  };
  const auto require = [&](const char* option, bool holds, const char* partner) {
    const auto n = count(option);
    if (n > 1) throw Error(fmt::format("{}: expected it once, found it {} times", option, n));
    if (n == 1 && !holds) throw Error(fmt::format("{}: expected {} beside it, found none", option, partner));
  };
  constexpr auto coarsening = "--coarsen-below or --coarsen-rest";
  require("--max-level", true, "");
  require("--min-level", request.coarsens(), coarsening);
  require("--keep-for", request.coarsens(), coarsening);
  require("--size", count("--size-over") > 0, "--size-over");
}

}  // namespace

bool Request::coarsens() const {
  return coarsen_rest ||
         std::any_of(criteria.begin(), criteria.end(), [](const auto& c) { return c.coarsen_below.has_value(); });
}

std::vector<Given> split_options(const std::string& text) {
  constexpr std::array<std::string_view, 2> flags{"--all", "--coarsen-rest"};
  constexpr std::array<std::string_view, 22> options{
      "--crossing-sphere", "--centroid-shell", "--box",     "--patch",
      "--layers",          "--field",          "--above",   "--below",
      "--size-over",       "--ratio",          "--theta",   "--recovered-error",
      "--target",          "--bulk",           "--bulk-of", "--min-level",
      "--coarsen-below",   "--keep-for",       "--size",    "--max-level",
      "--only-where",      "--error"};
  const auto is_one_of = [](const auto& names, const std::string& word) {
    return std::find(names.begin(), names.end(), word) != names.end();
  };
  std::vector<Given> given;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    Given one{word, {}};
    if (!is_one_of(flags, word) && !is_one_of(options, word))
      throw Error(fmt::format("expected an option for criteria or limits, found \"{}\"", word));
    if (is_one_of(options, word) && !(words >> one.text))
      throw Error(fmt::format("{}: expected an argument, found none", word));
    given.push_back(std::move(one));
  }
  return given;
}

Criterion with_value(Criterion criterion, double value) {
  std::visit(WithValue{value}, criterion.rule);
  return criterion;
}

Request scaled(Request request, double factor) {
  for (auto& criterion : request.criteria) {
    const auto stricter = [&](double value) { return std::visit(Stricter{value, factor}, criterion.rule); };
    if (criterion.coarsen_below) criterion.coarsen_below = stricter(*criterion.coarsen_below);
    criterion = with_value(criterion, stricter(std::visit(ValueOf(), criterion.rule)));
  }
  return request;
}

Request read_request(const std::vector<Given>& given) {
  Request request;
  const auto seconds = pair_up(given), coarsening = pair_coarsening(given);
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (auto criterion = criterion_of(given[i], seconds[i])) {
      if (coarsening[i] != nullptr) set_coarsening(*coarsening[i], *criterion);
      request.criteria.push_back(std::move(*criterion));
    } else if (given[i].option == "--coarsen-rest") {
      request.coarsen_rest = true;
    } else if (given[i].option == "--min-level") {
      request.min_level = count_of(given[i], 0);
    } else if (given[i].option == "--keep-for") {
      request.keep_for = count_of(given[i], 0);
      if (request.keep_for > max_keep_for)
        throw Error(fmt::format("--keep-for: expected at most {}, found {}", max_keep_for, given[i].text));
    } else if (given[i].option == "--size") {
      if (given[i].text != "cbrt" && given[i].text != "longest-edge")
        throw Error(fmt::format("--size: expected cbrt or longest-edge, found \"{}\"", given[i].text));
      request.size = given[i].text == "cbrt" ? CellSize::cbrt_volume : CellSize::longest_edge;
    } else if (given[i].option == "--max-level") {
      request.max_level = count_of(given[i], 0);
    } else if (given[i].option == "--only-where") {
      request.only_where.push_back(
          {threshold_of(given[i]), seconds[i] != nullptr ? certainty_of(*seconds[i]) : Certainty{}});
    }
  }
  if (request.criteria.empty())
    throw Error(
        "expected at least one criterion (--all, --crossing-sphere, --centroid-shell, --box, --patch, --field, "
        "--size-over, --recovered-error, --bulk-of), found none");
  require_used(given, request);
  return request;
}

}  // namespace pamr::mark
