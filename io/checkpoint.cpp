// SPDX-License-Identifier: Apache-2.0
#include "io/checkpoint.hpp"

#include <stdexcept>

#include "io/atomic_file.hpp"
#include "io/build_info.hpp"
#include "io/hdf5_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

constexpr const char* kCheckpointFormat = "aussois-checkpoint";
constexpr const char* kCheckpointVersion = "9";

/// Rows of a column of the contact memory.
template <class T, class Get>
std::vector<T> gathered(const ContactMemory& memory, const Get& get) {
  std::vector<T> values;
  values.reserve(memory.contacts.size());
  for (const RememberedContact& contact : memory.contacts) values.push_back(get(contact));
  return values;
}

template <class T>
void write_named(hid_t file, const std::string& group, const std::map<std::string, T>& values) {
  std::vector<std::string> names;
  std::vector<T> rows;
  for (const auto& [name, value] : values) {
    names.push_back(name);
    rows.push_back(value);
  }
  write_texts(file, group + "/name", names);
  write_rows(file, group + "/value", rows);
}

template <class T>
std::map<std::string, T> read_named(hid_t file, const std::string& group) {
  const std::vector<std::string> names = read_texts(file, group + "/name");
  const std::vector<T> rows = read_rows<T>(file, group + "/value");
  if (names.size() != rows.size()) fail_hdf5(file, group, "does not have one value per name");
  std::map<std::string, T> values;
  for (std::size_t i = 0; i < names.size(); ++i) values[names[i]] = rows[i];
  return values;
}

template <class Value>
Value entry(const Checkpoint& checkpoint, const std::map<std::string, Value>& values,
            const std::string& name) {
  const auto found = values.find(name);
  if (found == values.end())
    throw std::runtime_error("checkpoint: '" + name + "' is missing; it was written by " +
                             checkpoint.program);
  return found->second;
}

template <class T>
T read_one(hid_t file, const std::string& name) {
  const std::vector<T> rows = read_rows<T>(file, name);
  if (rows.size() != 1) fail_hdf5(file, name, "has " + std::to_string(rows.size()) + " rows instead of 1");
  return rows[0];
}

using PoseRow = std::array<double, 7>;  // x y z qx qy qz qw, as in run.h5

void write_state(hid_t file, const State& state) {
  write_rows(file, "/state/t", std::vector<double>{state.t});
  write_rows(file, "/state/h", std::vector<double>{state.h});
  write_rows(file, "/state/h_next", std::vector<double>{state.h_next});
  write_rows(file, "/state/apart", std::vector<std::uint64_t>{state.apart});
  std::vector<PoseRow> pose;
  for (const SE3& g : state.g)
    pose.push_back({g.p.x(), g.p.y(), g.p.z(), g.R.x(), g.R.y(), g.R.z(), g.R.w()});
  write_rows(file, "/state/pose", pose);
  write_rows(file, "/state/velocity", std::vector<double>(state.v.begin(), state.v.end()));
  write_rows(file, "/state/coordinates", std::vector<double>(state.q.begin(), state.q.end()));
  write_rows(file, "/state/turns", state.turns);
  write_rows(file, "/state/impulse", std::vector<double>(state.r.begin(), state.r.end()));
  write_rows(file, "/state/acceleration", std::vector<double>(state.a.begin(), state.a.end()));
  write_rows(file, "/state/input", std::vector<double>(state.u.begin(), state.u.end()));
  const ContactMemory& memory = state.memory;
  const auto write = [&]<class T>(const char* name, T RememberedContact::*field) {
    write_rows(file, name, gathered<T>(memory, [&](const auto& contact) { return contact.*field; }));
  };
  write_rows(file, "/memory/bodies", gathered<std::array<int, 2>>(memory, [](const auto& contact) {
               return std::array{contact.key.body_a.index(), contact.key.body_b.index()};
             }));
  write_rows(file, "/memory/feature",
             gathered<std::uint64_t>(memory, [](const auto& contact) { return contact.key.feature; }));
  write("/memory/normal", &RememberedContact::normal);
  write("/memory/point_a", &RememberedContact::point_a);
  write("/memory/point_b", &RememberedContact::point_b);
  write("/memory/impulse", &RememberedContact::impulse);
  write("/memory/drilling", &RememberedContact::drilling);
  write("/memory/anchor_b", &RememberedContact::anchor_b);
  write_rows(file, "/memory/held",
             gathered<int>(memory, [](const auto& contact) { return int(contact.held); }));
  write_rows(file, "/memory/solved",
             gathered<int>(memory, [](const auto& contact) { return int(contact.solved); }));
  write_rows(file, "/state/hash", std::vector<std::uint64_t>{hash(state)});
}

