// SPDX-License-Identifier: Apache-2.0
// A hand that plays what it is told: for sessions without a page (doc/howto/assemble_by_hand.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "station/session.hpp"

namespace aussois {

struct HandCommand {
  enum class Kind { grab, move, wait, release, set, mark, seek };
  Kind kind = Kind::wait;
  double time = 0;           // how long it takes; of seek, how far it goes back [s]
  Vec3 grip = Vec3::Zero();  // of grab, in the frame of the body [m]
  bool firm = true;          // of grab
  Vec3 by = Vec3::Zero();    // of move, world [m]
  Vec3 turn = Vec3::Zero();  // of move, a rotation vector in the world [rad]
  std::string text{};        // of mark; of set the name of a parameter
  double value = 0;          // of set
};
inline constexpr Named<HandCommand::Kind> kHandCommands[] = {
    {HandCommand::Kind::grab, "grab"}, {HandCommand::Kind::move, "move"},
    {HandCommand::Kind::wait, "wait"}, {HandCommand::Kind::release, "release"},
    {HandCommand::Kind::set, "set"},   {HandCommand::Kind::mark, "mark"},
    {HandCommand::Kind::seek, "seek"}};

/// A list of objects, as the text of a JSON file. Throws std::runtime_error naming `file` and what is wrong:
/// the line, or the command, the field, its value and its bound.
std::vector<HandCommand> hand_commands_in(const std::string& text, const std::string& file);

/// How long the commands take [s].
double duration(const std::vector<HandCommand>& commands);

/// Plays the commands; `go_on(report)` is called after each tick. False: it ended it. Throws
/// std::invalid_argument naming the command that the session refuses.
bool play(const std::vector<HandCommand>& commands, Session& session,
          const std::function<bool(const TickReport&)>& go_on);

}  // namespace aussois
