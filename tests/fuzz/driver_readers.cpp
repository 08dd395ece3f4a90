// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <functional>
#include <stdexcept>

#include "examples/common/kept_json.hpp"
#include "examples/drivers/assembly/assembly_input.hpp"
#include "examples/scenes/shared_series.hpp"
#include "examples/studies/convergence/study_files.hpp"
#include "examples/studies/friction/profile_result.hpp"
#include "examples/studies/peg_plate/study_files.hpp"
#include "examples/studies/toss/toss_kept.hpp"
#include "examples/studies/verification/list.hpp"
#include "tests/fuzz/readers.hpp"

namespace aussois {
namespace {

namespace fs = std::filesystem;

// As the folder of a user has it.
void make_pairs(const fs::path& file, Bytes input) {
  fs::create_directories(file.parent_path() / "assembly");
  write_input(file.parent_path() / "assembly" / "pairs.csv", input);
}

void use_pairs(const fs::path& file) {
  try {
    read_assembly_pair(file.parent_path(), "peg", 1e-3);
  } catch (const std::invalid_argument&) {  // no pair of that name
  }
}

void use_study(const fs::path& file) {
  const std::optional<Study> study =
      read_study(file, {.case_name = "ball_e05", .scheme = "moreau_jean theta 0.5 combined"}, 1);
  if (!study) return;
  order_table({*study});
  write_input(file, {});
  if (read_study(file, *study, 1)) throw std::logic_error("an empty file is no study");
}

void use_toss(const fs::path& file) {
  const TossStart start = start_of(scaled_toss(read_toss(file), kTossScaleError));
  checked_pose(start.pose, "start");
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
          .read = [](const fs::path& folder) { return read_lessons(folder / "lessons.json").has_value(); }};
}

Kept kept_scores() {
  return {.write =
              [](const fs::path& folder) {
                write_result(folder / "result.json", {.set = "surface", .scores = {{.name = "kmc"}}});
                return folder / "result.json";
              },
          .read =
              [](const fs::path& folder) {
                return read_result(folder / "result.json", "surface", 0).has_value();
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
                return read_training_check(folder / "training.json", 0).has_value();
              }};
}

// The first byte of an input chooses the kind of result, the others are its fields; those by which it is
// found are added, since an input cannot know the digest of the program. What is no JSON is the file as it
// stands.
void use_kept(const fs::path& file) {
  static const std::vector<Kept> kinds{kept_measurement(), kept_profile(), kept_point(),
                                       kept_lessons(),     kept_scores(),  kept_training()};
  const std::string input = read_file(file);
  const Kept& kind = kinds[input.empty() ? 0 : std::size_t(input[0] - '0') % kinds.size()];
  const fs::path folder = file.parent_path() / "kept", kept = kind.write(folder);
  if (!kind.read(folder)) throw std::logic_error("what was written is not read back");
  const std::string text = input.empty() ? input : input.substr(1);
  const auto good = nlohmann::ordered_json::parse(read_file(kept));
  auto fields = nlohmann::ordered_json::parse(text, nullptr, false);
  if (fields.is_object()) fields = with_key(fields, good);
  std::ofstream(kept) << (fields.is_object() ? fields.dump() : text);
  kind.read(folder);
}

}  // namespace

std::vector<FuzzedReader> driver_readers() {
  return {{"pairs", ".csv", make_pairs, use_pairs},    {"study", ".json", write_input, use_study},
          {"toss", ".csv", write_input, use_toss},     {"samples", ".csv", write_input, use_samples},
          {"series", ".csv", write_input, use_series}, {"kept", ".json", write_input, use_kept}};
}

}  // namespace aussois
