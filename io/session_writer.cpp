// SPDX-License-Identifier: Apache-2.0
#include "io/session_writer.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kJournal = "aussois-session-journal";
constexpr int kJournalVersion = 1;

// A line: a word and its values.
void add_line(std::string& out, const char* word, Json values) {
  out += Json{{word, std::move(values)}}.dump(-1, ' ', false, Json::error_handler_t::replace);
  out += '\n';
}

Json input_json(const SessionInput& row) {
  const PortTarget& t = row.target;
  Json out{row.take, row.tick, int(t.mode), int(t.firm)};
  for (const double x : t.pose.p) out.push_back(x);
  for (const double x : t.pose.R.coeffs()) out.push_back(x);  // x y z w
  for (const double x : t.twist) out.push_back(x);
  for (const double x : t.grip) out.push_back(x);
  return out;
}
// A whole number: JSON has others too.
template <class Int>
Int whole(const Json& json) {
  if (!json.is_number_integer() || !std::in_range<Int>(json.get<std::int64_t>()))
    throw std::runtime_error(json.dump() + " must be a whole number");
  return Int(json.get<std::int64_t>());
}

SessionInput input_in(const Json& json) {
  SessionInput out{.take = whole<int>(json.at(0)), .tick = whole<std::int64_t>(json.at(1))};
  PortTarget& t = out.target;
  t.mode = PortTarget::Mode(whole<int>(json.at(2)));
  t.firm = whole<int>(json.at(3)) != 0;
  const auto at = [&](std::size_t k) { return json.at(4 + k).get<double>(); };
  for (std::size_t k = 0; k < 3; ++k) t.pose.p[Eigen::Index(k)] = at(k), t.grip[Eigen::Index(k)] = at(13 + k);
  t.pose.R = Quat(at(6), at(3), at(4), at(5));
  for (std::size_t k = 0; k < 6; ++k) t.twist[Eigen::Index(k)] = at(7 + k);
  return out;
}

bool same(const SessionTake& a, const SessionTake& b) {
  return a.parent == b.parent && a.begins == b.begins && a.ends == b.ends;
}

// A line of the journal, put where it belongs.
void take_line(const Json& line, SessionLog& log) {
  const std::string word = line.items().begin().key();
  const Json& v = line.items().begin().value();
  if (word == "take") {
    const auto k = whole<std::size_t>(v.at(0));
    if (k > log.takes.size()) throw std::runtime_error("take " + std::to_string(k) + " is out of order");
    if (k == log.takes.size()) log.takes.emplace_back();
    log.takes[k] = {whole<int>(v.at(1)), whole<std::int64_t>(v.at(2)), whole<std::int64_t>(v.at(3))};
  } else if (word == "input") {
    log.inputs.push_back(input_in(v));
  } else if (word == "change") {
    log.changes.push_back({whole<int>(v.at(0)), whole<std::int64_t>(v.at(1)), v.at(2).get<std::string>(),
                           v.at(3).get<double>()});
  } else if (word == "mark") {
    log.marks.push_back({whole<int>(v.at(0)), whole<std::int64_t>(v.at(1)), v.at(2).get<std::string>(),
                         v.at(3).get<std::string>()});
  } else if (word == "hash") {
    log.hashes.push_back({whole<int>(v.at(0)), whole<std::int64_t>(v.at(1)),
                          std::stoull(v.at(2).get<std::string>(), nullptr, 16)});
  } else {
    throw std::runtime_error("'" + word + "' is unknown");
  }
}

// Rows of a write that was cut off before it said how far its takes go.
void drop_beyond(SessionLog& log) {
  const auto ends = [&](int take) {
    return take >= 0 && std::size_t(take) < log.takes.size() ? log.takes[std::size_t(take)].ends
                                                             : std::int64_t{-1};
  };
  std::erase_if(log.inputs, [&](const SessionInput& r) { return r.tick >= ends(r.take); });
  std::erase_if(log.changes, [&](const SessionChange& r) { return r.tick >= ends(r.take); });
  std::erase_if(log.marks, [&](const SessionMark& r) { return r.moment > ends(r.take); });
  std::erase_if(log.hashes, [&](const SessionHash& r) { return r.moment > ends(r.take); });
}

// What a killed session left becomes "session_left_1.h5", "session_left_2.h5", ...
void keep_left(const std::filesystem::path& growing, const std::filesystem::path& path) {
  if (!std::filesystem::exists(growing) || !is_journal(growing)) return;
  std::filesystem::path kept;
  for (int k = 1; kept.empty() || std::filesystem::exists(kept); ++k)
    kept = path.parent_path() /
           (path.stem().string() + "_left_" + std::to_string(k) + path.extension().string());
  try {
    write_session(kept, read_journal(growing));
  } catch (const std::runtime_error&) {  // damaged: as it is
    std::filesystem::copy_file(growing, kept);
  }
}

}  // namespace

