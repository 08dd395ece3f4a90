// SPDX-License-Identifier: Apache-2.0
// What a session plays on: a scene with a port that advances by ticks, and parameters that change between
// them (SES-1), (SES-2).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "integrators/scheme.hpp"
#include "mechanics/state.hpp"
#include "ports/port.hpp"

namespace aussois {

/// What may be changed between two ticks. `describe` gives names, units and ranges.
struct SessionParameters {
  double tick = 1e-3;                // [s]
  double mu = 0.2;                   // friction of all pairs [-]
  double restitution = 0;            // [-]
  Vec3 gravity = {0, 0, -kGravity};  // [m/s^2]
  double dilation = 1e-4;            // of each part [m]
  PortOptions port{};
};
void describe(SettingVisitor& visit, SessionParameters& parameters);
/// Sets the parameter at a path, such as "mu" or "port.gains.stiffness". Throws std::invalid_argument,
/// listing all, for one that is unknown, and for a value out of its range.
void set_parameter(SessionParameters& parameters, const std::string& name, double value);

struct SessionScene {
  Model model{};
  State start{};
  Port port{};
};
/// Makes the scene at other parameters. Bodies, joints and coordinates must be the same each time.
using SessionMaker = std::function<SessionScene(const SessionParameters&)>;

struct SessionOptions {
  std::string scheme = "moreau_jean";
  SchemeOptions options{};                      // the tick is the largest step
  std::size_t memory = std::size_t{256} << 20;  // for states to go back to [bytes]
};

/// What came of a tick.
struct TickReport {
  std::vector<StepReport> steps{};
  double put_in = 0;                                                     // by gains that grew [J]
  bool whole() const { return !steps.empty() && steps.back().moved(); }  // false: its rest was refused
};

class SessionStage {
 public:
  /// Throws what the maker, make_scheme and validate_start throw.
  SessionStage(SessionMaker make, const SessionParameters& parameters, const SessionOptions& options);

  /// A scene at other parameters, for `use`; a moment of the session that does not fit is refused.
  struct Change {
    SessionParameters parameters{};
    std::shared_ptr<const SessionScene> scene{};
    bool same_shapes = true;
  };
  /// Throws std::invalid_argument if the present state does not fit: dilated parts would overlap too much.
  Change change_to(const SessionParameters& parameters) const;
  void use(const Change& change);

  /// One tick (SES-1). Where a step is refused the rest of the tick is left out.
  TickReport advance(const PortTarget& target);
  /// Goes to a state that was here before, at the parameters of then.
  void restore(const State& state, const SessionParameters& parameters);

  const Model& model() const { return scene_->model; }
  const Port& port() const { return scene_->port; }
  const State& state() const { return state_; }
  const SessionParameters& parameters() const { return parameters_; }
  const SessionOptions& options() const { return options_; }

 private:
  SessionMaker make_;
  SessionOptions options_;
  SessionParameters parameters_;
  std::shared_ptr<const SessionScene> scene_;
  State state_;
  Scheme scheme_;
};

}  // namespace aussois
