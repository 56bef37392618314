// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/same_case.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "solvers/dsmc/run/advance.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace same_case_test {

using namespace pamr;
using namespace pamr::dsmc;
using nlohmann::json;

const std::string base = R"(
[species.N2]
mass = 4.65e-26
diameter = 4.17e-10
omega = 0.74
t_ref = 273.0
rotational_degrees = 2
[species.Xe]
mass = 2.18e-25
diameter = 5.74e-10
omega = 0.85
t_ref = 273.0
alpha = 1.4
[gas]
fractions = { N2 = 0.9, Xe = 0.1 }
[gas.rotation]
z_infinity = 18.1
t_star = 91.5
[stream.free]
density = 1e20
temperature = 300.0
rotational_temperature = 310.0
speed = 600.0
fractions = { N2 = 0.8, Xe = 0.2 }
[stream.puff]
density = 1e21
temperature = 320.0
[boundary]
xmin = { kind = "inflow" }
xmax = { kind = "specular" }
ymin = { kind = "symmetry" }
ymax = { kind = "cll", temperature = 400.0, normal_accommodation = 0.5, tangential_accommodation = 0.9, rotational_accommodation = 0.7 }
zmin = { kind = "maxwell", temperature = 500.0, accommodation = 0.6 }
zmax = { kind = "outflow" }
[initial]
stream = "free"
[[initial.region]]
sphere = [0.2, 0.2, 0.2, 0.3]
stream = "puff"
[[initial.region]]
box = [0.0, 0.0, 0.0, 0.1, 0.1, 0.1]
stream = "puff"
[collisions]
partner = "any"
[particles]
weight = 8e16
species_weights = { Xe = 0.5 }
[domain]
unit = 1.0
[time]
step = 5e-5
[run]
seed = 7
transient = 30
sampling = 60
block = 5
[reference]
area = 1.0
length = 2.0
point = [0.0, 0.0, 0.1]
[[plane]]
name = "p"
point = [0.5, 0.25, 0.5]
normal = [1.0, 0.0, 0.0]
radius = 0.4
[[plane]]
name = "section"
corner = [0.0, 0.0, 0.25]
along = [1.0, 0.0, 0.0]
across = [0.0, 0.75, 0.0]
)";

const std::string adapting = R"(
[adapt]
mark = "--size-over n_scale --ratio 0.1 --coarsen-below 0.08 --max-level 2"
every = 20
max_cells = 900
)";

std::string changed(std::string text, const std::string& old, const std::string& now) {
  const auto place = text.find(old);
  EXPECT_NE(place, std::string::npos) << old;
  return place == std::string::npos ? text : text.replace(place, old.size(), now);
}

class SameCase : public testing::Test {
 protected:
  json facts(const std::string& text) const {
    const auto c = read_case(text, "case.toml");
    return facts_of(comm_, c, make_setup(comm_, c, mesh_), mesh_);
  }
  /// The error of going on with `now` from a checkpoint of `before`; empty: it is accepted.
  std::string refusal(const std::string& before, const std::string& now) const {
    return refusal(json{{facts_member, facts(before)}}, facts(now));
  }
  static std::string refusal(const json& header, const json& facts) {
    try {
      require_same_case(header, facts);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  const par::Comm comm_{MPI_COMM_WORLD};
  const mesh::DistMesh mesh_ = assemble::assemble(comm_, test::kuhn_cube(comm_, 2));
};

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto place = text.find(part); place != std::string::npos; place = text.find(part, place + 1)) ++n;
  return n;
}

