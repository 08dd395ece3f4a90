// SPDX-License-Identifier: Apache-2.0
#include "station/live_session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/check.hpp"
#include "geometry/settings.hpp"
#include "io/record.hpp"
#include "mechanics/model.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;
using Seconds = std::chrono::duration<double>;

constexpr std::size_t kShown = 2000;        // contacts of a frame
constexpr double kFramePeriod = 1.0 / 60;   // [s]
constexpr double kPaceOver = 1;             // wall time over which the pace is measured [s]
constexpr std::size_t kLongestText = 1000;  // of a mark

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

LiveMesh mesh_of(const RunMesh& mesh) {
  LiveMesh out{.vertices = mesh.vertices, .faces = mesh.faces, .wires = mesh.wires};
  out.hash = content_hash(out);
  return out;
}

Json number_or_null(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

Json parameters_json(const SessionParameters& parameters) {
  Json out = Json::array();
  for (const SettingValue& one : values_of(parameters))
    out.push_back({{"name", one.path},
                   {"value", number_or_null(std::stod(one.value))},
                   {"what", one.setting.what},
                   {"unit", one.setting.unit},
                   {"bound", range_text(one.setting.range)}});
  return out;
}

// A field of what a page asks, of the type that it must have.
template <class T>
T field(const Json& json, const char* name) {
  const auto at = json.find(name);
  require(at != json.end(), std::string(name) + " is missing");
  const bool fits = std::is_same_v<T, std::string> ? at->is_string()
                    : std::is_same_v<T, double>    ? at->is_number()
                    : std::is_same_v<T, bool>
                        ? at->is_boolean()
                        : at->is_number_integer() && (!at->is_number_unsigned() ||
                                                      std::in_range<std::int64_t>(at->get<std::uint64_t>()));
  require(fits, std::string(name) + " = " + dump(*at) + " must be a " +
                    (std::is_same_v<T, std::string> ? "text"
                     : std::is_same_v<T, bool>      ? "truth value"
                                                    : "number"));
  return at->get<T>();
}

int take(const Json& json, const char* name) {
  const auto value = field<std::int64_t>(json, name);
  require_field(std::in_range<int>(value), name, value, "be that of a take");
  return int(value);
}

}  // namespace

LiveSession::LiveSession(Session session, LiveOptions options)
    : session_(std::move(session)), options_(std::move(options)), writer_(options_.file, options_.notes) {
  const RunHeader header = run_header(session_.model());
  std::map<std::string, int> place;
  for (const auto& [name, mesh] : header.meshes) {
    place[name] = int(meshes_.size());
    meshes_.push_back(mesh_of(mesh));
  }
  for (const RunBody& body : header.bodies) mesh_of_.push_back(body.mesh.empty() ? -1 : place.at(body.mesh));
  origin_ = pose(session_.state(), session_.port().body).p;
  Json bodies = Json::array();
  const Model& model = session_.model();
  for (const BodyId b : model.bodies.ids()) {
    const int mesh = mesh_of_[std::size_t(b.index())];
    bodies.push_back(
        {{"name", model.bodies[b].name},
         {"mesh", mesh < 0 ? Json(nullptr) : Json(std::to_string(meshes_[std::size_t(mesh)].hash))},
         {"fixed", !has_inertia(model.bodies[b])}});
  }
  facts_ = dump({{"title", options_.title},
                 {"bodies", bodies},
                 {"moving", session_.port().body.index()},
                 {"origin", {origin_.x(), origin_.y(), origin_.z()}},
                 {"hold", options_.hold}});
  stay_ = stay();
  tell_parameters();
  publish();
  thread_ = std::thread([this] { run(); });
}

LiveSession::~LiveSession() {
  end();
}

void LiveSession::end() {
  stop_ = true;
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (saving_.joinable()) saving_.join();
}

void LiveSession::begin() {
  begun_ = true;
  wake_.notify_all();
}

void LiveSession::hand(const LiveCommand& command, From from) {
  if (command.mode == LiveCommand::Mode::none) must_let_go_ = false;
  if (must_let_go_) return;
  (from == From::page ? hand_ : space_mouse_).set({command, Clock::now()});
  wake_.notify_all();
}

