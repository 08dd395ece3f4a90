// SPDX-License-Identifier: Apache-2.0
// What no scheme takes: options out of their ranges, named with their values; a start in overlap.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "geometry/settings.hpp"
#include "integrators/run.hpp"
#include "integrators/scheme.hpp"
#include "reduction/mean_contacts.hpp"
#include "reduction/normal_clusters.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

/// Sets the number at one path, and keeps what the table says of all of them.
class Put final : public SettingVisitor {
 public:
  Put(std::string where, double what) : where_(std::move(where)), what_(what) {}
  void number(const Setting& setting, double& value) override { see(setting, value, true); }
  void count(const Setting& setting, int& value) override { see(setting, value, false); }
  void toggle(const Setting&, bool&) override {}
  void seed(const Setting&, std::uint64_t&) override {}

  struct Seen {
    std::string path{}, field{};
    Range range{};
    bool real = false;
  };
  std::vector<Seen> all{};

 private:
  void choose(const Setting&, Choice&) override {}
  template <class Value>
  void see(const Setting& setting, Value& value, bool real) {
    all.push_back({path(setting), field(setting), setting.range, real});
    if (path(setting) == where_) value = Value(what_);
  }
  std::string where_;
  double what_;
};

std::vector<Put::Seen> all_numbers() {
  SchemeOptions options;
  Put put("", 0);
  describe(put, options);
  return put.all;
}

// Refused by every scheme that reads it, by the name of its struct. Returns by how many.
int expect_refused(const Model& model, const Put::Seen& number, double value) {
  SchemeOptions options;
  Put put(number.path, value);
  describe(put, options);
  int refusals = 0;
  for (const std::string& name : scheme_names()) {
    const std::vector<std::string> unread = unread_by(name);
    if (std::ranges::find(unread, number.path) != unread.end()) continue;
    const std::string message = message_of([&] { make_scheme(name, model, options); });
    EXPECT_EQ(message.find(number.field + " = " + number_text(value) + " must "), 0u)
        << name << ", " << number.path << " = " << value << ": " << message;
    ++refusals;
  }
  return refusals;
}

// Values next to the ends of every range, and those that no range holds.
TEST(SchemeOptions, AreRefusedOutOfTheirRangesByEverySchemeThatReadsThem) {
  const Scene s = block_on_plate(0.3, 0, 0);
  int refusals = 0;
  for (const Put::Seen& number : all_numbers()) {
    const Range& range = number.range;
    std::vector<double> bad;
    if (number.real) bad.push_back(kNan);
    if (std::isfinite(range.lowest))
      bad.push_back(range.open_below ? range.lowest
                    : number.real    ? std::nextafter(range.lowest, -kInf)
                                     : range.lowest - 1);
    if (std::isfinite(range.highest))
      bad.push_back(range.open_above ? range.highest
                    : number.real    ? std::nextafter(range.highest, kInf)
                                     : range.highest + 1);
    else if (range.open_above)
      bad.push_back(kInf);
    for (const double value : bad) refusals += expect_refused(s.model, number, value);
  }
  EXPECT_GT(refusals, 500);
}

// The ends themselves, or what lies next to open ones.
TEST(SchemeOptions, AreAcceptedUpToTheEndsOfTheirRanges) {
  int accepted = 0;
  for (const Put::Seen& number : all_numbers()) {
    const Range& range = number.range;
    for (const bool below : {true, false}) {
      const double end = below ? range.lowest : range.highest;
      const bool open = below ? range.open_below : range.open_above;
      if (!std::isfinite(end)) continue;
      const double value = !open         ? end
                           : number.real ? std::nextafter(end, below ? kInf : -kInf)
                                         : end + (below ? 1 : -1);
      SchemeOptions options;
      Put put(number.path, value);
      describe(put, options);
      EXPECT_EQ(message_of([&] { check_ranges(options); }), "") << number.path << " = " << value;
      ++accepted;
    }
  }
  EXPECT_GT(accepted, 80);
}