struct Change {
  std::string old, now, name;
  std::size_t n = 1;  ///< facts that differ
};
const std::vector<Change> changes{
    {"mass = 4.65e-26", "mass = 4.66e-26", "species.N2.mass"},
    {"diameter = 4.17e-10", "diameter = 4.18e-10", "species.N2.diameter"},
    {"omega = 0.74", "omega = 0.75", "species.N2.omega"},
    {"t_ref = 273.0", "t_ref = 274.0", "species.N2.t_ref"},
    {"rotational_degrees = 2", "rotational_degrees = 3", "species.N2.rotational_degrees"},
    {"alpha = 1.4", "alpha = 1.3", "species.Xe.alpha"},
    {"{ N2 = 0.9, Xe = 0.1 }", "{ N2 = 0.8, Xe = 0.2 }", "gas.fractions.N2", 4},  // and of the stream puff
    {"z_infinity = 18.1", "z_infinity = 18.2", "gas.rotation.z_infinity"},
    {"t_star = 91.5", "t_star = 91.6", "gas.rotation.t_star"},
    {"z_infinity = 18.1\nt_star = 91.5", "probability = 0.2", "gas.rotation.probability", 3},
    {"z_infinity = 18.1\nt_star = 91.5", "z_continuum = 5.0", "gas.rotation.z_continuum", 3},
    {"density = 1e20", "density = 2e20", "stream.free.density"},
    {"temperature = 300.0", "temperature = 301.0", "stream.free.temperature"},
    {"rotational_temperature = 310.0", "rotational_temperature = 311.0", "stream.free.rotational_temperature"},
    {"speed = 600.0", "speed = 601.0", "stream.free.velocity"},
    {"{ N2 = 0.8, Xe = 0.2 }", "{ N2 = 0.7, Xe = 0.3 }", "stream.free.fractions.Xe", 2},
    {"temperature = 320.0", "temperature = 321.0\nrotational_temperature = 320.0", "stream.puff.temperature"},
    {"[stream.puff]", "[stream.more]\ndensity = 1e20\ntemperature = 300.0\n[stream.puff]", "stream.more"},
    {"xmin = { kind = \"inflow\" }", "xmin = { kind = \"inflow\", stream = \"puff\" }", "boundary.xmin.stream"},
    {"kind = \"specular\"", "kind = \"symmetry\"", "boundary.xmax.kind", 2},  // and no wall of the body
    {"kind = \"outflow\"", "kind = \"specular\"", "boundary.zmax.kind", 2},
    {"ymin = { kind = \"symmetry\" }\n", "\"ymi*\" = { kind = \"outflow\" }\n", "boundary.ymin.kind"},
    {"temperature = 400.0", "temperature = 401.0", "boundary.ymax.temperature"},
    {"temperature = 400.0", "temperature = 400.0, velocity = [1.0, 0.0, 0.0]", "boundary.ymax.velocity"},
    {"normal_accommodation = 0.5", "normal_accommodation = 0.6", "boundary.ymax.normal_accommodation"},
    {"tangential_accommodation = 0.9", "tangential_accommodation = 0.8", "boundary.ymax.tangential_accommodation"},
    {"rotational_accommodation = 0.7", "rotational_accommodation = 0.6", "boundary.ymax.rotational_accommodation"},
    {"temperature = 500.0", "temperature = 501.0", "boundary.zmin.temperature"},
    {"temperature = 500.0", "temperature = 500.0, velocity = [0.0, 2.0, 0.0]", "boundary.zmin.velocity"},
    {" accommodation = 0.6", " accommodation = 0.5", "boundary.zmin.accommodation"},
    {"[initial]\nstream = \"free\"", "[initial]\nstream = \"vacuum\"", "initial.stream"},
    {"0.2, 0.3]", "0.2, 0.4]", "initial.region"},
    {"box = [0.0, ", "box = [0.01, ", "initial.region"},
    {"partner = \"any\"", "partner = \"subcell\"", "collisions.partner"},
    {"partner = \"any\"", "partner = \"any\"\nenabled = false", "collisions.enabled"},
    {"weight = 8e16", "weight = 2e16", "particles.weight"},
    {"weight = 8e16", "total = 500.0", "particles.weight"},
    {"{ Xe = 0.5 }", "{ Xe = 0.4 }", "particles.species_weights.Xe"},
    {"unit = 1.0", "unit = 2.0", "domain.unit"},
    {"step = 5e-5", "step = 4e-5", "time.step"},
    {"step = 5e-5", "step = 5e-5\ncell_fraction = 0.4", "time.cell_fraction", 2},  // and the cells' steps
    {"step = 5e-5", "step = 5e-5\ncollision_fraction = 0.4", "time.collision_fraction", 2},
    {"seed = 7", "seed = 8", "run.seed"},
    {"transient = 30", "transient = 31", "run.transient"},
    {"transient = 30\n", "", "run.transient"},
    {"transient = 30", "transient = 30\nwindow = 20", "run.window"},
    {"area = 1.0", "area = 1.5", "reference.area"},
    {"length = 2.0", "length = 2.5", "reference.length"},
    {"point = [0.0, ", "point = [0.1, ", "reference.point"},
    {"area = 1.0", "area = 1.0\npitch_axis = [1.0, 1.0, 0.0]", "reference.pitch_axis"},
    {"area = 1.0", "area = 1.0\nmultiplier = 2.0", "reference.multiplier"},
    {"area = 1.0", "area = 1.0\npatches = [\"zmin\"]", "reference.patches"},
    {"point = [0.5, 0.25", "point = [0.5, 0.35", "plane.p.point"},
    {"normal = [1.0, 0.0", "normal = [1.0, 0.1", "plane.p.normal"},
    {"radius = 0.4", "radius = 0.3", "plane.p.radius"},
    {"along = [1.0, ", "along = [0.5, ", "plane.section.along"},
    {"across = [0.0, 0.75", "across = [0.0, 0.5", "plane.section.across"},
};