void LiveSession::let_go() {
  hand_.set({});
  space_mouse_.set({});
  device_.set({});
}

LiveSession::Hand LiveSession::hand_now() const {
  const Hand mouse = space_mouse_.get();
  const bool moves =
      mouse.command.mode != LiveCommand::Mode::none && Seconds(Clock::now() - mouse.at).count() < kHandLost;
  return moves ? mouse : hand_.get();
}

void LiveSession::device(const std::optional<SE3>& handle) {
  if (!handle) must_let_go_ = false;
  device_.set({must_let_go_ ? std::nullopt : handle, Clock::now()});
  if (handle) wake_.notify_all();
}

bool LiveSession::is_led() const {
  const DeviceHand device = device_.get();
  const Hand hand = hand_now();
  const auto fresh = [](Clock::time_point at) { return Seconds(Clock::now() - at).count() < kHandLost; };
  return (device.handle && fresh(device.at)) ||
         (hand.command.mode != LiveCommand::Mode::none && fresh(hand.at));
}

void LiveSession::ask(std::uint64_t page, const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  require(json.is_object(), "a message must be a JSON object");
  Request out{.page = page, .kind = field<std::string>(json, "kind")};
  std::vector<std::string> known{"kind"};
  const auto also = [&](const char* name) {
    known.emplace_back(name);
    return name;
  };
  if (out.kind == "set") {
    out.name = field<std::string>(json, also("name"));
    out.value = field<double>(json, also("value"));
  } else if (out.kind == "mark") {
    out.name = field<std::string>(json, also("text"));
    require_field(out.name.size() <= kLongestText, "bytes of text", out.name.size(), "be at most 1000");
    out.take = -1;  // now
    if (json.contains("take")) {
      out.take = take(json, also("take"));
      out.moment = field<std::int64_t>(json, also("moment"));
    }
  } else if (out.kind == "seek") {
    out.take = take(json, also("take"));
    out.moment = field<std::int64_t>(json, also("moment"));
  } else if (out.kind == "pause") {
    out.value = field<bool>(json, also("on"));
  } else {
    require(out.kind == "save", "kind = " + out.kind + " must be one of: set, mark, seek, pause, save");
  }
  for (const auto& [name, value] : json.items())
    require(std::ranges::find(known, name) != known.end(), "field '" + name + "' is unknown");
  require(requests_.put(out), "too many requests wait");
  wake_.notify_all();
}

std::string LiveSession::facts() const {
  Json out = Json::parse(facts_);
  out["parameters"] = Json::parse(parameters_.get());
  return dump(out);
}

void LiveSession::run() {
  Clock::time_point due = Clock::now();
  try {
    while (!stop_) {
      take_requests();
      if (!begun_ || (paused_ && !is_led())) {
        if (!std::exchange(idle_, true)) {
          publish();
          writer_.write(session_.log());
        }
        std::unique_lock lock(wake_mutex_);
        wake_.wait_for(lock, Seconds(kFramePeriod));
        due = Clock::now();
        pace_.clear();
        continue;
      }
      paused_ = idle_ = false;
      tick();
      due += std::chrono::duration_cast<Clock::duration>(Seconds(session_.parameters().tick));
      const Clock::time_point now = Clock::now();
      if (due < now) due = now;  // slow motion: no hurry afterwards
      if (now - published_ >= Seconds(kFramePeriod)) publish();
      std::this_thread::sleep_until(due);
    }
    session_.add_hash();
    writer_.write(session_.log());
    writer_.close();
  } catch (const std::exception& error) {  // the disk is full, say: what was flushed stays
    failure_.set(error.what());
    failed_ = true;
    (void)answers_.put({0, dump({{"kind", "closing"}, {"why", error.what()}})});
  }
}

void LiveSession::take_requests() {
  const std::vector<Request> all = requests_.take_all();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Request& request = all[i];
    idle_ = false;
    const auto later = [](const Request& other) { return other.kind == "seek"; };
    if (request.kind == "seek" && std::any_of(all.begin() + std::ptrdiff_t(i) + 1, all.end(), later))
      continue;
    try {
      do_request(request);
    } catch (const std::exception& refused) {
      (void)answers_.put(
          {request.page, dump({{"kind", "refused"}, {"what", request.kind}, {"why", refused.what()}})});
    }
  }
}

