// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/gas/gas_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>

#include "pamr/base/error.hpp"
#include "pamr/base/read_file.hpp"
#include "solvers/dsmc/gas/gases.hpp"
#include "solvers/dsmc/gas/standard_atmosphere.hpp"

namespace pamr::dsmc {

namespace {

using SpeciesByName = std::map<std::string, Species>;

/// [species.NAME.vibration].
Vibration read_vibration(const TomlTable& table) {
  Vibration vibration;
  const auto modes = static_cast<std::int64_t>(max_modes);
  const auto degeneracies =
      table.has("degeneracies") ? table.integers("degeneracies", 1, modes) : std::vector<std::int64_t>{1};
  const auto theta = table.numbers("temperatures", degeneracies.size());
  for (std::size_t i = 0; i < theta.size(); ++i) {
    if (!(theta[i] >= 1 && theta[i] <= 1e5)) table.refuse("temperatures", "numbers of 1 to 1e5 K");
    vibration.mode.insert(vibration.mode.end(), static_cast<std::size_t>(degeneracies[i]), theta[i]);
  }
  if (vibration.mode.empty() || vibration.mode.size() > max_modes)
    table.fail(fmt::format("expected 1 to {} modes, a degenerate one counted as often as it is, found {}", max_modes,
                           vibration.mode.size()));
  vibration.c1 = table.number("c1", {1e-30, 1e30});
  vibration.c2 = table.number("c2", {0, 1e4});
  vibration.cross_section = table.number_or("cross_section", 0, {0, 1e-15});
  return vibration;
}

void read_species(const TomlTable& tables, SpeciesByName& known) {
  for (const auto& table : tables.all_tables()) {
    Species s;
    s.name = table.name();
    s.mass = table.number("mass", {1e-30, 1e-20});
    s.diameter = table.number("diameter", {1e-12, 1e-6});
    s.omega = table.number("omega", {0.5, 1});
    s.t_ref = table.number("t_ref", temperatures);
    s.alpha = table.number_or("alpha", 1, {1, 2});
    s.rotational_degrees = static_cast<int>(table.integer_or("rotational_degrees", 0, 0, 3));
    if (const auto vibration = table.find_table("vibration")) {
      s.vibration = read_vibration(*vibration);
      if (s.rotational_degrees == 0)
        vibration->fail("expected no vibration of a species without rotational_degrees, found some");
    }
    known[s.name] = s;
  }
}

/// Whether the first line that is no comment is that of a species file of SPARTA: a name and four numbers or more.
bool is_of_sparta(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string name;
    if (!(words >> name)) continue;
    int n_numbers = 0;
    for (double number = 0; words >> number;) ++n_numbers;
    return n_numbers >= 4;
  }
  return false;
}

/// The file stands beside the case.
void read_species_file(const TomlTable& gas, const std::string& where, SpeciesByName& known) {
  const auto name = gas.text("species_file", "the name of a file");
  const auto path = (std::filesystem::path(where).parent_path() / name).string();
  const auto text = read_file(path);
  if (!text) gas.refuse("species_file", "the name of a file of species that can be read", fmt::format("\"{}\"", path));
  if (is_of_sparta(*text))
    throw Error(
        fmt::format("file '{}': expected TOML with tables [species.NAME], found a species file of SPARTA: write "
                    "[species.NAME] with mass (kg, third column of its .species) and rotational_degrees (fourth), and "
                    "diameter, omega, t_ref and alpha (second to fifth column of its .vss)",
                    path));
  const auto file = parse_toml(*text, path);
  read_species(file.table("species"), known);
  file.finish();
}

/// Fractions of the gas's species, in their order.
std::vector<double> read_fractions(const TomlTable& table, const Gas& gas) {
  std::vector<double> fraction;
  double sum = 0;
  for (const auto& s : gas.species) {
    fraction.push_back(table.number_or(s.name, 0, {0, 1}));
    sum += fraction.back();
  }
  table.finish();
  if (std::fabs(sum - 1) > 1e-9)
    table.fail(fmt::format("expected fractions that add up to 1, found a sum of {:g}", sum));
  for (auto& f : fraction) f /= sum;
  return fraction;
}

/// Of the species of the standard atmosphere at an altitude, in the order of the gas's species, which have to have all
/// of it.
std::vector<double> fractions_of_air(const TomlTable& stream, double altitude, const Gas& gas) {
  const auto air = standard_air(altitude);
  std::vector<double> fraction(gas.species.size(), 0.0);
  for (std::size_t a = 0; a < air_species.size(); ++a) {
    const auto found = std::find_if(gas.species.begin(), gas.species.end(),
                                    [&](const Species& s) { return s.name == air_species[a]; });
    if (found == gas.species.end())
      stream.fail(
          fmt::format("expected {} among the fractions of [gas] (0 will do), no fractions there, or fractions "
                      "beside altitude, found none of these",
                      air_species[a]));
    fraction[static_cast<std::size_t>(found - gas.species.begin())] = air.density[a] / air.total();
  }
  return fraction;
}

/// Loads on walls are added up in units of the first species' momentum.
void require_masses(const TomlTable& fractions, const Gas& gas) {
  constexpr double max_ratio = 1e4;
  for (const auto& a : gas.species)
    for (const auto& b : gas.species)
      if (a.mass > max_ratio * b.mass)
        fractions.fail(
            fmt::format("expected molecules whose masses differ by a factor of at most {:g}, found {} of {:g} "
                        "kg and {} of {:g} kg",
                        max_ratio, a.name, a.mass, b.name, b.mass));
}

Rotation read_rotation(const TomlTable& table) {
  Rotation rotation;
  const int given = table.has("probability") + table.has("z_continuum") + table.has("z_infinity");
  if (given != 1)
    table.fail(fmt::format(
        "expected one of probability, z_continuum and z_infinity in [gas.rotation], found {} of them", given));
  if (table.has("probability")) {
    rotation.model = Rotation::Model::probability;
    rotation.value = table.number("probability", {0, 0.5});
  } else if (table.has("z_continuum")) {
    rotation.model = Rotation::Model::z_continuum;
    rotation.value = table.number("z_continuum", {1, 1e12});
  } else {
    rotation.model = Rotation::Model::variable;
    rotation.z_infinity = table.number("z_infinity", {1e-6, 1e12});
    rotation.t_star = table.number("t_star", temperatures);
  }
  return rotation;
}

/// [gas] vibration: without it no species has any.
void choose_vibration(const std::optional<TomlTable>& table, Gas& gas) {
  if (table && table->flag_or("vibration", false)) {
    bool any = false;
    for (const auto& s : gas.species) {
      if (s.rotational_degrees > 0 && s.vibration.mode.empty())
        table->refuse("vibration", fmt::format("a table [species.{}.vibration] beside true", s.name));
      any = any || !s.vibration.mode.empty();
    }
    if (!any) table->refuse("vibration", "false, or a gas with molecules of two or more atoms");
    return;
  }
  for (auto& s : gas.species) s.vibration = {};
}

/// [stream.free], if it has an altitude.
std::optional<TomlTable> free_stream_of_air(const TomlTable& file) {
  const auto streams = file.find_table("stream");
  auto free = streams ? streams->find_table("free") : std::nullopt;
  return free && free->has("altitude") ? free : std::nullopt;
}

/// Molecules per m3, from the density or the pressure.
double read_density(const TomlTable& table, double temperature) {
  constexpr NumberRange densities{1, 1e30};
  if (!table.has("pressure")) return number_or_none(table, "density", densities);
  if (table.has("density")) table.refuse("density", "no such key beside pressure");
  const double density = table.number("pressure") / (boltzmann * temperature);
  if (density != 0 && !(density >= densities.low && density <= densities.high))
    table.refuse("pressure",
                 fmt::format("0 or a pressure of {:g} to {:g} molecules per m3", densities.low, densities.high),
                 fmt::format("one of {:g}", density));
  return density;
}

Stream read_stream(const TomlTable& table, const Gas& gas) {
  Stream s;
  s.name = table.name();
  const auto altitude = table.find_number("altitude", altitudes);
  if (altitude) {
    for (const auto* key : {"density", "pressure", "temperature"})
      if (table.has(key)) table.refuse(key, "no such key beside altitude, which sets it");
    const auto air = standard_air(*altitude);
    s.density = air.total();
    s.temperature = air.temperature;
  } else {
    s.temperature = table.number("temperature", temperatures);
    s.density = read_density(table, s.temperature);
  }
  s.rotational_temperature = table.number_or("rotational_temperature", s.temperature, {0, 1e6});
  if (!gas.is_vibrating && table.has("vibrational_temperature"))
    table.refuse("vibrational_temperature", "no such key without vibration = true in [gas]");
  s.vibrational_temperature = table.number_or("vibrational_temperature", s.temperature, {0, 1e6});
  if (table.has("speed")) {
    const double speed = number_or_none(table, "speed", speeds);
    const double angle = table.number_or("angle", 0, {-180, 180}) * std::numbers::pi / 180;
    s.velocity = {speed * std::cos(angle), 0, speed * std::sin(angle)};
  } else if (table.has("velocity")) {
    s.velocity = read_velocity(table, "velocity");
  }
  if (const auto fractions = table.find_table("fractions"))
    s.fraction = read_fractions(*fractions, gas);
  else
    s.fraction = altitude ? fractions_of_air(table, *altitude, gas) : gas.fraction;
  return s;
}

}  // namespace

