// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/station/hand_script.hpp"

#include <cmath>

#include "examples/common/json_fields.hpp"
#include "geometry/check.hpp"

namespace aussois {
namespace {

using Kind = HandCommand::Kind;

constexpr Range kTime{0, 1e4};                    // [s]
constexpr Range kTurn = {-360 * 100, 360 * 100};  // [deg]

HandCommand command_in(const Json& json, const std::string& where) {
  Fields fields(json, where);
  HandCommand out;
  try {
    out.kind = value_named(fields.text("kind"), "kind", kHandCommands);
  } catch (const std::invalid_argument& wrong) {
    throw std::runtime_error(where + ": " + wrong.what());
  }
  const auto time = [&] { out.time = fields.number("time", kTime); };
  switch (out.kind) {
    case Kind::grab:
      if (fields.has("grip")) out.grip = fields.vector("grip");
      out.firm = fields.flag("firm", true);
      break;
    case Kind::move:
      if (fields.has("by")) out.by = fields.vector("by");
      if (fields.has("turn")) out.turn = kPi / 180 * fields.vector("turn", kTurn);
      time();
      break;
    case Kind::wait:
    case Kind::release:
      time();
      break;
    case Kind::set:
      out.text = fields.text("name");
      out.value = fields.number("value", finite_range());
      break;
    case Kind::mark:
      out.text = fields.text("text");
      break;
    case Kind::seek:
      out.time = fields.number("back", kTime);
      break;
  }
  fields.end();
  return out;
}

// From 0 to 1 with the least jerk.
double smooth(double s) {
  return s * s * s * (10 + s * (6 * s - 15));
}

class Player {
 public:
  Player(Session& session, const std::function<bool(const TickReport&)>& go_on)
      : session_(session), go_on_(go_on) {}

  bool play(const HandCommand& command) {
    switch (command.kind) {
      case Kind::grab:
        grab(command);
        return true;
      case Kind::move:
        return move(command);
      case Kind::wait:
        return ticks(command.time, [](double) {});
      case Kind::release:
        target_ = {};
        return ticks(command.time, [](double) {});
      case Kind::set:
        session_.change(command.text, command.value);
        return true;
      case Kind::mark:
        session_.mark(command.text);
        return true;
      case Kind::seek:
        seek(command.time);
        return true;
    }
    return true;
  }

 private:
  void grab(const HandCommand& command) {
    const SE3& g = pose(session_.state(), session_.port().body);
    target_ = {.mode = PortTarget::Mode::pose,
               .pose = {g.R, g * command.grip},
               .grip = command.grip,
               .firm = command.firm};
  }
  bool move(const HandCommand& command) {
    require(target_.mode == PortTarget::Mode::pose, "move: the hand must hold the part: grab it before");
    const SE3 from = target_.pose;
    return ticks(command.time, [&](double s) {
      target_.pose = {exp_so3(smooth(s) * command.turn) * from.R, from.p + smooth(s) * command.by};
    });
  }
  // Where the hand was then, if it held the part.
  void seek(double back) {
    const auto ticks = std::int64_t(std::lround(back / session_.parameters().tick));
    require_field(ticks <= session_.moment(), "seek: back", back, "not be before the start [s]");
    session_.seek(session_.take(), session_.moment() - ticks);
    const State& state = session_.state();
    const Port& port = session_.port();
    target_ = {};
    if (!is_held(state, port)) return;
    const PortHold hold = port_hold(state, port.place);
    target_ = {.mode = PortTarget::Mode::pose,
               .pose = pose(state, port.handle),
               .grip = hold.grip,
               .firm = hold.gains.rotation_stiffness > 0};
  }
  template <class Lead>
  bool ticks(double time, const Lead& lead) {
    const auto n = std::int64_t(std::lround(time / session_.parameters().tick));
    for (std::int64_t k = 1; k <= n; ++k) {
      lead(double(k) / double(n));
      if (!go_on_(session_.tick(target_))) return false;
    }
    return true;
  }

  Session& session_;
  const std::function<bool(const TickReport&)>& go_on_;
  PortTarget target_{};
};

}  // namespace

std::vector<HandCommand> hand_commands_in(const std::string& text, const std::string& file) {
  try {
    const Json json = parse_json(text);
    if (!json.is_array() || json.empty()) throw std::runtime_error("must be a list of commands");
    std::vector<HandCommand> out;
    for (std::size_t i = 0; i < json.size(); ++i)
      out.push_back(command_in(json[i], "command " + std::to_string(i + 1)));
    return out;
  } catch (const std::exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

double duration(const std::vector<HandCommand>& commands) {
  double sum = 0;
  for (const HandCommand& command : commands)
    if (command.kind != Kind::seek) sum += command.time;
  return sum;
}

bool play(const std::vector<HandCommand>& commands, Session& session,
          const std::function<bool(const TickReport&)>& go_on) {
  Player player(session, go_on);
  for (std::size_t i = 0; i < commands.size(); ++i) {
    try {
      if (!player.play(commands[i])) return false;
    } catch (const std::invalid_argument& wrong) {
      throw std::invalid_argument("command " + std::to_string(i + 1) + ": " + wrong.what());
    }
  }
  return true;
}

}  // namespace aussois
