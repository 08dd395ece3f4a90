// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/toss/toss_kept.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <utility>

#include "examples/common/kept_json.hpp"
#include "geometry/parallel.hpp"
#include "io/build_info.hpp"
#include "io/checkpoint.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kBatch = 16;  // tosses of a batch

void append(std::string& bytes, const double* numbers, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(numbers), count * sizeof(double));
}

// Of names and bits.
std::uint64_t digest_of(std::span<const Toss> tosses) {
  std::string bytes;
  for (const Toss& toss : tosses) {
    bytes += toss.name + '\n';
    append(bytes, toss.t.data(), toss.t.size());
    for (const SE3& g : toss.pose) append(bytes, g.R.coeffs().data(), 4), append(bytes, g.p.data(), 3);
    for (const Vec6& v : toss.twist) append(bytes, v.data(), 6);
  }
  return fingerprint_of(bytes);
}

// What has to agree before a file counts as the work that is wanted.
Json key_of(std::span<const Toss> tosses, const TossWorld& world, int certify, const TossKeep& keep) {
  return {{"program", program_digest()},
          {"tosses", digest_of(tosses)},
          {"world", settings_json(world)},
          {"scheme", keep.choice},
          {"certify", certify}};
}

Json json_of(const TossRun& run) {
  return {{"start", run.start},
          {"position_m", number_json(run.errors.position)},
          {"rotation", number_json(run.errors.rotation)},
          {"loss", number_json(run.errors.loss)},
          {"steps", run.steps},
          {"most_contacts", run.most_contacts},
          {"reduced_steps", run.reduced_steps},
          {"lifted_m", number_json(run.lifted)},
          {"failure", run.failure},
          {"audit", aussois::json_of(run.audit)}};
}

// Infinite where the cube flew off.
double error_in(const Json& json) {
  const double error = number_in(json);
  if (!(error >= 0)) throw std::invalid_argument("an error below zero, or no number");
  return error;
}

TossRun run_in(const Json& json) {
  return {.start = json.at("start"),
          .errors = {.position = error_in(json.at("position_m")),
                     .rotation = error_in(json.at("rotation")),
                     .loss = error_in(json.at("loss"))},
          .steps = json.at("steps"),
          .most_contacts = json.at("most_contacts"),
          .reduced_steps = json.at("reduced_steps"),
          .lifted = number_in(json.at("lifted_m")),
          .failure = json.at("failure"),
          .audit = audit_in(json.at("audit"))};
}

struct Batch {
  std::vector<TossRun> runs{};
  double cpu_s = 0;
};

std::optional<Batch> read_batch(const std::filesystem::path& path, const Json& key, std::size_t count) {
  return read_kept(path, key, [&](const Json& json) {
    Batch out{.cpu_s = number_in(json.at("cpu_s"))};
    for (const Json& run : json.at("runs")) out.runs.push_back(run_in(run));
    if (out.runs.size() != count) throw std::invalid_argument("another number of runs");
    return out;
  });
}

void write_batch(const std::filesystem::path& path, const Json& key, const Batch& batch) {
  Json fields{{"cpu_s", number_json(batch.cpu_s)}, {"runs", Json::array()}};
  for (const TossRun& run : batch.runs) fields["runs"].push_back(json_of(run));
  write_kept(path, key, fields);
}

std::filesystem::path numbered(const std::filesystem::path& folder, const std::string& name,
                               std::size_t number) {
  char tail[24];
  std::snprintf(tail, sizeof tail, "_%03zu.json", number);
  return folder / (name + tail);
}

Batch roll_out(std::span<const Toss> tosses, const TossWorld& world, const WatchFlags& watch,
               const std::string& name, int threads) {
  const std::clock_t begin = std::clock();
  Batch out;
  out.runs.resize(tosses.size());
  parallel_for(int(tosses.size()), threads, [&](int i) {
    const Toss& toss = tosses[std::size_t(i)];
    TossRun run = roll_out(toss, world, watch, "cube_toss_" + name + "_" + toss.name);
    run.pose.clear(), run.twist.clear(), run.contacts.clear();  // as a run that is read
    out.runs[std::size_t(i)] = std::move(run);
  });
  out.cpu_s = double(std::clock() - begin) / CLOCKS_PER_SEC;
  return out;
}

}  // namespace

TossRuns roll_out_all(const std::vector<Toss>& tosses, const TossWorld& world, const WatchFlags& watch,
                      const TossKeep& keep, const std::string& name, int threads,
                      const std::function<bool(int done)>& go_on) {
  if (!keep.folder.empty()) std::filesystem::create_directories(keep.folder);
  TossRuns out;
  for (std::size_t first = 0; first < tosses.size(); first += kBatch) {
    const std::span batch = std::span(tosses).subspan(first, std::min(kBatch, tosses.size() - first));
    const Json key = key_of(batch, world, watch.certify, keep);
    const std::filesystem::path path = numbered(keep.folder, name, first / kBatch + 1);
    const bool kept = !keep.folder.empty();
    std::optional<Batch> done;
    if (kept && keep.read) done = read_batch(path, key, batch.size());
    if (done) out.known += int(batch.size());
    if (!done) {
      done = roll_out(batch, world, watch, name, threads);
      if (kept) write_batch(path, key, *done);
    }
    out.cpu_s += done->cpu_s;
    std::ranges::move(done->runs, std::back_inserter(out.runs));
    if (!go_on(int(first + batch.size()))) return {};
  }
  return out;
}

namespace {

Json key_of(const FitPlace& place, const TossKeep& keep) {
  Json key = key_of(place.tosses, place.start, place.watch.certify, keep);
  key["stage"] = place.stage;
  key["number"] = place.number;
  key["point"] = {place.mu, place.restitution};
  key["bound_m"] = number_json(place.bound);
  return key;
}

std::filesystem::path path_of(const FitPlace& place, const TossKeep& keep) {
  return numbered(keep.folder, "fit_" + std::to_string(place.stage), std::size_t(place.number));
}

}  // namespace

std::optional<FitPoint> read_point(const TossKeep& keep, const FitPlace& place) {
  if (keep.folder.empty()) return {};
  return read_kept(path_of(place, keep), key_of(place, keep), [&](const Json& json) {
    FitPoint out{.error = error_in(json.at("error_m")),
                 .steps = json.at("steps"),
                 .audit = audit_in(json.at("audit"))};
    for (const Json& error : json.at("errors_m")) out.each.push_back(error_in(error));
    if (out.each.size() != place.tosses.size()) throw std::invalid_argument("another number of tosses");
    return out;
  });
}

void write_point(const TossKeep& keep, const FitPlace& place, const FitPoint& point) {
  if (keep.folder.empty()) return;
  std::filesystem::create_directories(keep.folder);
  Json fields{{"error_m", number_json(point.error)},
              {"steps", point.steps},
              {"errors_m", Json::array()},
              {"audit", json_of(point.audit)}};
  for (const double error : point.each) fields["errors_m"].push_back(number_json(error));
  write_kept(path_of(place, keep), key_of(place, keep), fields);
}

}  // namespace aussois