TEST_F(SameCase, NamesEveryMemberThatDiffers) {
  std::set<std::string> named;
  for (const auto& change : changes) {
    const auto error = refusal(base, changed(base, change.old, change.now));
    const auto line = change.name + ": the checkpoint has ";
    EXPECT_NE(error.find(line), std::string::npos) << change.name << " in: " << error;
    EXPECT_EQ(count(error, ": the checkpoint has "), change.n) << error;
    EXPECT_NE(error.find("; --carry begins a new run with this flow"), std::string::npos) << error;
    named.insert(change.name);
  }

  // Whatever the facts of this case are, a line above has changed it, or its like of another species, stream or wall.
  const std::set<std::string> never{"time.from_fields", "time.steps of the cells (a hash)"};  // below
  const auto flat = facts(base).flatten();
  for (const auto& [pointer, value] : flat.items()) {
    auto name = pointer.substr(1);
    for (auto& c : name) c = c == '/' ? '.' : c;
    if (name.find_last_not_of("0123456789") == name.rfind('.')) name.resize(name.rfind('.'));  // a part of a vector
    const auto last = name.substr(name.rfind('.') + 1);
    bool is_named = never.count(name) > 0 || name == "adapt";
    for (const auto& one : named)
      is_named = is_named || name.rfind(one, 0) == 0 || one.substr(one.rfind('.') + 1) == last ||
                 (one.find("fractions.") != std::string::npos && name.find("fractions.") != std::string::npos) ||
                 (one.find("weights.") != std::string::npos && name.find("weights.") != std::string::npos);
    EXPECT_TRUE(is_named) << name;
  }
}

