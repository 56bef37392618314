// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/pb_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "pamr/base/case_file.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/name_pattern.hpp"
#include "solvers/poisson_boltzmann/problem/case_names.hpp"
#include "solvers/poisson_boltzmann/problem/petsc_options.hpp"
#include "solvers/poisson_boltzmann/problem/read_goals.hpp"

namespace pamr::poisson_boltzmann {

namespace {

constexpr auto positive = NumberRange::above(0);

constexpr std::array<std::pair<Condition, const char*>, 7> condition_names{{{Condition::potential, "potential"},
                                                                            {Condition::charge, "charge"},
                                                                            {Condition::regulated, "regulated"},
                                                                            {Condition::symmetry, "symmetry"},
                                                                            {Condition::plate_profile, "plate-profile"},
                                                                            {Condition::far_field, "far-field"},
                                                                            {Condition::manufactured, "manufactured"}}};

/// Sizes of potentials and charges that are not 0: squares of their squares, as in error bars, are numbers as well.
constexpr double min_size = 1e-50, max_size = 1e50;

bool takes_value(Condition condition) {
  return condition == Condition::potential || condition == Condition::charge || condition == Condition::regulated;
}

[[noreturn]] void refuse_both(const TomlTable& table, std::string_view key, std::string_view expected) {
  throw Error(fmt::format("{}: expected {}, found both", table.at(key), expected));
}

/// Whether the table has a key, without asking for it: messages that list the keys do not name it.
bool is_stated(const TomlTable& table, std::string_view key) { return table.at(key) != table.at(); }

/// Charges of cation and anion, "2:1".
void read_salt(const TomlTable& table, Electrolyte& e) {
  const auto& salt = e.salt;
  const auto colon = salt.find(':');
  const auto digits = [](const std::string& text) {
    return text.size() == 1 && text[0] >= '1' && text[0] <= '9' ? text[0] - '0' : 0;
  };
  const int first = colon == std::string::npos ? 0 : digits(salt.substr(0, colon));
  const int second = colon == std::string::npos ? 0 : digits(salt.substr(colon + 1));
  if (first == 0 || second == 0)
    table.refuse("salt", "the charges of cation and anion (\"1:1\", \"2:1\", ...), or tables [[electrolyte.ion]]");
  e.valence = first == second ? first : 1;
  if (first == second) return;
  const int common = std::gcd(first, second), n_cations = second / common, n_anions = first / common;
  e.ions = {{first, static_cast<double>(n_cations)}, {-second, static_cast<double>(n_anions)}};
}

/// `[[electrolyte.ion]]` with charge and concentration. The Debye length follows from them.
void read_ions(const TomlTable& table, Electrolyte& e) {
  double charge = 0, size = 0;
  for (const auto& row : table.list("ion")) {
    const auto z = static_cast<int>(row.integer("charge", -9, 9));
    if (z == 0) row.refuse("charge", "elementary charges of an ion, with sign", "0");
    e.ions.push_back({z, row.number("concentration", {1e-12, 1e6})});
    charge += z * e.ions.back().concentration;
    size += std::abs(z) * e.ions.back().concentration;
  }
  if (e.ions.empty()) return read_salt(table, e);
  for (const auto* key : {"salt", "concentration"})
    if (table.has(key)) refuse_both(table, key, fmt::format("either {} in [electrolyte] or [[electrolyte.ion]]", key));
  if (!(std::abs(charge) <= 1e-9 * size))
    table.refuse("ion", "ions whose charges add up to 0 (the sum of charge times concentration)",
                 fmt::format("{:g} mol/m^3", charge));
  e.salt = "mixed";
}

/// Takes the Debye length of a stated concentration; refuses another one.
void set_debye_length(const TomlTable& table, const char* key, double concentration, Electrolyte& e) {
  const double from_salt = debye_length(e, concentration);
  if (e.debye_length && std::abs(*e.debye_length - from_salt) > 1e-3 * from_salt)
    table.refuse(key, fmt::format("that of debye_length = {:g} m, or one of the two keys", *e.debye_length),
                 fmt::format("{}, whose Debye length is {:g} m",
                             e.salt == "mixed" ? "ions" : fmt::format("{:g} mol/m^3", concentration), from_salt));
  if (!e.debye_length) e.debye_length = from_salt;
}

Electrolyte read_electrolyte(const TomlTable& table) {
  Electrolyte e;
  e.salt = table.text_or("salt", e.salt);
  read_ions(table, e);
  e.temperature = table.number_or("temperature", e.temperature, {1, 10000});
  e.permittivity = table.number_or("permittivity", e.permittivity, {1, 10000});
  e.debye_length = table.find_number("debye_length", {1e-12, 1});
  e.ph = table.find_number("pH", {-10, 30});
  if (e.salt == "mixed") {
    set_debye_length(table, "ion", 1, e);
  } else if (const auto concentration = table.find_number("concentration", {1e-12, 1e6})) {
    set_debye_length(table, "concentration", *concentration, e);
  }
  return e;
}

SolverOptions read_solver(const TomlTable& table) {
  SolverOptions solver;
  solver.order = static_cast<int>(table.integer_or("order", solver.order, 1, 2));
  if (solver.order == 2 && table.has("quadrature"))
    table.refuse("quadrature", "order = 1 with it (of second order all integrals are taken by points)", "order = 2");
  if (table.word_or("quadrature", "nodal", {"nodal", "gauss"}) == "gauss") solver.quadrature = Quadrature::gauss;
  solver.tolerance = table.number_or("tolerance", solver.tolerance, {1e-15, 0.1});
  solver.max_newton = static_cast<int>(table.integer_or("max_newton", solver.max_newton, 1, 10000));
  solver.preconditioner = table.word_or("preconditioner", solver.preconditioner, {"auto", "jacobi", "boomeramg"});
  const auto options = check_petsc_options(table.text_or("petsc", ""));
  if (!options.refused.empty()) table.refuse("petsc", options.expected, "\"" + options.refused + "\"");
  solver.petsc = options.text;
  return solver;
}

EstimatorOptions read_estimator(const TomlTable& table) {
  EstimatorOptions estimator;
  if (table.word_or("recovery", "volume-weighted", {"volume-weighted", "plain"}) == "plain")
    estimator.recovery = Recovery::plain;
  estimator.goals = read_goals(table);
  return estimator;
}

constexpr double max_length = 1e12;  // Debye lengths; the largest that pamr-mesh makes

/// One read of a case file.
class Reader {
 public:
  explicit Reader(const TomlTable& file) : file_(file) {}

