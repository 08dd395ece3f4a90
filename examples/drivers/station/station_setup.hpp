// SPDX-License-Identifier: Apache-2.0
// The scene of a session from the flags of a command line, and again from what a session keeps of them.
#pragma once

#include <optional>

#include "examples/common/scheme_flags.hpp"
#include "examples/drivers/assembly/assembly_flags.hpp"
#include "station/session.hpp"

namespace aussois {

struct StationFlags {
  StationFlags();  // defaults of a hand: no weight, a force that an arm has
  AssemblyFlags parts{};
  SaidSettings said{};
  double tick = 0;  // [s]; 0: from stride and speed, within kTicks
  SchemeFlags scheme{};
};
/// Of a tick that is not told [s].
inline constexpr Range kTicks{1e-3, 1e-2};

/// The groups scene, hand, scheme and solver. `flags` must stay where it is.
void add_options(Cli& cli, StationFlags& flags);

/// All of assembly_station's command line.
struct StationArguments {
  StationFlags station{};
  std::filesystem::path script{};
  bool demo_script = false, no_browser = false;
  bool open = false;     // the page in the user's browser
  bool fall = false;     // a part that is let go
  std::string device{};  // "simulated:soft"; empty: none
  bool spacenav = false;
  double seconds = 0;  // of the clock until it ends; 0: until it is told
  std::string bind = "127.0.0.1";
  bool no_tls_is_known = false;
  int port = 0;
  CommonOptions common{};
};
void add_options(Cli& cli, StationArguments& arguments);
/// With a haptic device, unless the user chose a scheme: (PORT-1) is that of passive_midpoint.
void use_passive_scheme(const Cli& cli, StationArguments& arguments);

struct Station {
  AssemblyInput input{};
  AssemblyScene scene{};
  SessionParameters parameters{};  // at the start
  SessionOptions options{};
  SessionMaker make{};
};
/// Reads and prepares the parts. Throws what read_input and make_assembly_scene throw.
Station set_up(const StationFlags& flags, int threads, bool quiet);
/// What a user should know of it, in one line.
std::string to_string(const Station& station);

/// What a session keeps, to be set up again: the command line and where it was said, the content of the
/// files, and the program.
std::map<std::string, std::string> station_notes(const Station& station, int argc, const char* const* argv);
/// Throws std::runtime_error "FILE: what" if they do not say how, or files have changed since.
Station set_up_again(const std::map<std::string, std::string>& notes, const std::filesystem::path& file,
                     int threads, bool quiet);

/// A take in which the hand leads the part along the recorded path, misaligned, and holds it at its end [s].
SessionLog log_of_path(const Station& station, double hold);

}  // namespace aussois
