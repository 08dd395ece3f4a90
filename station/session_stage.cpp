// SPDX-License-Identifier: Apache-2.0
#include "station/session_stage.hpp"

#include <stdexcept>

#include "integrators/run.hpp"

namespace aussois {
namespace {

class SetByPath final : public SettingVisitor {
 public:
  SetByPath(const std::string& name, double value) : name_(name), value_(value) {}
  void number(const Setting& setting, double& value) override {
    names += (names.empty() ? "" : ", ") + path(setting);
    if (path(setting) == name_) value = value_, found = true;
  }
  void count(const Setting&, int&) override {}
  void toggle(const Setting&, bool&) override {}
  void seed(const Setting&, std::uint64_t&) override {}
  std::string names{};
  bool found = false;

 private:
  void choose(const Setting&, Choice&) override {}
  const std::string& name_;
  double value_;
};

Scheme scheme_of(const SessionOptions& options, const SessionParameters& parameters, const Model& model) {
  SchemeOptions chosen = options.options;
  chosen.step.h = parameters.tick;
  return make_scheme(options.scheme, model, chosen);
}

void check_same(const SessionScene& now, const SessionScene& before) {
  const auto same = [](const SessionScene& a, const SessionScene& b) {
    return a.model.bodies.size() == b.model.bodies.size() && a.start.v.size() == b.start.v.size() &&
           a.start.u.size() == b.start.u.size() && a.port.handle == b.port.handle &&
           a.port.body == b.port.body;
  };
  if (!same(now, before))
    throw std::logic_error("SessionMaker: bodies, coordinates and port must be the same at all parameters");
}

}  // namespace

void describe(SettingVisitor& visit, SessionParameters& p) {
  visit.begin("SessionParameters");
  visit.number({"tick", "time for which the input of a hand is constant", "s", {1e-5, 1}, "--tick"}, p.tick);
  visit.number(setting_of<ContactLaw>("mu"), p.mu);
  visit.number(setting_of<ContactLaw>("restitution"), p.restitution);
  constexpr const char* kNames[] = {"gravity_x", "gravity_y", "gravity_z"};
  for (int i = 0; i < 3; ++i)
    visit.number({kNames[i], "gravity along an axis of the world", "m/s^2", finite_range()}, p.gravity[i]);
  visit.number({"dilation", "dilation of each part", "m", {0, 1, true}, "--dilation"}, p.dilation);
  visit.group("port", p.port);
}

void set_parameter(SessionParameters& parameters, const std::string& name, double value) {
  SessionParameters next = parameters;
  SetByPath set(name, value);
  describe(set, next);
  require(set.found, "parameter '" + name + "' must be one of: " + set.names);
  check_ranges(next);
  parameters = next;
}

SessionStage::SessionStage(SessionMaker make, const SessionParameters& parameters,
                           const SessionOptions& options)
    : make_(std::move(make)), options_(options), parameters_(parameters) {
  check_ranges(parameters);
  scene_ = std::make_shared<const SessionScene>(make_(parameters));
  state_ = scene_->start;
  validate_start(scene_->model, state_);
  scheme_ = scheme_of(options_, parameters_, scene_->model);
}

SessionStage::Change SessionStage::change_to(const SessionParameters& parameters) const {
  check_ranges(parameters);
  Change out{.parameters = parameters, .same_shapes = parameters.dilation == parameters_.dilation};
  out.scene = std::make_shared<const SessionScene>(make_(parameters));
  check_same(*out.scene, *scene_);
  State state = state_;
  if (!out.same_shapes) state.memory = {};
  validate_start(out.scene->model, state);
  return out;
}

void SessionStage::use(const Change& change) {
  parameters_ = change.parameters;
  scene_ = change.scene;
  if (!change.same_shapes) state_.memory = {};  // its features are those of other shapes
  scheme_ = scheme_of(options_, parameters_, scene_->model);
}

TickReport SessionStage::advance(const PortTarget& target) {
  TickReport out{.put_in = follow(scene_->model, state_, scene_->port, target, parameters_.tick)};
  (void)run(scheme_, state_, state_.t + parameters_.tick, [&](const StepReport& report) {
    out.steps.push_back(report);
    return true;
  });
  return out;
}

void SessionStage::restore(const State& state, const SessionParameters& parameters) {
  if (settings_text(parameters) != settings_text(parameters_)) {
    parameters_ = parameters;
    scene_ = std::make_shared<const SessionScene>(make_(parameters));
    scheme_ = scheme_of(options_, parameters_, scene_->model);
  }
  state_ = state;
}

}  // namespace aussois
