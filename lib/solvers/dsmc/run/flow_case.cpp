// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/flow_case.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "pamr/base/error.hpp"
#include "solvers/dsmc/run/toml_table.hpp"

namespace pamr::dsmc {

namespace {

constexpr double infinity = TomlTable::infinity;
using Kind = BoundaryCondition::Kind;

/// One read of a case file.
class Reader {
 public:
  explicit Reader(const std::string& where) { case_.where = where; }

  Case read(const toml::table& file) {
    TomlTable root(file, case_.where, "");
    root.ignore("mesh");  // of pamr-mesh
    const auto need = [&](std::string_view name) {
      auto table = root.table(name);
      if (!table) throw Error(fmt::format("{}: expected a table [{}], found none", case_.where, name));
      return *table;
    };
    read_gas(need("gas"), root.table("species"));
    read_streams(need("stream"));
    read_boundaries(need("boundary"));
    if (auto table = root.table("initial")) read_initial(*table);
    if (auto table = root.table("collisions")) read_collisions(*table);
    read_particles(need("particles"));
    read_time(need("time"));
    if (auto table = root.table("run")) read_run(*table);
    if (auto table = root.table("reference")) read_reference(*table);
    read_probes(root);
    if (auto table = root.table("domain")) {
      case_.unit = table->number("unit", 0, infinity, true);
      table->done();
    }
    root.done();
    return case_;
  }

 private:
  void read_species(TomlTable tables) {
    for (auto& [name, table] : tables.tables()) {
      Species s;
      s.name = name;
      s.mass = table.number("mass", 0, 1e-20, true);
      s.diameter = table.number("diameter", 0, 1e-6, true);
      s.omega = table.number("omega", 0.5, 1);
      s.t_ref = table.number("t_ref", 0, infinity, true);
      s.alpha = table.number_or("alpha", 1, 1, 2);
      s.rotational_degrees = static_cast<int>(table.integer_or("rotational_degrees", 0, 0, 3));
      table.done();
      known_[name] = s;
    }
  }

  void read_species_file(TomlTable& gas) {
    const auto name = gas.text("species_file", "the name of a file");
    const auto path = std::filesystem::path(case_.where).parent_path() / name;
    try {
      const auto file = toml::parse_file(path.string());
      TomlTable root(file, path.string(), "");
      auto tables = root.table("species");
      root.done();
      if (!tables) throw Error(path.string() + ": expected tables [species.NAME], found none");
      read_species(*tables);
    } catch (const toml::parse_error& error) {
      throw Error(fmt::format("{}:{}: expected a TOML file of species, found {}", path.string(),
                              error.source().begin.line, error.description()));
    }
  }

  /// Parts of the species in the order of `case_.gas.species`.
  std::vector<double> read_fractions(TomlTable table) const {
    std::vector<double> fraction;
    double sum = 0;
    for (const auto& s : case_.gas.species) {
      fraction.push_back(table.number_or(s.name, 0, 0, 1));
      sum += fraction.back();
    }
    table.done();
    if (std::fabs(sum - 1) > 1e-9)
      throw Error(fmt::format("{}: expected fractions that add up to 1, found a sum of {:g}", table.at(), sum));
    for (auto& f : fraction) f /= sum;
    return fraction;
  }

  void read_gas(TomlTable gas, std::optional<TomlTable> species) {
    if (gas.has("species_file")) read_species_file(gas);
    if (species) read_species(*species);
    auto fractions = gas.table("fractions");
    if (!fractions) gas.refuse("fractions", "{ SPECIES = PART, ... }");
    for (const auto& [name, s] : known_)
      if (fractions->has(name)) case_.gas.species.push_back(s);
    case_.gas.fraction = read_fractions(*fractions);
    if (auto rotation = gas.table("rotation")) {
      auto& r = case_.gas.rotation;
      const int given = rotation->has("probability") + rotation->has("z_continuum") + rotation->has("z_infinity");
      if (given != 1)
        throw Error(
            fmt::format("{}: expected one of probability, z_continuum and z_infinity in [gas.rotation], found "
                        "{} of them",
                        rotation->at(), given));
      if (rotation->has("probability")) {
        r.model = Rotation::Model::probability;
        r.value = rotation->number("probability", 0, 0.5);
      } else if (rotation->has("z_continuum")) {
        r.model = Rotation::Model::z_continuum;
        r.value = rotation->number("z_continuum", 1, infinity);
      } else {
        r.model = Rotation::Model::variable;
        r.z_infinity = rotation->number("z_infinity", 0, infinity, true);
        r.t_star = rotation->number("t_star", 0, infinity, true);
      }
      rotation->done();
    }
    gas.done();
    prepare(case_.gas);
  }