void LiveSession::do_request(const Request& request) {
  if (request.kind == "set") {
    session_.change(request.name, request.value);
    tell_parameters();
  } else if (request.kind == "mark") {
    session_.mark(request.name, request.take, request.moment);
    tell_marks();
  } else if (request.kind == "pause") {
    paused_ = request.value != 0;
    if (paused_) {
      must_let_go_ = true;
      let_go();
    }
  } else if (request.kind == "seek") {
    last_ = session_.seek(request.take, request.moment);
    must_let_go_ = true;
    let_go();
    paused_ = true;
    holding_ = false, free_until_ = 0;
    stay_ = stay();
    tell_parameters();
    publish();
  } else if (request.kind == "save") {
    save(request.page);
  }
}

void LiveSession::tick() {
  last_ = session_.tick(target());
  measure_pace();
  show_port();
  if (session_.moment() % Session::kBlock == 0) writer_.write(session_.log());
  tell_marks();
}

// The part as it is, held where the hand held it last.
PortTarget LiveSession::stay() const {
  const SE3& g = pose(session_.state(), session_.port().body);
  const Vec3 grip = stay_.grip;
  return {.mode = PortTarget::Mode::pose, .pose = {g.R, g * grip}, .grip = grip, .firm = true};
}

// A hold has one grip: another hand, or another point of the part, takes hold anew.
PortTarget LiveSession::target() {
  PortTarget out = wanted();
  const State& state = session_.state();
  const Port& port = session_.port();
  if (out.mode == PortTarget::Mode::none || !is_held(state, port) ||
      port_hold(state, port.place).grip == out.grip)
    return out;
  stay_.grip = out.grip;
  return {};
}

PortTarget LiveSession::wanted() {
  const DeviceHand device = device_.get();
  if (device.handle && Seconds(Clock::now() - device.at).count() < kHandLost) {
    holding_ = true;
    stay_.grip.setZero();
    return {.mode = PortTarget::Mode::pose, .pose = *device.handle};
  }
  const Hand hand = hand_now();
  const double silent = Seconds(Clock::now() - hand.at).count();
  const LiveCommand& c = hand.command;
  if (c.mode == LiveCommand::Mode::none || silent > kHandLost) {
    if (holding_)
      free_until_ =
          session_.moment() + std::int64_t(session_.port().options.ramp / session_.parameters().tick);
    const bool lets_go = std::exchange(holding_, false) || session_.moment() < free_until_;
    if (lets_go || !options_.hold) return {};
    if (session_.moment() == free_until_) stay_ = stay();
    return stay_;
  }
  const SE3& g_bs = session_.model().bodies[session_.port().body].g_bs;
  PortTarget out{.grip = g_bs * c.grip, .firm = c.firm};
  if (c.mode == LiveCommand::Mode::pose) {
    out.mode = PortTarget::Mode::pose;
    out.pose = {(c.pose.R * g_bs.R.conjugate()).normalized(), c.pose.p};
  } else {
    out.mode = PortTarget::Mode::twist;
    const Quat& R = pose(session_.state(), is_held(session_.state(), session_.port()) ? session_.port().handle
                                                                                      : session_.port().body)
                        .R;
    if (silent <= kHandStands) out.twist << c.twist.head<3>(), R.conjugate() * Vec3(c.twist.tail<3>());
  }
  stay_.grip = out.grip;
  holding_ = true;
  return out;
}

void LiveSession::show_port() {
  const State& state = session_.state();
  const Port& port = session_.port();
  const Energy now = energy(session_.model(), state);
  put_in_ += last_.put_in;
  for (const StepReport& step : last_.steps) put_in_ += std::max(0.0, step.energy.gravity_work);
  view_.set({.moment = session_.moment(),
             .body = {pose(state, port.body), twist(state, port.body)},
             .hold = port_hold(state, port.place),
             .limits = port.options.limits,
             .stored = now.kinetic + now.laws,
             .put_in = put_in_,
             .slow = slow_,
             .at = Clock::now()});
}