State read_state(hid_t file) {
  State state;
  state.t = read_one<double>(file, "/state/t");
  state.h = read_one<double>(file, "/state/h");
  state.h_next = read_one<double>(file, "/state/h_next");
  state.apart = read_one<std::uint64_t>(file, "/state/apart");
  for (const PoseRow& row : read_rows<PoseRow>(file, "/state/pose"))
    state.g.push_back({Quat(row[6], row[3], row[4], row[5]), Vec3(row[0], row[1], row[2])});
  state.v = read_vector(file, "/state/velocity");
  state.q = read_vector(file, "/state/coordinates");
  state.turns = read_rows<int>(file, "/state/turns");
  state.r = read_vector(file, "/state/impulse");
  state.a = read_vector(file, "/state/acceleration");
  state.u = read_vector(file, "/state/input");
  const auto bodies = read_rows<std::array<int, 2>>(file, "/memory/bodies");
  const auto feature = read_rows<std::uint64_t>(file, "/memory/feature");
  const auto held = read_rows<int>(file, "/memory/held");
  const auto solved = read_rows<int>(file, "/memory/solved");
  if (feature.size() != bodies.size() || held.size() != bodies.size() || solved.size() != bodies.size())
    fail_hdf5(file, "/memory", "has columns of different lengths");
  ContactMemory& memory = state.memory;
  memory.contacts.resize(bodies.size());
  const auto read = [&]<class T>(const char* name, T RememberedContact::*field) {
    const std::vector<T> column = read_rows<T>(file, name);
    if (column.size() != memory.contacts.size())
      fail_hdf5(file, "/memory", "has columns of different lengths");
    for (std::size_t i = 0; i < column.size(); ++i) memory.contacts[i].*field = column[i];
  };
  read("/memory/normal", &RememberedContact::normal);
  read("/memory/point_a", &RememberedContact::point_a);
  read("/memory/point_b", &RememberedContact::point_b);
  read("/memory/impulse", &RememberedContact::impulse);
  read("/memory/drilling", &RememberedContact::drilling);
  read("/memory/anchor_b", &RememberedContact::anchor_b);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    memory.contacts[i].key = {
        .body_a = BodyId::at(bodies[i][0]), .body_b = BodyId::at(bodies[i][1]), .feature = feature[i]};
    memory.contacts[i].held = held[i] != 0;
    memory.contacts[i].solved = solved[i] != 0;
  }
  if (hash(state) != read_one<std::uint64_t>(file, "/state/hash"))
    fail_hdf5(file, "/state/hash", "is not the hash of the state: the file is damaged");
  return state;
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  const Hdf5Silence silence;
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    const Hdf5Id file = create_hdf5(temporary);
    write_text(file, "/", "format", kCheckpointFormat);
    write_text(file, "/", "version", kCheckpointVersion);
    write_text(file, "/", "program", checkpoint.program.empty() ? program_version() : checkpoint.program);
    write_rows(file, "/fingerprint", std::vector<std::uint64_t>{checkpoint.fingerprint});
    write_rows(file, "/step", std::vector<std::int64_t>{checkpoint.step});
    write_state(file, checkpoint.state);
    write_named(file, "/numbers", checkpoint.numbers);
    write_named(file, "/counts", checkpoint.counts);
    flush_hdf5(file);
  });
}

Checkpoint read_checkpoint(const std::filesystem::path& path, std::uint64_t fingerprint, OtherProgram other) {
  const Hdf5Silence silence;
  const Hdf5Id file = open_hdf5(path, Hdf5Access::read);
  check_format(file, kCheckpointFormat, kCheckpointVersion);
  Checkpoint checkpoint;
  checkpoint.program = read_text(file, "/", "program");
  if (other == OtherProgram::refuse && checkpoint.program != program_version())
    fail_hdf5(file, "/@program",
              "the checkpoint was written by " + checkpoint.program + ", this is " + program_version() +
                  ", which may not continue with the same bits: use that program, or --resume-anyway");
  checkpoint.fingerprint = read_one<std::uint64_t>(file, "/fingerprint");
  if (checkpoint.fingerprint != fingerprint)
    fail_hdf5(file, "/fingerprint",
              "the checkpoint was written with model and options 0x" + hex_text(checkpoint.fingerprint) +
                  ", this run has 0x" + hex_text(fingerprint));
  checkpoint.step = read_one<std::int64_t>(file, "/step");
  checkpoint.state = read_state(file);
  checkpoint.numbers = read_named<double>(file, "/numbers");
  checkpoint.counts = read_named<std::int64_t>(file, "/counts");
  return checkpoint;
}

double checkpoint_number(const Checkpoint& checkpoint, const std::string& name) {
  return entry(checkpoint, checkpoint.numbers, name);
}

std::int64_t checkpoint_count(const Checkpoint& checkpoint, const std::string& name) {
  return entry(checkpoint, checkpoint.counts, name);
}

std::uint64_t fingerprint_of(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

}  // namespace aussois
