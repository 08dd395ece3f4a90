// SPDX-License-Identifier: Apache-2.0
#include "io/session_file.hpp"

#include <algorithm>
#include <stdexcept>

#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/hdf5_file.hpp"

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
template <class Row, class T, class Get>
void append(hid_t file, const char* name, const std::vector<Row>& rows, std::size_t from, Get get) {
  std::vector<T> values;
  for (std::size_t i = from; i < rows.size(); ++i) values.push_back(get(rows[i]));
  Hdf5Column::open(file, name, Hdf5Row<T>::type(), Hdf5Row<T>::shape()).append(values.data(), values.size());
}
template <class T>
void create(hid_t file, const char* name, const char* unit = "") {
  Hdf5Column(file, name, Hdf5Row<T>::type(), Hdf5Row<T>::shape(), kHdf5ChunkRows, unit);
}

// Texts: their bytes one after the other, and where each ends.
void create_texts(hid_t file, const std::string& name) {
  create<std::int8_t>(file, (name + "_bytes").c_str());
  create<std::uint64_t>(file, (name + "_end").c_str());
}
template <class Row>
void append_texts(hid_t file, const std::string& name, const std::vector<Row>& rows, std::size_t from,
                  std::string Row::*text) {
  Hdf5Column bytes = Hdf5Column::open(file, name + "_bytes", Hdf5Row<std::int8_t>::type(), {});
  std::uint64_t end = bytes.rows();
  std::string all;
  std::vector<std::uint64_t> ends;
  for (std::size_t i = from; i < rows.size(); ++i) all += rows[i].*text, ends.push_back(end + all.size());
  bytes.append(all.data(), all.size());
  Hdf5Column::open(file, name + "_end", Hdf5Row<std::uint64_t>::type(), {}).append(ends.data(), ends.size());
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

void create_tables(hid_t file) {
  for (const char* group : {"/take", "/input", "/change", "/mark", "/hash"}) make_group(file, group);
  create<int>(file, "/take/parent");
  create<std::int64_t>(file, "/take/begins");
  create<std::int64_t>(file, "/take/ends");
  create<int>(file, "/input/take");
  create<std::int64_t>(file, "/input/tick");
  create<int>(file, "/input/mode");
  create<PoseRow>(file, "/input/pose", "m, -");
  create<TwistRow>(file, "/input/twist", "m/s, rad/s");
  create<Vec3>(file, "/input/grip", "m");
  create<int>(file, "/input/firm");
  create<int>(file, "/change/take");
  create<std::int64_t>(file, "/change/tick");
  create_texts(file, "/change/name");
  create<double>(file, "/change/value");
  create<int>(file, "/mark/take");
  create<std::int64_t>(file, "/mark/moment");
  create_texts(file, "/mark/kind");
  create_texts(file, "/mark/text");
  create<int>(file, "/hash/take");
  create<std::int64_t>(file, "/hash/moment");
  create<std::uint64_t>(file, "/hash/hash");
}

// Ends of takes grow: the table is small, and written anew.
void write_takes(hid_t file, const std::vector<SessionTake>& takes) {
  for (const char* name : {"/take/begins", "/take/ends"})
    Hdf5Column::open(file, name, Hdf5Row<std::int64_t>::type(), {}).truncate(0);
  Hdf5Column::open(file, "/take/parent", Hdf5Row<int>::type(), {}).truncate(0);
  using R = const SessionTake&;
  append<SessionTake, int>(file, "/take/parent", takes, 0, [](R r) { return r.parent; });
  append<SessionTake, std::int64_t>(file, "/take/begins", takes, 0, [](R r) { return r.begins; });
  append<SessionTake, std::int64_t>(file, "/take/ends", takes, 0, [](R r) { return r.ends; });
}

void append_inputs(hid_t file, const std::vector<SessionInput>& rows, std::size_t from) {
  using Row = SessionInput;
  append<Row, int>(file, "/input/take", rows, from, [](const Row& r) { return r.take; });
  append<Row, std::int64_t>(file, "/input/tick", rows, from, [](const Row& r) { return r.tick; });
  append<Row, int>(file, "/input/mode", rows, from, [](const Row& r) { return int(r.target.mode); });
  append<Row, PoseRow>(file, "/input/pose", rows, from, [](const Row& r) { return pose_row(r.target.pose); });
  append<Row, TwistRow>(file, "/input/twist", rows, from,
                        [](const Row& r) { return twist_row(r.target.twist); });
  append<Row, Vec3>(file, "/input/grip", rows, from, [](const Row& r) { return r.target.grip; });
  append<Row, int>(file, "/input/firm", rows, from, [](const Row& r) { return int(r.target.firm); });
}

void append_changes(hid_t file, const std::vector<SessionChange>& rows, std::size_t from) {
  using Row = SessionChange;
  append<Row, int>(file, "/change/take", rows, from, [](const Row& r) { return r.take; });
  append<Row, std::int64_t>(file, "/change/tick", rows, from, [](const Row& r) { return r.tick; });
  append_texts(file, "/change/name", rows, from, &Row::name);
  append<Row, double>(file, "/change/value", rows, from, [](const Row& r) { return r.value; });
}

void append_marks(hid_t file, const std::vector<SessionMark>& rows, std::size_t from) {
  using Row = SessionMark;
  append<Row, int>(file, "/mark/take", rows, from, [](const Row& r) { return r.take; });
  append<Row, std::int64_t>(file, "/mark/moment", rows, from, [](const Row& r) { return r.moment; });
  append_texts(file, "/mark/kind", rows, from, &Row::kind);
  append_texts(file, "/mark/text", rows, from, &Row::text);
}

void append_hashes(hid_t file, const std::vector<SessionHash>& rows, std::size_t from) {
  using Row = SessionHash;
  append<Row, int>(file, "/hash/take", rows, from, [](const Row& r) { return r.take; });
  append<Row, std::int64_t>(file, "/hash/moment", rows, from, [](const Row& r) { return r.moment; });
  append<Row, std::uint64_t>(file, "/hash/hash", rows, from, [](const Row& r) { return r.hash; });
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

struct SessionWriter::Impl {
  std::filesystem::path path{};
  Hdf5Id file{};
  std::size_t inputs = 0, changes = 0, marks = 0, hashes = 0;
};

SessionWriter::SessionWriter(std::filesystem::path path, const std::map<std::string, std::string>& notes)
    : impl_(std::make_unique<Impl>()) {
  const Hdf5Silence silence;
  impl_->path = std::move(path);
  const std::filesystem::path growing = growing_name(impl_->path);
  WriterLock left(growing);
  left.remove_file();
  impl_->file = create_hdf5(growing);
  const hid_t file = impl_->file;
  write_text(file, "/", "format", kFormat);
  write_text(file, "/", "version", kVersion);
  make_group(file, "/notes");
  for (const auto& [name, text] : notes) write_text(file, "/notes", name, text);
  create_tables(file);
  flush_hdf5(file);
}

SessionWriter::SessionWriter(SessionWriter&&) noexcept = default;
SessionWriter::~SessionWriter() = default;

void SessionWriter::write(const SessionLog& log) {
  require(impl_->file >= 0, "SessionWriter::write: the session is closed");
  const Hdf5Silence silence;
  const hid_t file = impl_->file;
  write_takes(file, log.takes);
  append_inputs(file, log.inputs, std::exchange(impl_->inputs, log.inputs.size()));
  append_changes(file, log.changes, std::exchange(impl_->changes, log.changes.size()));
  append_marks(file, log.marks, std::exchange(impl_->marks, log.marks.size()));
  append_hashes(file, log.hashes, std::exchange(impl_->hashes, log.hashes.size()));
  flush_hdf5(file);
}

void SessionWriter::close() {
  if (impl_->file < 0) return;
  impl_->file = Hdf5Id();
  publish_file(growing_name(impl_->path), impl_->path);
}

SessionData read_session(const std::filesystem::path& path) {
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
