// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/flow_case.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "pamr/base/case_file.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/name_pattern.hpp"
#include "solvers/dsmc/gas/gas_tables.hpp"

namespace pamr::dsmc {

namespace {

using Kind = BoundaryCondition::Kind;

int stream_named(const Case& c, const TomlTable& table, std::string_view key) {
  const auto name = table.text_or(key, "free", "the name of a stream");
  for (std::size_t i = 0; i < c.stream.size(); ++i)
    if (c.stream[i].name == name) return static_cast<int>(i);
  table.refuse(key, "the name of a table [stream.NAME]");
}

BoundaryCondition read_wall(const TomlTable& table, const std::string& kind, const Gas& gas) {
  BoundaryCondition b;
  b.kind = kind == "cll" ? Kind::cll : Kind::diffuse;
  b.temperature = table.number("temperature", temperatures);
  if (table.has("velocity")) b.velocity = read_velocity(table, "velocity");
  if (kind == "maxwell") b.accommodation = table.number("accommodation", {0, 1});
  if (kind != "cll") return b;
  b.normal_accommodation = table.number("normal_accommodation", {0, 1});
  b.tangential_accommodation = table.number("tangential_accommodation", {0, 1});
  b.rotational_accommodation = table.number_or("rotational_accommodation", 1, {0, 1});
  if (!gas.is_vibrating && table.has("vibrational_accommodation"))
    table.refuse("vibrational_accommodation", "no such key without vibration = true in [gas]");
  b.vibrational_accommodation = table.number_or("vibrational_accommodation", 1, {0, 1});
  return b;
}

/// An inlet or outlet.
BoundaryCondition read_driven(const TomlTable& table, const std::string& kind, const Case& c) {
  constexpr double max_value = 1e15;
  BoundaryCondition b;
  if (kind == "outlet") {
    b.kind = Kind::outlet;
    b.pressure = table.number("pressure", {0, max_value, true});
  } else {
    b.kind = Kind::inlet;
    b.stream = stream_named(c, table, "stream");
    if (table.has("mass_flow")) b.mass_flow = table.number("mass_flow", {0, max_value, true});
    if (!(c.stream[static_cast<std::size_t>(b.stream)].density > 0))
      table.fail("expected a stream with a density or pressure above 0 for an inlet");
  }
  b.relaxation = static_cast<double>(table.integer_or("relaxation", 100, 1, 1000000));
  return b;
}

/// Which side of a wall inside the gas is its front.
void read_facing(const TomlTable& table, Case& c) {
  const bool has_point = table.has("inside");
  if (!has_point && !table.has("front")) return;
  if (is_name_pattern(table.name()))
    table.refuse(has_point ? "inside" : "front", "no such key for several patches at once");
  if (has_point) {
    if (table.has("front")) table.refuse("front", "no such key beside inside");
    c.facing[table.name()] = {read_place(table, "inside"), true};
    return;
  }
  const auto front = table.point<Vec3>("front");
  const double length = norm(front);
  if (!(length > 0 && std::isfinite(length))) table.refuse("front", "a direction");
  c.facing[table.name()] = {(1 / length) * front, false};
}

void read_boundaries(const TomlTable& boundaries, Case& c) {
  for (const auto& table : boundaries.all_tables()) {
    const auto& patch = table.name();
    const auto kind = table.word("kind", {"diffuse", "specular", "maxwell", "cll", "symmetry", "inflow", "outflow",
                                          "inlet", "outlet", "periodic"});
    BoundaryCondition b;
    if (kind == "diffuse" || kind == "maxwell" || kind == "cll") b = read_wall(table, kind, c.gas);
    if (kind == "specular") b.kind = Kind::specular;
    if (kind == "symmetry") b.kind = Kind::symmetry;
    if (kind == "outflow") b.kind = Kind::outflow;
    if (kind == "inlet" || kind == "outlet") b = read_driven(table, kind, c);
    if (kind == "inflow") {
      b.kind = Kind::inflow;
      b.stream = stream_named(c, table, "stream");
    }
    if (kind == "periodic") {
      if (is_name_pattern(patch)) table.refuse("kind", "another kind for several patches at once");
      b.kind = Kind::periodic;
      c.partner[patch] = table.text("partner", "the name of the opposite patch");
    }
    if (b.is_wall()) read_facing(table, c);
    c.boundary[patch] = b;
    c.boundary_at[patch] = table.at();
  }
  for (const auto& [patch, partner] : c.partner)
    if (const auto found = c.partner.find(partner);
        patch == partner || found == c.partner.end() || found->second != patch)
      throw Error(
          fmt::format("{}: expected partner = the name of another periodic patch whose partner is \"{}\", found \"{}\"",
                      c.boundary_at[patch], patch, partner));
}

void read_initial(const TomlTable& initial, Case& c) {
  c.initial = initial.text_or("stream", "free", "the name of a stream or \"vacuum\"") == "vacuum"
                  ? -1
                  : stream_named(c, initial, "stream");
  for (const auto& table : initial.list("region")) {
    Region region;
    if (table.has("sphere")) {
      const auto [x, y, z, radius] = table.numbers<4>("sphere");
      if (!(radius > 0)) table.refuse("sphere", "[x, y, z, radius] with a positive radius");
      region.center = {x, y, z};
      region.radius = radius;
    } else {
      const auto b = table.numbers<6>("box");
      region.low = {b[0], b[1], b[2]};
      region.high = {b[3], b[4], b[5]};
    }
    region.stream = stream_named(c, table, "stream");
    c.region.push_back(region);
    c.region_at.push_back(table.at());
  }
}

CollisionOptions read_collisions(const TomlTable& table) {
  CollisionOptions collisions;
  collisions.enabled = table.flag_or("enabled", true);
  using Partner = CollisionOptions::Partner;
  const auto partner = table.word_or("partner", "nearest", {"nearest", "subcell", "any"});
  collisions.partner = partner == "any" ? Partner::any : partner == "subcell" ? Partner::subcell : Partner::nearest;
  return collisions;
}

void read_particles(const TomlTable& table, Case& c) {
  c.weight = table.find_number("weight", {0, 1e60, true});
  c.per_cell = table.find_number("per_cell", {1e-9, 1e6});
  c.total = table.find_number("total", {1, 1e12});
  const int given = c.weight.has_value() + c.per_cell.has_value() + c.total.has_value();
  if (given != 1)
    table.fail(fmt::format("expected one of weight, per_cell and total in [particles], found {} of them", given));
  if (const auto weights = table.find_table("species_weights")) read_species_weights(*weights, c.gas);
}

void read_time(const TomlTable& table, Case& c) {
  c.dt = table.number("step", {1e-20, 1e6});
  if (table.has("cell_fraction")) c.cell_fraction = number_or_none(table, "cell_fraction", {1e-6, 10});
  if (table.has("collision_fraction")) c.collision_fraction = number_or_none(table, "collision_fraction", {1e-6, 10});
  c.from_fields = table.flag_or("from_fields", false);
  if (c.from_fields && c.cell_fraction == 0 && c.collision_fraction == 0)
    table.refuse("from_fields", "cell_fraction or collision_fraction beside it");
}

void read_run(const TomlTable& table, Case& c) {
  constexpr std::int64_t max_steps = std::int64_t{1} << 32U;
  auto& s = c.schedule;
  c.seed = static_cast<std::uint64_t>(table.integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
  s.transient = table.find_integer("transient", 0, max_steps);
  s.max_transient = table.integer_or("most_transient", s.max_transient, 0, max_steps);
  s.sampling = table.integer_or("sampling", s.sampling, 1, max_steps);
  s.block = table.integer_or("block", 0, 1, max_steps);
  s.stop_error = table.number_or("stop_error", 0, {0, 1});
  s.window = table.integer_or("window", 0, 1, max_steps);
  if (s.window == 0) return;
  if (!s.transient) s.transient = 0;  // a flow that changes never becomes steady
  if (s.block == 0) s.block = s.window % 10 == 0 ? s.window / 10 : s.window;
  if (s.window % s.block != 0) table.refuse("window", fmt::format("a multiple of block ({})", s.block));
  if (s.stop_error > 0) table.refuse("stop_error", "no such key beside window");
}

void read_adaptation(const TomlTable& table, Case& c) {
  auto& a = c.adaptation;
  if (!c.partner.empty())
    table.fail("expected no periodic patches beside [adapt], whose faces would not match any more");
  if (c.schedule.window == 0)
    table.fail("expected window in [run], the steps whose averages choose the cells, found none");
  a.every = table.integer_or("every", c.schedule.window, 1, std::numeric_limits<std::int32_t>::max());
  if (a.every % c.schedule.window != 0)
    table.refuse("every", fmt::format("a multiple of window in [run] ({})", c.schedule.window));
  a.mark = table.text("mark", "criteria as pamr-mark takes them");
  try {
    a.request = mark::read_request(mark::split_options(a.mark));
  } catch (const Error& error) {
    table.fail(fmt::format("mark: {}", error.what()));
  }
  a.max_cells = table.find_integer("max_cells", 1, std::numeric_limits<std::int64_t>::max());
}

void read_reference(const TomlTable& table, Case& c) {
  auto& r = c.reference;
  r.area = table.number("area", {1e-24, 1e24});
  r.length = table.number_or("length", 1, {1e-12, 1e12});
  if (table.has("point")) r.point = read_place(table, "point");
  if (table.has("pitch_axis")) r.pitch_axis = table.point<Vec3>("pitch_axis");
  const double length = norm(r.pitch_axis);
  if (!(length > 0 && std::isfinite(length))) table.refuse("pitch_axis", "a direction");
  r.pitch_axis = (1 / length) * r.pitch_axis;
  r.multiplier = table.number_or("multiplier", 1, {1e-6, 1e6});
  if (table.has("patches")) r.patches = table.texts("patches");
  for (const auto& patch : r.patches) {
    if (is_name_pattern(patch)) continue;  // the mesh tells which, and what is the name of a group
    const auto* condition = c.find_boundary(patch);
    if (condition != nullptr && !condition->is_wall())
      table.refuse("patches", "names of walls", fmt::format("\"{}\"", patch));
  }
}

Station read_station(const TomlTable& table) {
  Station s;
  s.name = table.text("name", "a name");
  s.x = table.number("x", {-max_place, max_place});
  s.r = table.number("r", {0, max_place});
  s.half_width = table.number("half_width", {0, max_place, true});
  return s;
}

ProbeLine read_line(const TomlTable& table) {
  ProbeLine l;
  l.name = table.text("name", "a name");
  l.from = read_place(table, "from");
  l.to = table.has("to") ? read_place(table, "to") : l.from;
  l.n_points = table.integer_or("points", 1, 1, 100000);
  return l;
}

ProbePlane read_plane(const TomlTable& table) {
  ProbePlane p;
  p.name = table.text("name", "a name");
  p.corner = read_place(table, "corner");
  p.along = read_place(table, "along");
  p.across = read_place(table, "across");
  const auto points = table.numbers<2>("points");
  for (const double n : points)
    if (!(n >= 2 && n <= 10000 && n == std::floor(n))) table.refuse("points", "two integers between 2 and 10000");
  p.n_along = static_cast<std::int64_t>(points[0]);
  p.n_across = static_cast<std::int64_t>(points[1]);
  return p;
}

/// A plane or disk by `point` and `normal`, or the parallelogram of a plane of points.
void add_flux_plane(const TomlTable& table, Case& c) {
  FluxPlane p;
  p.name = table.text("name", "a name");
  for (const auto& other : c.flux_plane)
    if (other.name == p.name) table.refuse("name", "a name that no other counted plane has");
  const bool is_parallelogram = table.has("corner");
  if (is_parallelogram) {
    p.point = read_place(table, "corner");
    p.along = read_place(table, "along");
    p.across = read_place(table, "across");
    p.normal = cross(p.along, p.across);
  } else {
    p.point = read_place(table, "point");
    p.normal = table.point<Vec3>("normal");
    if (table.has("radius")) p.radius = table.number("radius", {0, max_place, true});
  }
  const double length = norm(p.normal);
  if (!(length > 0 && std::isfinite(length)))
    table.refuse(is_parallelogram ? "across" : "normal", is_parallelogram ? "an edge across `along`" : "a direction");
  p.normal = (1 / length) * p.normal;
  c.flux_plane.push_back(p);
}

}  // namespace

const BoundaryCondition* Case::find_boundary(const std::string& patch, const std::vector<std::string>& groups) const {
  std::vector<std::string> names;
  for (const auto& [name, condition] : boundary) names.push_back(name);
  const auto found = find_pattern(names, patch, where + ": [boundary.PATCH]", groups);
  return found ? &boundary.at(names[*found]) : nullptr;
}

Case read_case(std::string_view text, const std::string& where) {
  const auto file = parse_case(text, where);
  Case c;
  c.where = where;
  c.gas = read_gas(file, where);
  c.stream = read_streams(file.table("stream"), c.gas);
  read_boundaries(file.table("boundary"), c);
  if (const auto table = file.find_table("initial")) read_initial(*table, c);
  if (const auto table = file.find_table("collisions")) c.collisions = read_collisions(*table);
  read_particles(file.table("particles"), c);
  read_time(file.table("time"), c);
  if (const auto table = file.find_table("run")) read_run(*table, c);
  if (const auto table = file.find_table("adapt")) read_adaptation(*table, c);
  if (const auto table = file.find_table("reference")) read_reference(*table, c);
  for (const auto& table : file.list("station")) c.station.push_back(read_station(table));
  for (const auto& table : file.list("line")) {
    c.line.push_back(read_line(table));
    for (std::size_t i = 0; i + 1 < c.line.size(); ++i)
      if (c.line[i].name == c.line.back().name)
        table.refuse("name", "a name that no other [[line]] has", "\"" + c.line[i].name + "\" again");
  }
  for (const auto& table : file.list("plane"))
    if (table.has("points"))
      c.plane.push_back(read_plane(table));
    else
      add_flux_plane(table, c);
  if (const auto table = file.find_table("domain")) c.unit = table->number("unit", {1e-15, 1e15});
  file.finish();
  return c;
}

}  // namespace pamr::dsmc
