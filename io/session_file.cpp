// SPDX-License-Identifier: Apache-2.0
#include "io/session_file.hpp"

#include <algorithm>
#include <stdexcept>

#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/hdf5_file.hpp"
#include "io/session_writer.hpp"

namespace aussois {
namespace {

constexpr const char* kFormat = "aussois-session";
constexpr const char* kVersion = "1";

using PoseRow = std::array<double, 7>;  // x y z qx qy qz qw, as in run.h5
using TwistRow = std::array<double, 6>;

PoseRow pose_row(const SE3& g) {
  return {g.p.x(), g.p.y(), g.p.z(), g.R.x(), g.R.y(), g.R.z(), g.R.w()};
}
TwistRow twist_row(const Vec6& v) {
  return {v[0], v[1], v[2], v[3], v[4], v[5]};
}

// A field of the rows of a table, as a column of numbers.
template <class T, class Row, class Get>
void write(hid_t file, const char* name, const std::vector<Row>& rows, Get get, const char* unit = "") {
  std::vector<T> values;
  for (const Row& row : rows) values.push_back(get(row));
  write_rows(file, name, values, unit);
}

// Texts: their bytes one after the other, and where each ends.
template <class Row>
void write_texts_of(hid_t file, const std::string& name, const std::vector<Row>& rows,
                    std::string Row::*text) {
  std::vector<std::int8_t> bytes;
  std::vector<std::uint64_t> ends;
  for (const Row& row : rows) {
    bytes.insert(bytes.end(), (row.*text).begin(), (row.*text).end());
    ends.push_back(bytes.size());
  }
  write_rows(file, name + "_bytes", bytes);
  write_rows(file, name + "_end", ends);
}
std::vector<std::string> read_texts_of(hid_t file, const std::string& name) {
  const auto bytes = read_rows<std::int8_t>(file, name + "_bytes");
  const auto ends = read_rows<std::uint64_t>(file, name + "_end");
  std::vector<std::string> out;
  std::uint64_t begin = 0;
  for (const std::uint64_t end : ends) {
    if (end < begin || end > bytes.size()) fail_hdf5(file, name + "_end", "must ascend within the bytes");
    out.emplace_back(bytes.begin() + std::ptrdiff_t(begin), bytes.begin() + std::ptrdiff_t(end));
    begin = end;
  }
  return out;
}

void write_inputs(hid_t file, const std::vector<SessionInput>& rows) {
  using R = const SessionInput&;
  write<int>(file, "/input/take", rows, [](R r) { return r.take; });
  write<std::int64_t>(file, "/input/tick", rows, [](R r) { return r.tick; });
  write<int>(file, "/input/mode", rows, [](R r) { return int(r.target.mode); });
  write<PoseRow>(
      file, "/input/pose", rows, [](R r) { return pose_row(r.target.pose); }, "m, -");
  write<TwistRow>(
      file, "/input/twist", rows, [](R r) { return twist_row(r.target.twist); }, "m/s, rad/s");
  write<Vec3>(
      file, "/input/grip", rows, [](R r) { return r.target.grip; }, "m");
  write<int>(file, "/input/firm", rows, [](R r) { return int(r.target.firm); });
}

void write_tables(hid_t file, const SessionLog& log) {
  for (const char* group : {"/take", "/input", "/change", "/mark", "/hash"}) make_group(file, group);
  using T = const SessionTake&;
  write<int>(file, "/take/parent", log.takes, [](T r) { return r.parent; });
  write<std::int64_t>(file, "/take/begins", log.takes, [](T r) { return r.begins; });
  write<std::int64_t>(file, "/take/ends", log.takes, [](T r) { return r.ends; });
  write_inputs(file, log.inputs);
  using C = const SessionChange&;
  write<int>(file, "/change/take", log.changes, [](C r) { return r.take; });
  write<std::int64_t>(file, "/change/tick", log.changes, [](C r) { return r.tick; });
  write_texts_of(file, "/change/name", log.changes, &SessionChange::name);
  write<double>(file, "/change/value", log.changes, [](C r) { return r.value; });
  using M = const SessionMark&;
  write<int>(file, "/mark/take", log.marks, [](M r) { return r.take; });
  write<std::int64_t>(file, "/mark/moment", log.marks, [](M r) { return r.moment; });
  write_texts_of(file, "/mark/kind", log.marks, &SessionMark::kind);
  write_texts_of(file, "/mark/text", log.marks, &SessionMark::text);
  using H = const SessionHash&;
  write<int>(file, "/hash/take", log.hashes, [](H r) { return r.take; });
  write<std::int64_t>(file, "/hash/moment", log.hashes, [](H r) { return r.moment; });
  write<std::uint64_t>(file, "/hash/hash", log.hashes, [](H r) { return r.hash; });
}

template <class T>
std::vector<T> read_as_many(hid_t file, const char* name, std::size_t rows) {
  std::vector<T> out = read_rows<T>(file, name);
  if (out.size() != rows)
    fail_hdf5(file, name, std::to_string(out.size()) + " rows, but its table has " + std::to_string(rows));
  return out;
}
std::vector<std::string> texts_as_many(hid_t file, const char* name, std::size_t rows) {
  std::vector<std::string> out = read_texts_of(file, name);
  if (out.size() != rows)
    fail_hdf5(file, name, std::to_string(out.size()) + " texts, but its table has " + std::to_string(rows));
  return out;
}

std::vector<SessionTake> read_takes(hid_t file) {
  const auto parent = read_rows<int>(file, "/take/parent");
  const std::size_t n = parent.size();
  const auto begins = read_as_many<std::int64_t>(file, "/take/begins", n),
             ends = read_as_many<std::int64_t>(file, "/take/ends", n);
  std::vector<SessionTake> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back({parent[i], begins[i], ends[i]});
  return out;
}

std::vector<SessionInput> read_inputs(hid_t file) {
  const auto take = read_rows<int>(file, "/input/take");
  const std::size_t n = take.size();
  const auto tick = read_as_many<std::int64_t>(file, "/input/tick", n);
  const auto mode = read_as_many<int>(file, "/input/mode", n),
             firm = read_as_many<int>(file, "/input/firm", n);
  const auto pose = read_as_many<PoseRow>(file, "/input/pose", n);
  const auto twist = read_as_many<TwistRow>(file, "/input/twist", n);
  const auto grip = read_as_many<Vec3>(file, "/input/grip", n);
  std::vector<SessionInput> out;
  for (std::size_t i = 0; i < n; ++i) {
    const PoseRow& g = pose[i];
    PortTarget target{.mode = PortTarget::Mode(mode[i]), .grip = grip[i], .firm = firm[i] != 0};
    target.pose = {Quat(g[6], g[3], g[4], g[5]), Vec3(g[0], g[1], g[2])};
    target.twist = Eigen::Map<const Vec6>(twist[i].data());
    out.push_back({take[i], tick[i], target});
  }
  return out;
}

SessionLog read_log(hid_t file) {
  SessionLog log{.takes = read_takes(file), .inputs = read_inputs(file)};
  const auto of_change = read_rows<int>(file, "/change/take"), of_mark = read_rows<int>(file, "/mark/take"),
             of_hash = read_rows<int>(file, "/hash/take");
  const std::size_t changes = of_change.size(), marks = of_mark.size(), hashes = of_hash.size();
  const auto tick = read_as_many<std::int64_t>(file, "/change/tick", changes);
  const auto name = texts_as_many(file, "/change/name", changes);
  const auto value = read_as_many<double>(file, "/change/value", changes);
  for (std::size_t i = 0; i < changes; ++i) log.changes.push_back({of_change[i], tick[i], name[i], value[i]});
  const auto moment = read_as_many<std::int64_t>(file, "/mark/moment", marks);
  const auto kind = texts_as_many(file, "/mark/kind", marks), text = texts_as_many(file, "/mark/text", marks);
  for (std::size_t i = 0; i < marks; ++i) log.marks.push_back({of_mark[i], moment[i], kind[i], text[i]});
  const auto of = read_as_many<std::int64_t>(file, "/hash/moment", hashes);
  const auto hash = read_as_many<std::uint64_t>(file, "/hash/hash", hashes);
  for (std::size_t i = 0; i < hashes; ++i) log.hashes.push_back({of_hash[i], of[i], hash[i]});
  return log;
}

std::string row_name(const char* table, std::size_t row) {
  return std::string(table) + " " + std::to_string(row) + ": ";
}

void check_takes(const std::vector<SessionTake>& takes) {
  require(!takes.empty(), "session: has no take");
  for (std::size_t i = 0; i < takes.size(); ++i) {
    const SessionTake& take = takes[i];
    const std::string who = row_name("take", i);
    require_field(i == 0 ? take.parent == -1 : take.parent >= 0 && take.parent < int(i),
                  (who + "parent").c_str(), take.parent, i == 0 ? "be -1" : "be one of the takes before");
    const std::int64_t last = i == 0 ? 0 : takes[std::size_t(take.parent)].ends;
    require_field(take.begins >= 0 && take.begins <= last, (who + "begins").c_str(), take.begins,
                  "be a moment of its parent");
    require_field(take.ends >= take.begins, (who + "ends").c_str(), take.ends, "not be before it begins");
  }
}

void check_input(const SessionInput& row, const std::string& who) {
  const PortTarget& target = row.target;
  require_field(int(target.mode) >= 0 && int(target.mode) <= int(PortTarget::Mode::twist),
                (who + "mode").c_str(), int(target.mode), "be 0, 1 or 2");
  (void)checked_pose(target.pose, (who + "pose").c_str());
  require(target.twist.allFinite(), who + "twist must be finite");
  require(target.grip.allFinite(), who + "grip must be finite");
}

// Whether a row lies between the first and the last moment of its take.
template <class Row>
void check_place(const SessionLog& log, const Row& row, std::int64_t at, const std::string& who) {
  require_field(row.take >= 0 && std::size_t(row.take) < log.takes.size(), (who + "take").c_str(), row.take,
                "be that of a take");
  const SessionTake& take = log.takes[std::size_t(row.take)];
  require_field(at >= take.begins && at <= take.ends, (who + "moment").c_str(), at, "lie in its take");
}

}  // namespace

void validate(const SessionLog& log) {
  check_takes(log.takes);
  std::vector<std::int64_t> last(log.takes.size(), -1);
  for (std::size_t i = 0; i < log.inputs.size(); ++i) {
    const SessionInput& row = log.inputs[i];
    const std::string who = row_name("input", i);
    check_place(log, row, row.tick, who);
    std::int64_t& before = last[std::size_t(row.take)];
    require_field(before >= 0 ? row.tick > before : row.tick == log.takes[std::size_t(row.take)].begins,
                  (who + "tick").c_str(), row.tick,
                  before >= 0 ? "be later than the one before" : "be the first of its take");
    before = row.tick;
    check_input(row, who);
  }
  for (std::size_t i = 0; i < log.takes.size(); ++i)
    require(log.takes[i].begins == log.takes[i].ends || last[i] >= 0, row_name("take", i) + "has no input");
  for (std::size_t i = 0; i < log.changes.size(); ++i) {
    const std::string who = row_name("change", i);
    check_place(log, log.changes[i], log.changes[i].tick, who);
    require(std::isfinite(log.changes[i].value), who + "value must be finite");
  }
  for (std::size_t i = 0; i < log.marks.size(); ++i)
    check_place(log, log.marks[i], log.marks[i].moment, row_name("mark", i));
  for (std::size_t i = 0; i < log.hashes.size(); ++i)
    check_place(log, log.hashes[i], log.hashes[i].moment, row_name("hash", i));
}

void write_session(const std::filesystem::path& path, const SessionData& session) {
  const Hdf5Silence silence;
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::filesystem::remove(temporary);
    const Hdf5Id file = create_hdf5(temporary);
    write_text(file, "/", "format", kFormat);
    write_text(file, "/", "version", kVersion);
    make_group(file, "/notes");
    for (const auto& [name, text] : session.notes) write_text(file, "/notes", name, text);
    write_tables(file, session.log);
  });
}

SessionData read_session(const std::filesystem::path& path) {
  if (is_journal(path)) return read_journal(path);
  const Hdf5Silence silence;
  const Hdf5Id file = open_hdf5(path, Hdf5Access::read);
  check_format(file, kFormat, kVersion);
  SessionData out;
  for (const std::string& name : attribute_names(file, "/notes"))
    out.notes[name] = read_text(file, "/notes", name);
  out.log = read_log(file);
  try {
    validate(out.log);
  } catch (const std::invalid_argument& wrong) {
    throw std::runtime_error(path.string() + ": " + wrong.what());
  }
  return out;
}

}  // namespace aussois