  void read_streams(TomlTable streams) {
    for (auto& [name, table] : streams.tables()) {
      Stream s;
      s.name = name;
      s.density = table.number("density", 0, 1e30);
      s.temperature = table.number("temperature", 0, 1e6, true);
      s.rotational_temperature = table.number_or("rotational_temperature", s.temperature, 0, 1e6);
      if (table.has("speed")) {
        const double speed = table.number("speed", 0, 1e6);
        const double angle = table.number_or("angle", 0, -180, 180) * std::numbers::pi / 180;
        s.velocity = {speed * std::cos(angle), 0, speed * std::sin(angle)};
      } else if (table.has("velocity")) {
        s.velocity = table.vector("velocity");
      }
      auto fractions = table.table("fractions");
      s.fraction = fractions ? read_fractions(*fractions) : case_.gas.fraction;
      table.done();
      case_.stream.insert(name == "free" ? case_.stream.begin() : case_.stream.end(), s);
    }
    if (case_.stream.empty() || case_.stream.front().name != "free")
      throw Error(fmt::format("{}: expected a table [stream.free], found none", streams.at()));
  }

  int stream_named(TomlTable& table, std::string_view key) {
    const auto name = table.text_or(key, "free", "the name of a stream");
    for (std::size_t i = 0; i < case_.stream.size(); ++i)
      if (case_.stream[i].name == name) return static_cast<int>(i);
    table.refuse(key, "the name of a table [stream.NAME]");
  }

  void read_boundaries(TomlTable boundaries) {
    static const std::map<std::string, Kind> kinds{{"diffuse", Kind::diffuse},   {"specular", Kind::specular},
                                                   {"maxwell", Kind::diffuse},   {"cll", Kind::cll},
                                                   {"symmetry", Kind::symmetry}, {"inflow", Kind::inflow},
                                                   {"outflow", Kind::outflow},   {"periodic", Kind::periodic}};
    for (auto& [patch, table] : boundaries.tables()) {
      constexpr const char* expected =
          "\"diffuse\", \"specular\", \"maxwell\", \"cll\", \"symmetry\", \"inflow\", \"outflow\" or \"periodic\"";
      const auto kind = table.text("kind", expected);
      if (!kinds.contains(kind)) table.refuse("kind", expected);
      BoundaryCondition b;
      b.kind = kinds.at(kind);
      if (b.kind == Kind::diffuse || b.kind == Kind::cll) {
        b.temperature = table.number("temperature", 0, 1e6, true);
        if (table.has("velocity")) b.velocity = table.vector("velocity");
      }
      if (kind == "maxwell") b.accommodation = table.number("accommodation", 0, 1);
      if (b.kind == Kind::cll) {
        b.normal_accommodation = table.number("normal_accommodation", 0, 1);
        b.tangential_accommodation = table.number("tangential_accommodation", 0, 1);
        b.rotational_accommodation = table.number_or("rotational_accommodation", 1, 0, 1);
      }
      if (b.kind == Kind::inflow) b.stream = stream_named(table, "stream");
      if (b.kind == Kind::periodic) case_.partner[patch] = table.text("partner", "the name of the opposite patch");
      table.done();
      case_.boundary[patch] = b;
      case_.boundary_at[patch] = table.at();
    }
    for (const auto& [patch, partner] : case_.partner)
      if (const auto found = case_.partner.find(partner);
          patch == partner || found == case_.partner.end() || found->second != patch)
        throw Error(fmt::format(
            "{}: expected partner = the name of another periodic patch whose partner is \"{}\", found \"{}\"",
            case_.boundary_at[patch], patch, partner));
  }

  void read_initial(TomlTable& initial) {
    if (initial.text_or("stream", "free", "the name of a stream or \"vacuum\"") == "vacuum")
      case_.initial = -1;
    else
      case_.initial = stream_named(initial, "stream");
    for (auto& table : initial.list("region")) {
      Region region;
      if (table.has("sphere")) {
        const auto s = table.numbers("sphere", 4);
        if (!(s[3] > 0)) table.refuse("sphere", "[x, y, z, radius] with a positive radius");
        region.center = {s[0], s[1], s[2]};
        region.radius = s[3];
      } else {
        const auto b = table.numbers("box", 6);
        region.low = {b[0], b[1], b[2]};
        region.high = {b[3], b[4], b[5]};
      }
      region.stream = stream_named(table, "stream");
      table.done();
      case_.region.push_back(region);
    }
    initial.done();
  }

  void read_collisions(TomlTable& table) {
    case_.collisions.enabled = table.flag_or("enabled", true);
    const auto partner = table.text_or("partner", "nearest", "\"nearest\" or \"any\"");
    if (partner != "nearest" && partner != "any") table.refuse("partner", "\"nearest\" or \"any\"");
    case_.collisions.partner = partner == "any" ? CollisionOptions::Partner::any : CollisionOptions::Partner::nearest;
    table.done();
  }