double number_or_none(const TomlTable& table, std::string_view key, NumberRange range) {
  const double value = table.number(key);
  if (value != 0 && !(value >= range.low && value <= range.high))
    table.refuse(key, fmt::format("0 or a number between {:g} and {:g}", range.low, range.high));
  return value;
}

Vec3 read_velocity(const TomlTable& table, std::string_view key) {
  const auto velocity = table.point<Vec3>(key);
  const double speed = norm(velocity);
  if (speed != 0 && !(speed >= speeds.low && speed <= speeds.high))
    table.refuse(key, fmt::format("[x, y, z], of a length of 0 or between {:g} and {:g} m/s", speeds.low, speeds.high),
                 fmt::format("[{:g}, {:g}, {:g}]", velocity.x, velocity.y, velocity.z));
  return velocity;
}

Vec3 read_place(const TomlTable& table, std::string_view key) {
  const auto place = table.point<Vec3>(key);
  if (!(std::fabs(place.x) <= max_place && std::fabs(place.y) <= max_place && std::fabs(place.z) <= max_place))
    table.refuse(key, fmt::format("[x, y, z] of at most {:g} m each", max_place),
                 fmt::format("[{:g}, {:g}, {:g}]", place.x, place.y, place.z));
  return place;
}

Gas read_gas(const TomlTable& file, const std::string& where) {
  Gas gas;
  SpeciesByName known;
  read_species(parse_toml(known_gases(), "gases.toml").table("species"), known);
  const auto table = file.find_table("gas");
  if (table && table->has("species_file")) read_species_file(*table, where, known);
  if (const auto species = file.find_table("species")) read_species(*species, known);
  const auto air = free_stream_of_air(file);
  if (!air || (table && table->has("fractions"))) {
    const auto fractions = file.table("gas").table("fractions");
    for (const auto& [name, s] : known)
      if (fractions.has(name)) gas.species.push_back(s);
    gas.fraction = read_fractions(fractions, gas);
    require_masses(fractions, gas);
  } else {
    for (const auto& [name, s] : known)
      if (std::find(air_species.begin(), air_species.end(), name) != air_species.end()) gas.species.push_back(s);
    gas.fraction = fractions_of_air(*air, air->number("altitude", altitudes), gas);
    require_masses(*air, gas);
  }
  if (table)
    if (const auto rotation = table->find_table("rotation")) gas.rotation = read_rotation(*rotation);
  choose_vibration(table, gas);
  prepare(gas);
  return gas;
}

std::vector<Stream> read_streams(const TomlTable& streams, const Gas& gas) {
  std::vector<Stream> all;
  for (const auto& table : streams.all_tables()) {
    const auto stream = read_stream(table, gas);
    all.insert(stream.name == "free" ? all.begin() : all.end(), stream);
  }
  if (all.empty() || all.front().name != "free") streams.fail("expected a table [stream.free], found none");
  return all;
}

void read_species_weights(const TomlTable& weights, Gas& gas) {
  for (auto& s : gas.species) s.weight = weights.number_or(s.name, 1, {1e-9, 1});
  try {
    prepare(gas);
  } catch (const Error& error) {
    weights.fail(error.what());
  }
}

}  // namespace pamr::dsmc