  Case read() {
    if (const auto table = file_.find_table("electrolyte")) result_.electrolyte = read_electrolyte(*table);
    if (const auto table = file_.find_table("lengths")) read_lengths(*table);
    if (const auto table = file_.find_table("equation")) {
      result_.linear = table->flag_or("linear", false);
      result_.split = table->flag_or("split", false);
      result_.manufactured = table->flag_or("manufactured", false);
    }
    for (const auto& table : file_.list("sphere"))
      result_.spheres.push_back({table.text_or("patch", ""), center_in(table), size_in(table, "radius")});
    if (const auto table = file_.find_table("pair")) read_pair(*table);
    if (const auto table = file_.find_table("plate"))
      result_.plate =
          Plate{table->text_or("patch", "plate"), length(*table, "position", table->number_or("position", 0)), 0};
    for (const auto& table : file_.list("body")) read_body(table);
    if (const auto table = file_.find_table("boundary"))
      for (const auto& patch : table->all_tables()) result_.boundary.push_back(read_boundary(patch));
    if (const auto table = file_.find_table("solver")) result_.solver = read_solver(*table);
    if (const auto table = file_.find_table("force")) read_force(*table);
    if (const auto table = file_.find_table("estimator")) result_.estimator = read_estimator(*table);
    file_.finish();
    check();
    return result_;
  }

 private:
  [[noreturn]] void refuse(const std::string& expected, const std::string& found) const {
    file_.fail(fmt::format("expected {}, found {}", expected, found));
  }

  /// In Debye lengths. Beyond the limit squares of coordinates overflow, and no mesh is as large.
  double length(const TomlTable& table, std::string_view key, double number) const {
    const double result = unit_ * number;
    if (!(std::abs(result) <= max_length))
      table.refuse(key, fmt::format("a length of at most {:g} Debye lengths", max_length), fmt::format("{:g}", result));
    return result;
  }

  double size_in(const TomlTable& table, std::string_view key) const {
    const double result = length(table, key, table.number(key, positive));
    if (result < 1 / max_length)
      table.refuse(key, fmt::format("a length of at least {:g} Debye lengths", 1 / max_length),
                   fmt::format("{:g}", result));
    return result;
  }

  geometry::Vec3 center_in(const TomlTable& table) const {
    const auto center = table.point<geometry::Vec3>("center");
    return {length(table, "center", center.x), length(table, "center", center.y), length(table, "center", center.z)};
  }

  void read_lengths(const TomlTable& table) {
    result_.length_unit = table.word_or("unit", result_.length_unit, {"debye", "m", "um", "nm"});
    unit_ = *debye_lengths_in(result_.length_unit, result_.electrolyte, file_.at());
  }