struct SessionWriter::Impl {
  std::filesystem::path path{};
  std::FILE* file = nullptr;
  WriterLock lock{};
  std::vector<SessionTake> takes{};
  std::size_t inputs = 0, changes = 0, marks = 0, hashes = 0;

  ~Impl() {
    if (file) std::fclose(file);
  }
  void append(const std::string& text) const {
    if (std::fwrite(text.data(), 1, text.size(), file) != text.size() || std::fflush(file) != 0)
      throw std::runtime_error(growing_name(path).string() + ": cannot be written: " + std::strerror(errno));
  }
};

SessionWriter::SessionWriter(std::filesystem::path path, const std::map<std::string, std::string>& notes)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = std::move(path);
  const std::filesystem::path growing = growing_name(impl_->path);
  {
    WriterLock left(growing);
    keep_left(growing, impl_->path);
    left.remove_file();
    impl_->file = std::fopen(growing.c_str(), "wbx");
    if (!impl_->file)
      throw std::runtime_error(growing.string() + ": cannot be created: " + std::strerror(errno));
  }
  impl_->lock = WriterLock(growing);
  std::string head;
  add_line(head, kJournal, Json{{"version", kJournalVersion}, {"notes", notes}});
  impl_->append(head);
}

SessionWriter::SessionWriter(SessionWriter&&) noexcept = default;
SessionWriter::~SessionWriter() = default;

void SessionWriter::write(const SessionLog& log) {
  require(impl_->file, "SessionWriter::write: the session is closed");
  Impl& at = *impl_;
  std::string out;
  for (; at.inputs < log.inputs.size(); ++at.inputs)
    add_line(out, "input", input_json(log.inputs[at.inputs]));
  for (; at.changes < log.changes.size(); ++at.changes) {
    const SessionChange& r = log.changes[at.changes];
    add_line(out, "change", {r.take, r.tick, r.name, r.value});
  }
  for (; at.marks < log.marks.size(); ++at.marks) {
    const SessionMark& r = log.marks[at.marks];
    add_line(out, "mark", {r.take, r.moment, r.kind, r.text});
  }
  for (; at.hashes < log.hashes.size(); ++at.hashes) {
    const SessionHash& r = log.hashes[at.hashes];
    add_line(out, "hash", {r.take, r.moment, hex_text(r.hash)});
  }
  for (std::size_t k = 0; k < log.takes.size(); ++k) {  // at the end: what they count was written before
    const SessionTake& r = log.takes[k];
    if (k < at.takes.size() && same(at.takes[k], r)) continue;
    add_line(out, "take", {k, r.parent, r.begins, r.ends});
  }
  at.takes = log.takes;
  at.append(out);
}

void SessionWriter::close() {
  if (!impl_->file) return;
  std::fclose(std::exchange(impl_->file, nullptr));
  const std::filesystem::path growing = growing_name(impl_->path);
  write_session(impl_->path, read_journal(growing));
  impl_->lock.remove_file();
}

bool is_journal(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(std::strlen(kJournal) + 2, ' ');
  return file.read(begin.data(), std::streamsize(begin.size())) && begin == "{\"" + std::string(kJournal);
}

SessionData read_journal(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  SessionData out;
  int number = 0;
  for (std::size_t begin = 0, end = text.find('\n'); end != text.npos;
       begin = end + 1, end = text.find('\n', begin)) {
    ++number;
    try {
      const Json line = Json::parse(text.begin() + std::ptrdiff_t(begin), text.begin() + std::ptrdiff_t(end));
      if (!line.is_object() || line.size() != 1) throw std::runtime_error("must be an object of one field");
      if (number > 1) {
        take_line(line, out.log);
        continue;
      }
      const Json& head = line.at(kJournal);
      if (head.at("version") != kJournalVersion)
        throw std::runtime_error("version = " + head.at("version").dump() + " must be 1");
      for (const auto& [name, note] : head.at("notes").items()) out.notes[name] = note.get<std::string>();
    } catch (const std::exception& wrong) {
      throw std::runtime_error(path.string() + ":" + std::to_string(number) + ": " + wrong.what());
    }
  }
  if (number == 0) throw std::runtime_error(path.string() + ":1: is no journal");
  drop_beyond(out.log);
  if (out.log.takes.empty()) out.log.takes.emplace_back();
  try {
    validate(out.log);
  } catch (const std::invalid_argument& wrong) {
    throw std::runtime_error(path.string() + ": " + wrong.what());
  }
  return out;
}

}  // namespace aussois
