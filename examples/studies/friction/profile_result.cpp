// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/friction/profile_result.hpp"

#include <nlohmann/json.hpp>

#include "examples/common/kept_json.hpp"
#include "examples/common/many_tasks.hpp"
#include "geometry/digest.hpp"
#include "geometry/number_text.hpp"
#include "io/checkpoint.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const ProfileKey& key) {
  return {
      {"digest", hex_text(key.digest)}, {"options", settings_json(key.options)}, {"program", key.program}};
}

Json json_of(const ProfileResult& result) {
  return {{"problem", result.problem},
          {"contacts", result.contacts},
          {"status", result.status},
          {"solved", result.solved},
          {"iterations", result.iterations},
          {"scaled_residual", number_json(result.scaled_residual)},
          {"natural_map_residual", number_json(result.natural_map_residual)},
          {"cpu_s", number_json(result.cpu_s)},
          {"time_limit", number_json(result.time_limit)}};
}

ProfileResult result_in(const Json& json) {
  return {.status = json.at("status"),
          .solved = json.at("solved"),
          .iterations = json.at("iterations"),
          .scaled_residual = number_in(json.at("scaled_residual")),
          .natural_map_residual = number_in(json.at("natural_map_residual")),
          .cpu_s = number_in(json.at("cpu_s")),
          .time_limit = number_in(json.at("time_limit")),
          .contacts = json.at("contacts"),
          .problem = json.at("problem")};
}

}  // namespace

ProfileResult result_of(const ProblemRun& run) {
  return {.status = run.status,
          .solved = run.solved,
          .iterations = run.report.iterations,
          .scaled_residual = run.scaled_residual,
          .natural_map_residual = run.natural_map_residual,
          .cpu_s = run.cpu_s,
          .contacts = run.contacts,
          .problem = run.problem};
}

std::uint64_t file_digest(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) return 0;
  const std::string bytes = read_file(path);
  Digest digest;
  digest.add(std::as_bytes(std::span(bytes.data(), bytes.size())));
  return digest.value;
}

std::string to_json(const ProfileResult& result) {
  return file_text(json_of(result));
}

ProfileResult profile_result_in(const std::string& json) {
  return result_in(Json::parse(json));
}

std::filesystem::path profile_result_file(const std::filesystem::path& folder, const ProfileKey& key) {
  const SolverOptions& solver = key.options.solver;
  return folder / (file_stem(hex_text(key.digest) + "_" + to_string(solver.method) + "_" +
                             number_text(solver.tolerance) + "_" +
                             hex_text(fingerprint_of(settings_json(key.options).dump()))) +
                   ".json");
}

void write_profile_result(const std::filesystem::path& folder, const ProfileKey& key,
                          const ProfileResult& result) {
  write_kept(profile_result_file(folder, key), json_of(key), json_of(result));
}

std::optional<ProfileResult> read_profile_result(const std::filesystem::path& folder, const ProfileKey& key,
                                                 double time_limit) {
  const std::optional<ProfileResult> known =
      read_kept(profile_result_file(folder, key), json_of(key), result_in);
  const bool given_up = known && known->status == "time_limit" && known->time_limit < time_limit;
  return given_up ? std::nullopt : known;
}

}  // namespace aussois