TEST_F(SameCase, NamesTheDifferencesOfRunsThatWaitForASteadyFlowAdaptOrArePeriodic) {
  const auto steady = changed(base, "transient = 30", "most_transient = 500");
  EXPECT_EQ(refusal(steady, changed(steady, "most_transient = 500", "most_transient = 600")), "");

  const auto follows = changed(changed(base, "transient = 30\n", ""), "block = 5", "window = 20\nblock = 5") + adapting;
  for (const auto& [old, now, name] :
       std::vector<std::array<std::string, 3>>{{"--ratio 0.1", "--ratio 0.2", "adapt.mark"},
                                               {"every = 20", "every = 40", "adapt.every"},
                                               {"max_cells = 900", "max_cells = 800", "adapt.max_cells"},
                                               {"max_cells = 900\n", "", "adapt.max_cells"},
                                               {"weight = 8e16", "weight = 2e16", "particles.weight"},
                                               {"weight = 8e16", "per_cell = 9.0", "particles.per_cell"},
                                               {"weight = 8e16", "total = 9000.0", "particles.total"}})
    EXPECT_NE(refusal(follows, changed(follows, old, now)).find(name + ": the checkpoint has "), std::string::npos)
        << name;
  EXPECT_NE(refusal(follows, changed(follows, adapting, "")).find("adapt.mark: the checkpoint has \"--size-over"),
            std::string::npos);

  // The weight of the mesh that the run was given is not that of the mesh that it goes on with.
  const auto c = read_case(changed(follows, "weight = 8e16", "per_cell = 9.0"), "case.toml");
  EXPECT_EQ(refusal({{facts_member, facts_of(comm_, c, make_setup(comm_, c, mesh_), mesh_)}},
                    facts_of(comm_, c, make_setup(comm_, c, mesh_, 1e15), mesh_)),
            "");

  const auto driven = changed(changed(base, "kind = \"inflow\"", "kind = \"inlet\", mass_flow = 1e-3"),
                              "kind = \"outflow\"", "kind = \"outlet\", pressure = 2.0");
  for (const auto& [old, now, name] :
       std::vector<std::array<std::string, 3>>{{"mass_flow = 1e-3", "mass_flow = 2e-3", "boundary.xmin.mass_flow"},
                                               {"= 1e-3", "= 1e-3, stream = \"puff\"", "boundary.xmin.stream"},
                                               {"= 1e-3", "= 1e-3, relaxation = 7", "boundary.xmin.relaxation"},
                                               {"pressure = 2.0", "pressure = 3.0", "boundary.zmax.pressure"},
                                               {"= 2.0 }", "= 2.0, relaxation = 7 }", "boundary.zmax.relaxation"}})
    EXPECT_NE(refusal(driven, changed(driven, old, now)).find(name + ": the checkpoint has "), std::string::npos)
        << name;

  const std::string modes = "[species.N2.vibration]\ntemperatures = [3371.0]\nc1 = 9.1\nc2 = 220.0\n";
  const auto vibrating =
      changed(changed(changed(base, "[gas]\n", "[gas]\nvibration = true\n"), "[species.Xe]", modes + "[species.Xe]"),
              "rotational_temperature = 310.0", "rotational_temperature = 310.0\nvibrational_temperature = 900.0");
  for (const auto& [old, now, name] : std::vector<std::array<std::string, 3>>{
           {"3371.0", "3300.0", "species.N2.vibration.temperatures"},
           {"c1 = 9.1", "c1 = 9.2", "species.N2.vibration.c1"},
           {"c2 = 220.0", "c2 = 221.0", "species.N2.vibration.c2"},
           {"c2 = 220.0", "c2 = 220.0\ncross_section = 3e-21", "species.N2.vibration.cross_section"},
           {"= 900.0", "= 800.0", "stream.free.vibrational_temperature"},
           {"_accommodation = 0.7", "_accommodation = 0.7, vibrational_accommodation = 0.1",
            "boundary.ymax.vibrational_accommodation"},
           {"vibration = true\n", "vibration = true\n", ""}})
    EXPECT_TRUE(name.empty() ? refusal(vibrating, vibrating).empty()
                             : refusal(vibrating, changed(vibrating, old, now)).find(name + ": the checkpoint has ") !=
                                   std::string::npos)
        << name;

  const auto inflow = changed(base, "xmax = { kind = \"specular\" }", "xmax = { kind = \"inflow\" }");
  const auto periodic =
      changed(changed(inflow, "xmin = { kind = \"inflow\" }", "xmin = { kind = \"periodic\", partner = \"xmax\" }"),
              "xmax = { kind = \"inflow\" }", "xmax = { kind = \"periodic\", partner = \"xmin\" }");
  EXPECT_NE(refusal(inflow, periodic).find("boundary.xmax.partner: the checkpoint has nothing, the case \"xmin\""),
            std::string::npos);
}

TEST_F(SameCase, NamesTheStepsOfCellsThatFollowFromOtherFields) {
  const auto text = changed(base, "step = 5e-5", "step = 5e-5\ncollision_fraction = 0.3\nfrom_fields = true");
  const auto c = read_case(text, "case.toml");
  const auto with = [&](double tau) {
    auto mesh = mesh_;
    const auto n = at(mesh.n_cells());
    mesh.cell_fields.push_back({"n", "1/m3", 1, mesh::StorageType::float64, std::vector<double>(n, 1e20)});
    mesh.cell_fields.push_back({"u", "m/s", 3, mesh::StorageType::float64, std::vector<double>(3 * n, 100)});
    mesh.cell_fields.push_back({"T_tr", "K", 1, mesh::StorageType::float64, std::vector<double>(n, 300)});
    mesh.cell_fields.push_back({"tau_c", "s", 1, mesh::StorageType::float64, std::vector<double>(n, 5e-5)});
    if (mesh.cell_global.back() - mesh.info.first_id + 1 == mesh.info.n_global_cells)
      mesh.cell_fields.back().real().back() = tau;
    return facts_of(comm_, c, make_setup(comm_, c, mesh), mesh);
  };
  const json header{{facts_member, with(5e-5)}};
  EXPECT_EQ(refusal(header, with(5e-5)), "");
  EXPECT_NE(refusal(header, with(4e-5)).find("time.steps of the cells (a hash): the checkpoint has "),
            std::string::npos);
}

