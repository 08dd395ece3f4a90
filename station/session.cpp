// SPDX-License-Identifier: Apache-2.0
#include "station/session.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"
#include "geometry/digest.hpp"
#include "station/take_reader.hpp"

namespace aussois {
namespace {

constexpr double kMinute = 60;  // of states that are kept closely [s]
constexpr double kQuiet = 0.2;  // before the same is marked again [s]

std::size_t bytes_of(const State& state) {
  return sizeof(State) + state.g.size() * sizeof(SE3) +
         sizeof(double) *
             std::size_t(state.v.size() + state.q.size() + state.r.size() + state.a.size() + state.u.size()) +
         sizeof(int) * state.turns.size() + state.memory.contacts.size() * sizeof(RememberedContact);
}

// To the last bit: the state takes them as they are.
bool same(const PortTarget& a, const PortTarget& b) {
  const auto bits = [](const PortTarget& t) {
    Digest out;
    out.add(std::uint64_t(t.mode)), out.add(std::uint64_t(t.firm));
    out.add(t.pose.p), out.add(t.grip);
    for (const double x : t.pose.R.coeffs()) out.add(x);
    for (const double x : t.twist) out.add(x);
    return out.value;
  };
  return bits(a) == bits(b);
}

void check_target(const PortTarget& target) {
  (void)checked_pose(target.pose, "PortTarget::pose");
  require(target.twist.allFinite(), "PortTarget::twist must be finite");
  require(target.grip.allFinite(), "PortTarget::grip must be finite");
}

void make_changes(SessionStage& stage, const std::vector<SessionChange>& changes) {
  if (changes.empty()) return;
  SessionParameters parameters = stage.parameters();
  for (const SessionChange& change : changes) set_parameter(parameters, change.name, change.value);
  stage.use(stage.change_to(parameters));
}

// The take of the past of `take` to which a moment belongs.
int owner(const SessionLog& log, int take, std::int64_t moment) {
  while (moment < log.takes[std::size_t(take)].begins) take = log.takes[std::size_t(take)].parent;
  return take;
}

}  // namespace

Session::Session(SessionMaker make, const SessionParameters& parameters, const SessionOptions& options)
    : stage_(std::move(make), parameters, options), options_(options) {
  log_.takes.push_back({});
  keep();
}

const SessionParameters& Session::parameters() const {
  return next_ ? next_->parameters : stage_.parameters();
}

void Session::begin_take() {
  log_.takes.push_back({.parent = take_, .begins = moment_, .ends = moment_});
  take_ = int(log_.takes.size()) - 1;
}

TickReport Session::tick(const PortTarget& target) {
  check_target(target);
  if (moment_ < log_.takes[std::size_t(take_)].ends) begin_take();
  for (const SessionChange& change : changes_)
    log_.changes.push_back({take_, moment_, change.name, change.value});
  if (next_) stage_.use(*next_);
  next_.reset(), changes_.clear();
  if (!said_ || !same(*said_, target)) log_.inputs.push_back({take_, moment_, target});
  said_ = target;
  TickReport report = stage_.advance(target);
  log_.takes[std::size_t(take_)].ends = ++moment_;
  mark_by_itself(report);
  if (moment_ % kBlock == 0) add_hash(), keep();
  return report;
}

void Session::change(const std::string& name, double value) {
  SessionParameters parameters = this->parameters();
  set_parameter(parameters, name, value);
  next_ = stage_.change_to(parameters);
  changes_.push_back({take_, moment_, name, value});
}

void Session::mark(const std::string& text, int take, std::int64_t moment) {
  if (take < 0) return add_mark("note", text);
  check_moment(take, moment);
  log_.marks.push_back({owner(log_, take, moment), moment, "note", text});
}

void Session::check_moment(int take, std::int64_t moment) const {
  require_field(take >= 0 && std::size_t(take) < log_.takes.size(), "take", take,
                ("lie in [0, " + std::to_string(log_.takes.size()) + ")").c_str());
  const std::int64_t last = log_.takes[std::size_t(take)].ends;
  require_field(moment >= 0 && moment <= last, "moment", moment,
                ("lie in [0, " + std::to_string(last) + "]").c_str());
}

void Session::add_mark(const char* kind, const std::string& text) {
  log_.marks.push_back({take_, moment_, kind, text});
}

void Session::mark_by_itself(const TickReport& report) {
  bool touches = false;
  for (const StepReport& step : report.steps)
    for (const StepContact& contact : step.contacts) touches = touches || !contact.impulse.isZero(0);
  const Port& p = stage_.port();
  const State& s = stage_.state();
  const PortPull pull = port_pull(s, p);
  const bool limit = is_at_limit(pull, p.options.limits);
  const auto begins = [&](std::int64_t& last, bool is) {
    const bool fresh = is && double(moment_ - last) * stage_.parameters().tick > kQuiet;
    if (is) last = moment_;
    return fresh;
  };
  if (begins(touched_, touches)) add_mark("touch", "a part is touched");
  if (begins(limited_, limit)) add_mark("limit", "the pull of the hand is at its limit");
  if (begins(refused_, !report.whole()))
    add_mark("refused", report.steps.empty() ? "no step was taken" : report.steps.back().reason);
}

void Session::add_hash() {
  if (moment_ == 0) return;
  const bool there =
      !log_.hashes.empty() && log_.hashes.back().take == take_ && log_.hashes.back().moment == moment_;
  if (!there) log_.hashes.push_back({take_, moment_, hash(stage_.state())});
}

void Session::keep() {
  const auto [at, fresh] = kept_.try_emplace({take_, moment_}, Kept{stage_.state(), stage_.parameters()});
  if (!fresh) return;
  bytes_ += bytes_of(at->second.state);
  if (moment_ % kOldBlock == 0 || bytes_ > options_.memory) thin_out();
}

// States of the last minute stay, older ones each kOldBlock ticks. If that is too much memory, fewer of the
// old ones stay, and then fewer of all.
void Session::thin_out() {
  const std::int64_t minute = std::int64_t(kMinute / stage_.parameters().tick);
  const auto drop = [&](std::int64_t old_spacing, std::int64_t near_spacing) {
    for (auto it = kept_.begin(); it != kept_.end();) {
      const auto [take, moment] = it->first;
      const bool near = moment > moment_ - minute && take == owner(log_, take_, moment);
      if (moment % (near ? near_spacing : old_spacing) == 0) {
        ++it;
        continue;
      }
      bytes_ -= bytes_of(it->second.state);
      it = kept_.erase(it);
    }
    return bytes_ <= options_.memory;
  };
  std::int64_t old_spacing = kOldBlock;
  while (!drop(old_spacing, kBlock) && old_spacing <= moment_) old_spacing *= 2;
  for (std::int64_t near = 2 * kBlock; bytes_ > options_.memory && near <= 2 * moment_; near *= 2)
    drop(old_spacing, near);
}

TickReport Session::seek(int take, std::int64_t moment) {
  check_moment(take, moment);
  if (moment_ == log_.takes[std::size_t(take_)].ends) add_hash();
  const int of = owner(log_, take, moment);
  int from = of;
  std::int64_t at =
      std::max<std::int64_t>(0, moment - 1);  // so that the last tick is taken, and its report known
  if (at < log_.takes[std::size_t(from)].begins) from = owner(log_, from, at);
  auto kept = kept_.upper_bound({from, at});
  while (kept == kept_.begin() || std::prev(kept)->first.first != from) {
    at = log_.takes[std::size_t(from)].begins;
    from = log_.takes[std::size_t(from)].parent;
    kept = kept_.upper_bound({from, at});
  }
  --kept;
  const TakeReader reader(log_, of);
  TickReport last;
  stage_.restore(kept->second.state, kept->second.parameters);
  for (std::int64_t tick = kept->first.second; tick < moment; ++tick) {
    make_changes(stage_, reader.changes(tick));
    last = stage_.advance(reader.input(tick));
  }
  take_ = of, moment_ = moment;
  next_.reset(), changes_.clear(), said_.reset();
  touched_ = limited_ = refused_ = moment;
  return last;
}

TakeRepeat repeat_take(const SessionLog& log, int take, SessionStage& stage,
                       const std::function<bool(const SessionStage&, const TickReport&)>& look) {
  validate(log);
  const TakeReader reader(log, take);
  TakeRepeat out;
  std::size_t next = 0;
  const std::vector<SessionHash>& hashes = reader.hashes();
  for (std::int64_t tick = 0; tick < reader.ends() && out.differs < 0; ++tick) {
    make_changes(stage, reader.changes(tick));
    const TickReport report = stage.advance(reader.input(tick));
    ++out.ticks;
    for (; next < hashes.size() && hashes[next].moment == tick + 1; ++next, ++out.hashes)
      if (hashes[next].hash != hash(stage.state())) out.differs = tick + 1;
    if (look && !look(stage, report)) break;
  }
  return out;
}

}  // namespace aussois