// A scheme that does not read an option says so where the option is set, and its flag is refused there.
TEST(SchemeOptions, AreRefusedWhereASchemeDoesNotReadThem) {
  const Scene s = block_on_plate(0.3, 0, 0);
  const auto refusal = [&](const char* scheme, const StepOptions& step) {
    return message_of([&] { make_scheme(scheme, s.model, {.step = step}); });
  };
  for (const char* scheme :
       {"schatzman_paoli", "passive_midpoint", "generalised_alpha", "d1_minus_linear", "event_driven"})
    EXPECT_EQ(refusal(scheme, {.persistence = {.anchors = true}}),
              std::string("persistence.anchors = true is not read by ") + scheme);
  EXPECT_EQ(refusal("event_driven", {.update = GroupUpdate::cayley}),
            "update = cayley is not read by event_driven");
  EXPECT_EQ(refusal("event_driven", {.reduction = {.min_margin = 0.2}}),
            "reduction.min_margin = 0.2 is not read by event_driven");
  EXPECT_EQ(refusal("event_driven", {.solver = {.tolerance = 1e-6}}), "");  // comparisons set it for all
  EXPECT_EQ(message_of([&] { EventDriven(s.model, {.solver = {.tolerance = 1e-6}}); }),
            "solver.tolerance = 1e-06 is not read by event_driven");
  EXPECT_EQ(refusal("moreau_jean_projected", {.correction_speed = 0.1}),
            "correction_speed = 0.1 is not read by moreau_jean_projected");
  EXPECT_EQ(refusal("schatzman_paoli", {.touching = 1e-7}),
            "touching = 1e-07 is not read by schatzman_paoli");
  EXPECT_EQ(refusal("moreau_jean", {.touching = 1e-7}),
            "touching = 1e-07 is not read by normal law combined");
  EXPECT_EQ(refusal("passive_midpoint", {.touching = 1e-7}),
            "touching = 1e-07 is not read by normal law combined");
  EXPECT_EQ(message_of([&] { MoreauJean(s.model, {.correction_speed = 0.1}, {.law = NormalLaw::moreau}); }),
            "correction_speed = 0.1 is not read by normal law moreau");
  EXPECT_EQ(refusal("generalised_alpha", {.joints = {.stabilisation = 0.3}}),
            "joints.stabilisation = 0.3 is not read by generalised_alpha");
  const std::vector<std::string> unread = unread_by("schatzman_paoli");
  const auto has = [&](const char* path) { return std::ranges::find(unread, path) != unread.end(); };
  EXPECT_TRUE(has("step.update") && has("moreau_jean.theta"));
  EXPECT_FALSE(has("step.h") || has("schatzman_paoli.force_theta"));
}

// What the tables say of readers: each is a value of the choice that decides.
class ReaderNames final : public SettingVisitor {
 public:
  void number(const Setting& setting, double&) override { see(setting); }
  void count(const Setting& setting, int&) override { see(setting); }
  void toggle(const Setting& setting, bool&) override { see(setting); }
  void seed(const Setting& setting, std::uint64_t&) override { see(setting); }
  int seen = 0;

 private:
  void choose(const Setting& setting, Choice& value) override {
    see(setting);
    names_[setting.name] = value.names();
  }
  void see(const Setting& setting) {
    const std::optional<Readers> readers = readers_of(setting);
    if (!readers) return;
    std::stringstream list{std::string(readers->values)};
    const std::vector<std::string>& known = names_[readers->choice.name];
    for (std::string name; std::getline(list >> std::ws, name, ',');) {
      EXPECT_TRUE(std::ranges::find(known, name) != known.end()) << path(setting) << ": " << name;
      ++seen;
    }
  }
  std::map<std::string, std::vector<std::string>> names_{};  // of the last choice that was called so
};
template <class Options>
int reader_names(Options options = {}) {
  ReaderNames names;
  describe(names, options);
  return names.seen;
}
TEST(SchemeOptions, NameReadersThatExist) {
  EXPECT_GE(reader_names<SchemeOptions>(), 35);
  EXPECT_GE(reader_names<NormalClusterOptions>(), 5);
  EXPECT_GE(reader_names<MeanContactOptions>(), 3);
}