TEST_F(SameCase, TakesOtherWordsForTheSameCase) {
  EXPECT_EQ(refusal(base, base), "");
  const auto accepted = [&](const std::string& old, const std::string& now) {
    EXPECT_EQ(refusal(base, changed(base, old, now)), "") << now;
  };
  accepted("speed = 600.0", "velocity = [600.0, 0.0, 0.0]");
  accepted("ymin = { kind", "\"ymi*\" = { kind");
  accepted("area = 1.0", "area = 1.0\npatches = [\"xmax\", \"ymax\", \"zmin\"]");
  accepted("sampling = 60", "sampling = 90");
  accepted("block = 5", "stop_error = 0.01");
  accepted("transient = 30", "transient = 30\nmost_transient = 5");  // not used beside transient
  EXPECT_EQ(refusal(base, base + "[[station]]\nname = \"s\"\nx = 0.5\nr = 0.4\nhalf_width = 0.2\n"), "");
  EXPECT_EQ(refusal(base, base + "[[line]]\nname = \"l\"\nfrom = [0.1, 0.3, 0.2]\n"), "");
}

TEST_F(SameCase, IsAskedForByACheckpointWithoutFactsAndOneThatIsDamaged) {
  EXPECT_NE(refusal(json::object(), facts(base)).find("an earlier version has written it; --carry"), std::string::npos);
  EXPECT_NE(refusal(json{{facts_member, 3}}, facts(base)), "");
  EXPECT_NE(refusal(json{{facts_member, nullptr}}, facts(base)), "");
  const auto many = refusal(json{{facts_member, json::object()}}, facts(base));
  EXPECT_NE(many.find(" more; --carry"), std::string::npos) << many;
}

/// Header and tables of a snapshot of one rank's blocks.
std::string bytes_of(const Snapshot& snapshot) {
  auto text = snapshot.header.dump();
  for (const auto* section : {&snapshot.cells, &snapshot.faces, &snapshot.particles})
    text.append(reinterpret_cast<const char*>(section->block.data()), 8 * section->block.size());
  return text;
}

TEST_F(SameCase, GoesOnWithTheSameBitsWhatEverMayChangeAndIsRefusedOtherwiseBeforeAnythingIsRead) {
  std::string file;
  if (comm_.is_first())
    file = std::filesystem::temp_directory_path() / ("pamr_same_case_" + std::to_string(::getpid()) + ".ck");
  file = comm_.broadcast(file);
  const auto begin = [&](const std::string& text) {
    return test::unfilled(comm_, read_case(text, "case.toml"), mesh_);
  };
  auto whole = begin(base), part = begin(base);
  whole->fill();
  part->fill();
  advance(*whole, {50, "", 0}, {});
  advance(*part, {40, file, 0}, {});
  for (const auto& text :
       {changed(base, "sampling = 60", "sampling = 500"), changed(base, "block = 5", "block = 5\nstop_error = 1e-9"),
        base + "[[line]]\nname = \"l\"\nfrom = [0.1, 0.3, 0.2]\n"}) {
    auto rest = begin(text);
    rest->restart(file);
    advance(*rest, {50, "", 0}, {});
    EXPECT_EQ(bytes_of(rest->snapshot()), bytes_of(whole->snapshot()));
  }

  const char* const argon = "[species.Ar]\nmass = 6.63e-26\ndiameter = 4.11e-10\nomega = 0.81\nt_ref = 273.0\n[gas]\n";
  for (const auto& [old, now, name] : std::vector<std::array<std::string, 3>>{
           {"temperature = 500.0", "temperature = 400.0",
            "boundary.zmin.temperature: the checkpoint has 500.0, the case 400.0"},
           {"seed = 7", "seed = 8", "run.seed: the checkpoint has 7, the case 8"},
           {"{ N2 = 0.9, Xe = 0.1 }", "{ N2 = 0.9, Xe = 0.1, Ar = 0.0 }", "species.Ar"}}) {
    const auto text = changed(changed(base, old, now), "[gas]\n", argon);
    auto rest = begin(text);
    try {
      rest->restart(file);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
    }
    EXPECT_EQ(rest->flow().steps_done, 0U);
  }
  comm_.barrier();
  if (comm_.is_first()) std::filesystem::remove(file);
}

}  // namespace same_case_test