  void read_pair(const TomlTable& table) {
    const double radius = size_in(table, "radius"), distance = size_in(table, "distance");
    const double height = length(table, "height", table.number_or("height", 0));
    result_.spheres.push_back({table.text_or("patch", "sphere"), {distance / 2, 0, height}, radius});
    result_.spheres.push_back({table.text_or("other_patch", ""), {-distance / 2, 0, height}, radius});
  }

  void read_body(const TomlTable& table) {
    Body body{table.text("name"), table.texts("patches"), {}};
    if (body.patches.empty()) table.refuse("patches", "names of patches of the mesh");
    if (table.has("center")) body.center = center_in(table);
    for (const auto& other : result_.bodies)
      if (other.name == body.name) table.refuse("name", "another name for each [[body]]");
    result_.bodies.push_back(std::move(body));
  }

  static Condition read_condition(const TomlTable& table) {
    const bool is_old = is_stated(table, "condition");  // what `kind` was called
    if (is_old && table.has("kind"))
      refuse_both(table, "condition",
                  fmt::format("either kind or its old name condition in [boundary.{}]", table.name()));
    const auto word = table.word(is_old ? "condition" : "kind", {"potential", "charge", "regulated", "symmetry",
                                                                 "plate-profile", "far-field", "manufactured"});
    auto condition = Condition::symmetry;
    for (const auto& [known, name] : condition_names)
      if (word == name) condition = known;
    if (takes_value(condition)) return condition;
    for (const auto* key : {"value", "unit", "site", "pK"})
      if (table.has(key))
        throw Error(fmt::format("{}: expected no {} in [boundary.{}] with kind = \"{}\", found one", table.at(key), key,
                                table.name(), word));
    return condition;
  }

  /// A dimensionless potential or charge; `unit` is what 1 of its unit is.
  static double amount(const TomlTable& table, double unit) {
    const double value = unit * table.number("value");
    if (value != 0 && !(std::abs(value) >= min_size && std::abs(value) <= max_size))
      table.refuse("value", fmt::format("0 or a number of size {:g} to {:g}", min_size, max_size),
                   fmt::format("{:g}", value));
    return value;
  }

  Boundary read_boundary(const TomlTable& table) const {
    Boundary boundary;
    boundary.patch = table.name();
    boundary.condition = read_condition(table);
    const auto units = units_of(result_.electrolyte);
    double most = largest_potential;
    for (const auto& ion : result_.electrolyte.ions) most = std::min(most, largest_potential / std::abs(ion.charge));
    if (boundary.condition == Condition::potential) {
      const auto unit = table.word_or("unit", "kT/Ze", {"kT/Ze", "V", "mV"});
      const double scale = unit == "V" ? 1 / units.potential : unit == "mV" ? 1e-3 / units.potential : 1;
      boundary.value = amount(table, scale);
      if (!result_.linear && !(std::abs(boundary.value) <= most))
        table.refuse("value",
                     fmt::format("a potential of at most {:g} kT/Ze (its layer is {:.1e} Debye lengths thick, which no "
                                 "mesh can hold)",
                                 most, SourceTerm(false).layer_thickness(largest_potential)),
                     fmt::format("{:g} kT/Ze", boundary.value));
    } else if (boundary.condition == Condition::charge) {
      const auto unit = table.word_or("unit", "dimensionless", {"dimensionless", "C/m2"});
      if (unit == "C/m2" && !units.charge_density)
        throw Error(
            fmt::format("{}: expected debye_length or concentration in [electrolyte] for a charge in C/m2, found none",
                        table.at("unit")));
      boundary.value = amount(table, unit == "C/m2" ? 1 / *units.charge_density : 1);
      const double potential = result_.term().potential_of_charge(boundary.value);
      if (!result_.linear && !(std::abs(potential) <= most))
        table.refuse("value", fmt::format("a charge that makes a potential of at most {:g} kT/Ze", most),
                     fmt::format("{:g}, which makes {:.4g} kT/Ze on a flat wall", boundary.value, potential));
    } else if (boundary.condition == Condition::regulated) {
      boundary.site = read_site_charge(table, result_.electrolyte);
      const double potential = boundary.site.flat_wall_potential(result_.term());
      if (!result_.linear && !(std::abs(potential) <= most))
        table.refuse("value", fmt::format("sites that make a potential of at most {:g} kT/Ze", most),
                     fmt::format("{:.4g} kT/Ze on a flat wall", potential));
    }
    return boundary;
  }

