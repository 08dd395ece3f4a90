// SPDX-License-Identifier: Apache-2.0
#include "station/take_reader.hpp"

#include <algorithm>

#include "geometry/check.hpp"

namespace aussois {

TakeReader::TakeReader(const SessionLog& log, int take) {
  require_field(take >= 0 && std::size_t(take) < log.takes.size(), "take", take,
                ("lie in [0, " + std::to_string(log.takes.size()) + ")").c_str());
  struct Part {
    int take = 0;
    std::int64_t begins = 0, ends = 0;  // the last part owns its last moment
  };
  std::vector<Part> parts;
  ends_ = log.takes[std::size_t(take)].ends;
  std::int64_t end = ends_;
  for (int at = take; at >= 0; at = log.takes[std::size_t(at)].parent) {
    const std::int64_t begins = std::min(log.takes[std::size_t(at)].begins, end);
    parts.push_back({at, begins, end});
    end = begins;
  }
  std::ranges::reverse(parts);
  for (const Part& part : parts) {
    const bool last = part.take == take;
    const auto mine = [&](int of, std::int64_t at, bool with_end) {
      return of == part.take && at >= part.begins && (with_end ? at <= part.ends : at < part.ends);
    };
    for (const SessionInput& row : log.inputs)
      if (mine(row.take, row.tick, false)) inputs_.push_back(&row);
    for (const SessionChange& row : log.changes)
      if (mine(row.take, row.tick, false)) changes_.push_back(&row);
    for (const SessionHash& row : log.hashes)
      if (mine(row.take, row.moment, true)) hashes_.push_back(row);
    for (const SessionMark& row : log.marks)
      if (mine(row.take, row.moment, last)) marks_.push_back(row);
  }
  std::ranges::stable_sort(hashes_, {}, &SessionHash::moment);  // that of a past moment may be written late
  std::ranges::stable_sort(marks_, {}, &SessionMark::moment);
}

const PortTarget& TakeReader::input(std::int64_t tick) const {
  require_field(tick >= 0 && tick < ends_, "tick", tick,
                ("lie in [0, " + std::to_string(ends_) + ")").c_str());
  const auto after =
      std::ranges::upper_bound(inputs_, tick, {}, [](const SessionInput* row) { return row->tick; });
  return (*std::prev(after))->target;
}

std::vector<SessionChange> TakeReader::changes(std::int64_t tick) const {
  std::vector<SessionChange> out;
  const auto tick_of = [](const SessionChange* row) { return row->tick; };
  for (auto at = std::ranges::lower_bound(changes_, tick, {}, tick_of);
       at != changes_.end() && (*at)->tick == tick; ++at)
    out.push_back(**at);
  return out;
}

}  // namespace aussois