  void read_particles(TomlTable table) {
    const int given = table.has("weight") + table.has("per_cell") + table.has("total");
    if (given != 1)
      throw Error(fmt::format("{}: expected one of weight, per_cell and total in [particles], found {} of them",
                              table.at(), given));
    if (table.has("weight")) case_.weight = table.number("weight", 0, infinity, true);
    if (table.has("per_cell")) case_.per_cell = table.number("per_cell", 0, 1e6, true);
    if (table.has("total")) case_.total = table.number("total", 0, 1e12, true);
    if (auto weights = table.table("species_weights")) {
      for (auto& s : case_.gas.species) s.weight = weights->number_or(s.name, 1, 0, 1, true);
      weights->done();
      try {
        prepare(case_.gas);
      } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", weights->at(), error.what()));
      }
    }
    table.done();
  }

  void read_time(TomlTable table) {
    case_.dt = table.number("step", 0, infinity, true);
    case_.cell_fraction = table.number_or("cell_fraction", 0, 0, 10);
    case_.collision_fraction = table.number_or("collision_fraction", 0, 0, 10);
    case_.from_fields = table.flag_or("from_fields", false);
    if (case_.from_fields && case_.cell_fraction == 0 && case_.collision_fraction == 0)
      table.refuse("from_fields", "cell_fraction or collision_fraction beside it");
    table.done();
  }

  void read_run(TomlTable& table) {
    constexpr std::int64_t most = std::int64_t{1} << 32U;
    case_.seed = static_cast<std::uint64_t>(table.integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
    if (table.has("transient")) case_.schedule.transient = table.integer_or("transient", 0, 0, most);
    case_.schedule.max_transient = table.integer_or("most_transient", case_.schedule.max_transient, 0, most);
    case_.schedule.sampling = table.integer_or("sampling", case_.schedule.sampling, 1, most);
    case_.schedule.block = table.integer_or("block", 0, 1, most);
    case_.schedule.stop_error = table.number_or("stop_error", 0, 0, 1);
    table.done();
  }

  void read_probes(TomlTable& root) {
    for (auto& table : root.list("station")) {
      Station s;
      s.name = table.text("name", "a name");
      s.x = table.number("x", -infinity, infinity);
      s.r = table.number("r", 0, infinity);
      s.half_width = table.number("half_width", 0, infinity, true);
      table.done();
      case_.station.push_back(s);
    }
    for (auto& table : root.list("line")) {
      ProbeLine l;
      l.name = table.text("name", "a name");
      l.from = table.vector("from");
      l.to = table.has("to") ? table.vector("to") : l.from;
      l.n_points = table.integer_or("points", 1, 1, 100000);
      table.done();
      case_.line.push_back(l);
    }
    for (auto& table : root.list("plane")) {
      ProbePlane p;
      p.name = table.text("name", "a name");
      p.corner = table.vector("corner");
      p.along = table.vector("along");
      p.across = table.vector("across");
      const auto points = table.numbers("points", 2);
      for (const double n : points)
        if (!(n >= 2 && n <= 10000 && n == std::floor(n))) table.refuse("points", "two integers between 2 and 10000");
      p.n_along = static_cast<std::int64_t>(points[0]);
      p.n_across = static_cast<std::int64_t>(points[1]);
      table.done();
      case_.plane.push_back(p);
    }
  }

  void read_reference(TomlTable& table) {
    auto& r = case_.reference;
    r.area = table.number("area", 0, infinity, true);
    r.length = table.number_or("length", 1, 0, infinity, true);
    if (table.has("point")) r.point = table.vector("point");
    if (table.has("pitch_axis")) r.pitch_axis = table.vector("pitch_axis");
    const double length = norm(r.pitch_axis);
    if (!(length > 0)) table.refuse("pitch_axis", "a direction");
    r.pitch_axis = (1 / length) * r.pitch_axis;
    r.multiplier = table.number_or("multiplier", 1, 0, infinity, true);
    if (table.has("patches")) r.patches = table.texts("patches");
    for (const auto& patch : r.patches)
      if (!case_.boundary.contains(patch) || !case_.boundary[patch].is_wall())
        throw Error(
            fmt::format("{}: expected patches with a wall in [reference], found \"{}\"", table.at("patches"), patch));
    table.done();
  }

  Case case_;
  std::map<std::string, Species> known_;
};

}  // namespace

Case read_case(std::string_view text, const std::string& where) {
  try {
    return Reader(where).read(toml::parse(text, where));
  } catch (const toml::parse_error& error) {
    throw Error(fmt::format("{}:{}: expected TOML, found {}", where, error.source().begin.line, error.description()));
  }
}

}  // namespace pamr::dsmc