  void read_force(const TomlTable& table) {
    auto& force = result_.force;
    force.midplane = table.text_or("midplane", "");
    force.inner = table.find_number("inner", NumberRange::at_least(0));
    force.outer = table.find_number("outer", positive);
    if (force.inner && force.outer && !(*force.inner < *force.outer))
      table.refuse("inner", fmt::format("a number below outer = {:g}", *force.outer));
    if (force.inner) *force.inner = length(table, "inner", *force.inner);
    if (force.outer) *force.outer = length(table, "outer", *force.outer);
  }

  void check_spheres() const {
    const auto& spheres = result_.spheres;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double distance = norm(spheres[i].center - spheres[j].center);
        if (!(distance > spheres[i].radius + spheres[j].radius))
          refuse("spheres that do not overlap or touch",
                 fmt::format("radii {:g} and {:g} at a distance of {:g} between their centers (Debye lengths)",
                             spheres[j].radius, spheres[i].radius, distance));
      }
      if (result_.plate && !(spheres[i].center.z - spheres[i].radius > result_.plate->position))
        refuse("spheres above the plate that do not touch it",
               fmt::format("a sphere of radius {:g} with its center {:g} above the plate (Debye lengths)",
                           spheres[i].radius, spheres[i].center.z - result_.plate->position));
      if (!spheres[i].patch.empty() && result_.find_boundary(spheres[i].patch) == nullptr)
        refuse("a table [boundary." + spheres[i].patch + "] for the patch of a sphere", "none");
    }
  }

  void check_bodies() const {
    require_bodies(result_, file_.at());
    bool has_sphere = false;
    for (const auto& sphere : result_.spheres) has_sphere = has_sphere || !sphere.patch.empty();
    if ((result_.force.inner || result_.force.outer) && !has_sphere)
      refuse("a [[sphere]] with a patch for inner and outer in [force]",
             "none: the cut-off functions of other bodies come from the mesh");
  }

  /// The profile of a plate begins at a potential, which a charge or sites have on a plate alone only.
  double potential_of_plate() const {
    const auto& patch = result_.plate->patch;
    const auto* b = result_.find_boundary(patch);
    if (b != nullptr && b->condition == Condition::potential) return b->value;
    std::string found = b == nullptr ? "none" : fmt::format("\"{}\"", name_of(b->condition));
    if (b != nullptr && takes_value(b->condition))
      found += fmt::format(
          " (the profile begins at a potential, alone this plate has {:.7g} kT/Ze: give it, or leave out "
          "[plate] and take \"symmetry\" for walls across the plate)",
          b->condition == Condition::charge ? result_.term().potential_of_charge(b->value)
                                            : b->site.flat_wall_potential(result_.term()));
    refuse(fmt::format("[boundary.{}] with kind = \"potential\" for the patch of the plate", patch), found);
  }

  void check() {
    if (result_.boundary.empty()) refuse("a table [boundary.PATCH] for every patch of the mesh", "none");
    if (result_.plate && !result_.linear && !result_.electrolyte.ions.empty())
      refuse("a Z:Z salt with a table [plate] (or linear = true): its profile is that of sinh",
             "\"" + result_.electrolyte.salt + "\"");
    if (result_.plate) result_.plate->potential = potential_of_plate();
    check_spheres();
    if (result_.split && !result_.plate) refuse("a table [plate] with split = true", "none");
    if (result_.split && result_.manufactured) refuse("either split or manufactured", "both");
    bool driven = false;
    for (const auto& b : result_.boundary) {
      driven = driven || fixes_potential(b.condition) || b.holds_charge();
      if (b.condition == Condition::manufactured && !result_.manufactured)
        refuse("manufactured = true in [equation] with kind = \"manufactured\"", "none");
    }
    if (!driven && !result_.manufactured)
      refuse("a patch with a given potential or charge, or a regulated one",
             "none: the potential would be zero everywhere");
    for (const auto& goal : result_.estimator.goals) {
      if (goal.kind == Goal::Kind::midplane && result_.force.midplane.empty())
        refuse("midplane = \"PATCH\" in [force] for goal = \"midplane\"", "none");
    }
    check_bodies();
  }

  const TomlTable& file_;
  Case result_;
  double unit_ = 1;
};

std::string with_unit(double value, const std::optional<double>& unit, const std::string& name) {
  return unit ? fmt::format("{:.7g} ({:.6g} {})", value, value * *unit, name) : fmt::format("{:.7g}", value);
}

}  // namespace

const char* name_of(Condition condition) {
  for (const auto& [known, name] : condition_names)
    if (known == condition) return name;
  return "";
}

bool fixes_potential(Condition condition) {
  return condition == Condition::potential || condition == Condition::plate_profile ||
         condition == Condition::manufactured;
}