void LiveSession::measure_pace() {
  const Clock::time_point now = Clock::now();
  pace_.emplace_back(now, session_.state().t);
  while (pace_.size() > 2 && now - pace_.front().first > Seconds(kPaceOver)) pace_.erase(pace_.begin());
  const double wall = Seconds(now - pace_.front().first).count();
  if (wall > 0.1) slow_ = (pace_.back().second - pace_.front().second) / wall;
}

void LiveSession::publish() {
  const State& state = session_.state();
  const Model& model = session_.model();
  const Port& port = session_.port();
  LiveFrame out{
      .t = state.t, .moment = session_.moment(), .take = std::uint32_t(session_.take()), .slow = slow_};
  out.ends = session_.log().takes[std::size_t(session_.take())].ends;
  const PortPull pull = port_pull(state, port);
  out.pull = pull.force, out.torque = pull.torque;
  const bool at_limit = is_at_limit(pull, port.options.limits);
  bool unsolved = false;
  for (const StepReport& step : last_.steps) {
    out.distance = std::min(out.distance, step.min_base_distance);
    unsolved = unsolved || (step.moved() && !step.ok());
  }
  out.flags = (holding_ ? kLiveHeld : 0u) | (paused_ ? kLivePaused : 0u) | (at_limit ? kLiveLimit : 0u) |
              (unsolved ? kLiveUnsolved : 0u) | (!last_.steps.empty() && !last_.whole() ? kLiveRefused : 0u);
  for (const BodyId b : model.bodies.ids()) out.meshes.push_back(state.g[b] * model.bodies[b].g_bs);
  if (!last_.steps.empty()) {
    const StepReport& step = last_.steps.back();
    double least = kInf;
    for (const StepContact& c : step.contacts) {
      out.contacts.push_back({.point = c.point.x_a,
                              .normal = c.point.normal,
                              .force = step.h > 0 ? Vec3(c.impulse / step.h) : Vec3::Zero(),
                              .gap = c.point.gap,
                              .a = int(c.point.a.body.index()),
                              .b = int(c.point.b.body.index())});
      if (c.point.gap < least) least = c.point.gap, out.near_a = c.point.x_a, out.near_b = c.point.x_b;
    }
    out.all_contacts = std::uint32_t(step.contacts.size());
    std::ranges::stable_sort(out.contacts, std::greater{},
                             [](const LiveContact& c) { return c.force.squaredNorm(); });
    if (out.contacts.size() > kShown) out.contacts.resize(kShown);
  }
  out.serial = ++serial_;
  frame_.set(std::move(out));
  published_ = Clock::now();
}

void LiveSession::tell_marks() {
  const std::vector<SessionMark>& marks = session_.log().marks;
  for (; marks_told_ < marks.size(); ++marks_told_) {
    const SessionMark& mark = marks[marks_told_];
    (void)answers_.put({0, dump({{"kind", "event"},
                                 {"take", mark.take},
                                 {"moment", mark.moment},
                                 {"what", mark.kind},
                                 {"text", mark.text}})});
  }
}

void LiveSession::tell_parameters() {
  const Json parameters = parameters_json(session_.parameters());
  parameters_.set(dump(parameters));
  (void)answers_.put({0, dump({{"kind", "parameters"}, {"parameters", parameters}})});
}

void LiveSession::save(std::uint64_t page) {
  session_.add_hash();
  writer_.write(session_.log());
  if (!options_.save) {
    (void)answers_.put({page, dump({{"kind", "saved"}, {"text", "session"}})});
    return;
  }
  require(!is_saving_, "a save is going on");
  if (saving_.joinable()) saving_.join();
  is_saving_ = true;
  saving_ = std::thread([this, page, log = session_.log(), take = session_.take()] {
    try {
      (void)answers_.put({page, dump({{"kind", "saved"}, {"text", options_.save(log, take)}})});
    } catch (const std::exception& error) {
      (void)answers_.put({page, dump({{"kind", "refused"}, {"what", "save"}, {"why", error.what()}})});
    }
    is_saving_ = false;
  });
}

}  // namespace aussois