TEST(SchemeOptions, AreRefusedWhereSolverReducerOrMatchingDoNotReadThem) {
  const Scene s = block_on_plate(0.3, 0, 0);
  const auto refusal = [&](const StepOptions& step) {
    return message_of([&] { make_scheme("moreau_jean", s.model, {.step = step}); });
  };
  EXPECT_EQ(refusal({.solver = {.method = Method::sor_prox, .prox = ProxMetric::split}}), "");
  EXPECT_EQ(refusal({.solver = {.prox = ProxMetric::split}}),
            "SolverOptions::prox = split is not read by auto, only by sor_prox, jor_prox");
  EXPECT_EQ(refusal({.reduction = {.corners = 5}}),
            "ReductionOptions::corners = 5 is not read by hull_margin, only by hull_area_loss");
  EXPECT_EQ(refusal({.reduction = {.reducer = Reducer::direction_set, .hull_margin = {.margin = 0.5}}}),
            "HullMargin::margin = 0.5 is not read by direction_set, only by hull_margin");
  EXPECT_EQ(refusal({.reduction = {.clustering = {.cube = {.cells = 2}}}}),
            "CubeMapOptions::cells = 2 is not read by angle, only by cube_map");
  EXPECT_EQ(refusal({.reduction = {.reducer = Reducer::none, .min_margin = 0.5}}),
            "ReductionOptions::min_margin = 0.5 is not read by none");
  EXPECT_EQ(
      refusal({.reduction = {.clustering = {.rule = Clustering::normals, .angle = 0.2}}}),
      "ClusteringOptions::angle = 0.2 is not read by normals, only by angle and by friction at patches");
  EXPECT_EQ(refusal({.reduction = {.clustering = {.rule = Clustering::normals, .angle = 0.2},
                                   .friction = FrictionAt::patches}}),
            "");
  EXPECT_EQ(refusal({.persistence = {.anchor_rate = 0.5}}),
            "PersistenceOptions::anchor_rate, anchor_speed and slip_speed need anchors");
  EXPECT_EQ(refusal({.persistence = {.matching = Matching::key, .max_turn = 0.2}}),
            "PersistenceOptions::max_turn = 0.2 is not read by key, only by cascade");
}

// Choices that do not go together.
TEST(SchemeOptions, AreRefusedWhereTheyContradictEachOther) {
  const Scene s = block_on_plate(0.3, 0, 0);
  const ContactSelector all = [](const ReductionInput&, const Clusters&) { return std::vector<int>{}; };
  for (const std::string& name : scheme_names())
    for (const ReductionOptions& bad :
         {ReductionOptions{.reducer = Reducer::hull_margin, .paper_exact = true},
          ReductionOptions{.reducer = Reducer::selector},
          ReductionOptions{.reducer = Reducer::hull_margin, .selector = all}})
      EXPECT_THROW(make_scheme(name, s.model, {.step = {.reduction = bad}}), std::invalid_argument) << name;
  for (const MoreauJeanOptions& loop :
       {MoreauJeanOptions{.newton = {.gap_hessians = true}},
        MoreauJeanOptions{.contacts = ContactsAt::midpoint, .newton = {.gap_hessians = true}},
        MoreauJeanOptions{.newton = {.max_iterations = 9, .gap_hessians = true}}})
    EXPECT_NE(message_of([&] { MoreauJean(s.model, {}, loop); }).find("NewtonOptions::gap_hessians needs"),
              std::string::npos);
  EXPECT_NE(message_of([&] {
              MoreauJean(s.model, {}, {.newton = {.tolerance = 1e-8}});
            }).find("NewtonOptions::tolerance = 1e-08 needs"),
            std::string::npos);
  SchemeOptions pulled{.step = {.reduction = {.friction = FrictionAt::patches}}};
  pulled.step.persistence.anchors = true;
  EXPECT_NE(message_of([&] { make_scheme("moreau_jean", s.model, pulled); }).find("anchors"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              make_scheme("event_driven", s.model,
                          {.step = {.reduction = {.friction = FrictionAt::patches}}});
            }).find("event_driven"),
            std::string::npos);
}