const Boundary* Case::find_boundary(std::string_view patch) const {
  for (const auto& b : boundary)
    if (b.patch == patch) return &b;
  for (const auto& b : boundary)
    if (stands_for(b.patch, std::string(patch))) return &b;
  return nullptr;
}

bool Case::is_electrode(std::string_view patch) const {
  const auto* b = find_boundary(patch);
  return b != nullptr && takes_value(b->condition);
}

bool Case::has_regulated() const {
  return std::any_of(boundary.begin(), boundary.end(),
                     [](const Boundary& b) { return b.condition == Condition::regulated; });
}

PlateProfile Case::profile() const {
  return plate ? PlateProfile(plate->potential, plate->position, linear) : PlateProfile();
}

std::optional<double> debye_lengths_in(std::string_view unit, const Electrolyte& electrolyte,
                                       const std::string& where) {
  if (unit == "debye" || unit == "1" || unit.empty()) return 1.0;
  const double meters = unit == "m" ? 1 : unit == "um" ? 1e-6 : unit == "nm" ? 1e-9 : 0;
  if (meters == 0) return std::nullopt;
  if (!electrolyte.debye_length)
    throw Error(fmt::format("{}: expected debye_length or concentration in [electrolyte] for lengths in {}, found none",
                            where, unit));
  return meters / *electrolyte.debye_length;
}

Case read_case(std::string_view text, const std::string& where) {
  const auto file = parse_case(text, where);
  return Reader(file).read();
}

std::vector<std::string> describe(const Case& problem) {
  std::vector<std::string> lines;
  const auto& e = problem.electrolyte;
  const auto units = units_of(e);
  lines.push_back(fmt::format("{} salt, {:g} K, permittivity {:g}: kT/Ze = {:.6g} mV, force unit {:.6g} N", e.salt,
                              e.temperature, e.permittivity, 1e3 * units.potential, units.force));
  if (units.length)
    lines.push_back(e.ions.empty()
                        ? fmt::format("Debye length {:.6g} m, salt {:.6g} mol/m^3", *units.length, *units.concentration)
                        : fmt::format("Debye length {:.6g} m", *units.length));
  for (const auto& ion : e.ions)
    lines.push_back(fmt::format("ions of charge {:+}: {:.6g}{}", ion.charge,
                                ion.concentration * units.concentration.value_or(1),
                                units.length ? " mol/m^3" : " in each formula unit"));
  const auto* source = problem.linear ? "psi" : e.ions.empty() ? "sinh psi" : "- sum c z exp(-z psi) / sum c z^2";
  lines.push_back(fmt::format("equation: lap psi = {}{}{}", source,
                              problem.manufactured ? " + manufactured source" : "",
                              problem.split ? ", solved for u = psi - psi0(z)" : ""));
  for (const auto& s : problem.spheres)
    lines.push_back(fmt::format("sphere {}: radius {}, center ({:.7g}, {:.7g}, {:.7g}) Debye lengths",
                                s.patch.empty() ? "(beyond a mirror)" : s.patch, with_unit(s.radius, units.length, "m"),
                                s.center.x, s.center.y, s.center.z));
  if (problem.spheres.size() == 2)
    lines.push_back(
        fmt::format("distance of the centers {}",
                    with_unit(norm(problem.spheres[0].center - problem.spheres[1].center), units.length, "m")));
  if (problem.plate && !problem.spheres.empty())
    lines.push_back(fmt::format("height over the plate {}",
                                with_unit(problem.spheres[0].center.z - problem.plate->position, units.length, "m")));
  for (const auto& b : problem.boundary) {
    std::string value;
    if (b.condition == Condition::potential)
      value = " " + with_unit(b.value, units.potential, "V");
    else if (b.condition == Condition::charge)
      value = " " + with_unit(b.value, units.charge_density, "C/m^2");
    else if (b.condition == Condition::regulated)
      value = fmt::format(", {} sites {}, alone a flat wall of them has {}", b.site.density < 0 ? "acid" : "basic",
                          with_unit(std::abs(b.site.density), units.site_density, "/nm^2"),
                          with_unit(b.site.flat_wall_potential(problem.term()), units.potential, "V"));
    lines.push_back(
        fmt::format("patch {}{}: {}{}", b.patch, b.is_inside ? " (a sheet inside)" : "", name_of(b.condition), value));
  }
  for (const auto& patch : problem.open_inside)
    lines.push_back(fmt::format("patch {}: no condition on its faces inside, the liquid goes on through them", patch));
  return lines;
}

}  // namespace pamr::poisson_boltzmann
