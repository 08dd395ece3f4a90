// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "examples/common/kept_json.hpp"
#include "examples/drivers/assembly/assembly_input.hpp"
#include "examples/drivers/assembly/lay_cables.hpp"
#include "examples/drivers/station/hand_script.hpp"
#include "examples/scenes/shared_series.hpp"
#include "examples/studies/convergence/slid_level.hpp"
#include "examples/studies/convergence/study_files.hpp"
#include "examples/studies/friction/profile_result.hpp"
#include "examples/studies/peg_plate/study_files.hpp"
#include "examples/studies/toss/toss_kept.hpp"
#include "examples/studies/toss/toss_report.hpp"
#include "examples/studies/verification/list.hpp"
#include "tests/fuzz/readers.hpp"

namespace aussois {
namespace {

namespace fs = std::filesystem;

// As the folder of a user has it.
void make_pairs(const fs::path& file, Bytes input) {
  const fs::path folder = file.parent_path();
  fs::create_directories(folder / "assembly");
  fs::create_directories(folder / "meshes");
  for (const char* part : {"socket", "peg"})
    std::ofstream(folder / "meshes" / (std::string(part) + ".obj"))
        << "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  std::ofstream(folder / "assembly" / "peg.csv") << "x,y,z,qw,qx,qy,qz\n0,0,20,1,0,0,0\n0,0,21,1,0,0,0\n";
  write_input(folder / "assembly" / "pairs.csv", input);
}

void use_pairs(const fs::path& file) {
  try {
    read_assembly_pair(file.parent_path(), "peg", 1e-3);
  } catch (const std::invalid_argument&) {  // no pair of that name
  }
}

void report_on(const std::vector<TossRun>& runs) {
  statistics_of(runs);
  bin_counts({runs[0].errors.position}, 1, 3);
}

void use_toss(const fs::path& file) {
  const Toss toss = scaled_toss(read_toss(file), kTossScaleError);
  checked_pose(start_of(toss).pose, "start");
  try {
    report_on({roll_out(toss, {.substeps = 1})});
  } catch (const std::invalid_argument&) {  // too fast, or too long a step
  }
}

void use_samples(const fs::path& file) {
  for (const PegSample& sample : read_samples(file)) {
    load_of(sample);
    centre_of_pressure(sample);
  }
}

void use_series(const fs::path& file) {
  for (const SeriesRow& row : read_series(file)) row.at("h");
}

void use_cables(const fs::path& file) {
  for (const RoutedCable& cable : cables_in(read_file(file), file.string())) try {
      route(cable, {});
    } catch (const std::invalid_argument&) {  // no length
    }
}

// A result that an earlier call kept. `write` makes a good one and returns its file, `read` reads it.
struct Kept {
  std::function<fs::path(const fs::path& folder)> write{};
  std::function<bool(const fs::path& folder)> read{};
};

Kept kept_measurement() {
  static const VerificationCase asked{.name = "A1.ball", .rows = {{.figure = "error"}}};
  return {.write =
              [](const fs::path& folder) {
                write_measured(folder / "measured.json", asked, {.figures = {{"error", 1}}}, 1);
                return folder / "measured.json";
              },
          .read =
              [](const fs::path& folder) {
                const std::optional<Measured> measured = read_measured(folder / "measured.json", asked, 1);
                if (measured) to_json({{&asked, measured}});
                return measured.has_value();
              }};
}

Kept kept_profile() {
  static const ProfileKey key{.digest = 1, .program = 1};
  return {.write =
              [](const fs::path& folder) {
                write_profile_result(folder, key, {.status = "solved", .solved = true});
                return profile_result_file(folder, key);
              },
          .read =
              [](const fs::path& folder) {
                const std::optional<ProfileResult> result = read_profile_result(folder, key, 1);
                if (result) profile_result_in(to_json(*result));
                return result.has_value();
              }};
}

Kept kept_point() {
  static const std::vector<Toss> tosses{{.name = "toss"}};
  const auto place = [] { return FitPlace{.tosses = tosses, .stage = 1, .number = 1}; };
  return {
      .write =
          [place](const fs::path& folder) {
            write_point({.folder = folder}, place(), {.each = {0}});
            return folder / "fit_1_001.json";
          },
      .read =
          [place](const fs::path& folder) { return read_point({.folder = folder}, place()).has_value(); }};
}

Kept kept_lessons() {
  return {.write =
              [](const fs::path& folder) {
                write_lessons(folder / "lessons.json", {});
                return folder / "lessons.json";
              },
          .read =
              [](const fs::path& folder) {
                const auto lessons = read_lessons(folder / "lessons.json", PegScenario::edge);
                if (lessons) (void)peg_choices(PegScenario::edge).at(std::size_t(lessons->best_choice));
                return lessons.has_value();
              }};
}

Kept kept_scores() {
  return {.write =
              [](const fs::path& folder) {
                write_result(folder / "result.json", {.set = "surface", .scores = {{.name = "kmc"}}});
                return folder / "result.json";
              },
          .read =
              [](const fs::path& folder) {
                const std::optional<PegResult> result = read_result(folder / "result.json", "surface", 0);
                if (result) score_table({*result}), verdicts({*result}, {});
                return result.has_value();
              }};
}

Kept kept_training() {
  return {.write =
              [](const fs::path& folder) {
                write_training_check(folder / "training.json", {});
                return folder / "training.json";
              },
          .read =
              [](const fs::path& folder) {
                const std::optional<TrainingCheck> check = read_training_check(folder / "training.json", 0);
                if (check) verdicts({}, {*check});
                return check.has_value();
              }};
}

Kept kept_study() {
  static const Study asked = [] {
    Study out{.case_name = "ball_e05", .scheme = "moreau_jean"};
    out.options.levels = 3;
    out.h = {0.04, 0.02, 0.01};
    out.errors.assign(3, Errors{1, 1, 1, 1});
    out.cut.assign(3, 0);
    return out;
  }();
  return {.write =
              [](const fs::path& folder) {
                write_study(folder / "study.json", asked, 1);
                return folder / "study.json";
              },
          .read =
              [](const fs::path& folder) {
                const std::optional<Study> study = read_study(folder / "study.json", asked, 1);
                if (study) order_table({*study}), to_string(*study);
                return study.has_value();
              }};
}

// What is damaged is rolled out again, and written over.
Kept kept_rollout() {
  const auto known_in = [](const fs::path& folder) {
    static const std::vector<Toss> tosses{{.name = "toss",
                                           .t = {0, 0.01},
                                           .pose = std::vector(2, translation(0, 0, 1)),
                                           .twist = std::vector<Vec6>(2, Vec6::Zero())}};
    const TossRuns known =
        roll_out_all(tosses, {.substeps = 1}, {}, {.folder = folder}, "all", 1, [](int) { return true; });
    report_on(known.runs);
    return known.known;
  };
  return {.write =
              [known_in](const fs::path& folder) {
                known_in(folder);
                return folder / "all_001.json";
              },
          .read = [known_in](const fs::path& folder) { return known_in(folder) == 1; }};
}

Kept kept_level() {
  return {.write =
              [](const fs::path& folder) {
                write_level(folder / "level_1.json", {{"h_s", 1e-3}}, {.travel = 1});
                return folder / "level_1.json";
              },
          .read =
              [](const fs::path& folder) {
                return read_level(folder / "level_1.json", {{"h_s", 1e-3}}).has_value();
              }};
}

// Of another study: it is refused.
Kept kept_claim() {
  return {.write =
              [](const fs::path& folder) {
                fs::remove(folder / "options.json");
                claim_folder(folder, {});
                return folder / "options.json";
              },
          .read =
              [](const fs::path& folder) {
                try {
                  claim_folder(folder, {});
                } catch (const std::invalid_argument&) {
                  return false;
                }
                return true;
              }};
}

// The first byte of an input chooses the kind of result, the others are its fields; those by which it is
// found are added, since an input cannot know the digest of the program. What is no JSON is the file as it
// stands.
void use_kept(const fs::path& file) {
  static const std::vector<Kept> kinds{kept_measurement(), kept_profile(),  kept_point(), kept_lessons(),
                                       kept_scores(),      kept_training(), kept_study(), kept_rollout(),
                                       kept_level(),       kept_claim()};
  const std::string input = read_file(file);
  const Kept& kind = kinds[input.empty() ? 0 : std::size_t(input[0] - '0') % kinds.size()];
  const fs::path folder = file.parent_path() / "kept", kept = kind.write(folder);
  if (!kind.read(folder)) throw std::logic_error("what was written is not read back");
  const std::string text = input.empty() ? input : input.substr(1);
  const auto good = nlohmann::ordered_json::parse(read_file(kept));
  auto fields = nlohmann::ordered_json::parse(text, nullptr, false);
  if (fields.is_object()) fields = with_key(fields, good);
  std::ofstream(kept) << (fields.is_object() ? fields.dump() : text);
  if (!kind.read(folder)) throw std::runtime_error("the work is done again");
}

// What a hand does.
void use_script(const fs::path& file) {
  const std::vector<HandCommand> commands = hand_commands_in(read_file(file), file.string());
  if (!(duration(commands) >= 0)) std::abort();
}

}  // namespace

std::vector<FuzzedReader> driver_readers() {
  return {{"pairs", ".csv", make_pairs, use_pairs},      {"toss", ".csv", write_input, use_toss},
          {"samples", ".csv", write_input, use_samples}, {"series", ".csv", write_input, use_series},
          {"cables", ".json", write_input, use_cables},  {"kept", ".json", write_input, use_kept},
          {"script", ".json", write_input, use_script}};
}

}  // namespace aussois