// The door of a step tells the least distance of the bodies that overlap most, as the door of a run does: not
// that of the first pair, nor that of simplices on which the certificate stumbled. An edge of the second
// block is 0.4 mm above the plate.
TEST(EveryScheme, RefusesToBeginInOverlapAndKeepsTheState) {
  Scene s = block_on_plate(0.3, 0, 0);
  const auto tilted = add(s.model, s.model.bodies[s.block]);
  const SE3 plain = pose(s.state, s.block);
  s.state = rest_state(s.model);
  pose(s.state, s.block) = translation(0, 0, -0.3 * kRadius) * plain;
  pose(s.state, tilted) =
      translation(0.5, 0, kSide / 2 * (std::cos(0.3) + std::sin(0.3)) + 4e-4) * rotation(Vec3::UnitY(), 0.3);
  const std::string begin = "bodies 0 (ground) and 2 (block): base distance = ";
  const std::uint64_t before = hash(s.state);
  std::vector<std::string> told{message_of([&] { validate_start(s.model, s.state); })};
  for (const std::string& name : scheme_names()) {
    const StepReport report = make_scheme(name, s.model, {}).step(s.state, kInf);
    EXPECT_EQ(report.status, StepStatus::refused) << name;
    EXPECT_EQ(hash(s.state), before) << name;
    told.push_back(report.reason);
  }
  for (const std::string& text : told) {
    const std::size_t at = text.find(begin);
    ASSERT_NE(at, std::string::npos) << text;
    EXPECT_NEAR(std::stod(text.substr(at + begin.size())), 4e-4, 1e-12) << text;
    EXPECT_NE(text.find(" must be at least 0.00192 [m]"), std::string::npos) << text;
  }
}

TEST(EveryScheme, RefusesStepsOfNoLength) {
  const Scene s = block_on_plate(0.3, 0, 0);
  for (const std::string& name : scheme_names())
    for (const double limit : {0.0, -1.0, kNan}) {
      State state = s.state;
      const Scheme scheme = make_scheme(name, s.model, {});
      EXPECT_EQ(message_of([&] { scheme.step(state, limit); }),
                "h_limit = " + number_text(limit) + " must be positive [s]")
          << name;
    }
}

// What `add` would not have taken is not taken by a scheme either.
TEST(EveryScheme, RefusesABadModel) {
  for (const std::string& name : scheme_names()) {
    Model massless = block_on_plate(0.3, 0, 0).model;
    massless.bodies[1].mass = -1;
    EXPECT_NE(message_of([&] { make_scheme(name, massless, {}); }).find("mass = -1 must be positive"),
              std::string::npos)
        << name;
    Model flat = block_on_plate(0.3, 0, 0).model;
    flat.bodies[1].inertia = -Mat3::Identity();
    EXPECT_NE(message_of([&] { make_scheme(name, flat, {}); }).find("inertia"), std::string::npos) << name;
    Model loose = block_on_plate(0.3, 0, 0).model;
    loose.joints.push_back({.name = "nowhere", .kind = JointKind::revolute, .body_a = 1, .body_b = 7});
    EXPECT_NE(message_of([&] { make_scheme(name, loose, {}); }).find("body_b = 7 must "), std::string::npos)
        << name;
    Model drilled = block_on_plate(0.3, 0, 0).model;
    drilled.contact_law.contensou_radius = -1e-3;
    EXPECT_NE(message_of([&] {
                make_scheme(name, drilled, {});
              }).find("contact_law.contensou_radius = -0.001 must be finite and >= 0"),
              std::string::npos)
        << name;
  }
}

}  // namespace
}  // namespace aussois
