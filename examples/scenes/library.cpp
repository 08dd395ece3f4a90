// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/library.hpp"

#include <algorithm>

#include "examples/scenes/belts.hpp"
#include "examples/scenes/cables.hpp"
#include "examples/scenes/mechanisms.hpp"
#include "examples/scenes/peer_scenes.hpp"
#include "examples/scenes/pressed_peg.hpp"
#include "examples/scenes/soft_parts.hpp"
#include "examples/scenes/toys.hpp"
#include "examples/scenes/trees.hpp"
#include "geometry/check.hpp"

namespace aussois {
namespace {

LibraryScene of_peers(const std::string& name) {
  const PeerScene scene = peer_scene(name);
  return {.name = name,
          .what = scene.what,
          .t_end = scene.t_end,
          .h = scene.measure == PeerMeasure::displacement ? 1e-2 : 1e-3,
          .make = [name] {
            KernelScene k = kernel_scene(peer_scene(name));
            return CaseScene{.model = std::move(k.model), .state = std::move(k.state), .body = 1};
          }};
}

std::vector<LibraryScene> mechanisms() {
  return {
      {"slider_crank_friction", "the slider-crank of bodies with friction 0.01 between slider and slot (C2)",
       0.02, 1e-5, [] { return slider_crank_of_bodies(0.01); }},
      {"woodpecker", "a bird pecks its way down a pole (C3)", 0.6, 1e-5, woodpecker},
      {"arm_with_peg", "seven hinges with springs press a peg on a plate, in joint coordinates (J4)", 1, 1e-3,
       [] { return in_joint_coordinates(arm_with_peg()); }},
      {"four_bars", "81 rods in 40 redundant loops turn over (C7)", 20, 1e-3, [] { return four_bars(40); }},
      {"bricard", "a ring of six hinges, one equation redundant (C8)", 10, 1e-3, bricard},
      {"squeezer", "Andrews' squeezing mechanism: seven bodies, three loops (C9)", 0.03, 1e-5, squeezer},
      {"bead_column", "100 spheres on top of each other (A4)", 1, 1e-2, [] { return bead_column(100); }},
  };
}

std::vector<LibraryScene> toys() {
  return {
      {"bullet", "a bullet of 800 m/s hits a sheet of paper, plastic (A5)", 5e-3, 1e-3,
       [] { return bullet_and_paper(0, 0.3); }},
      {"bullet_on_edge", "the same at the edge of the sheet, elastic (A5)", 5e-3, 1e-3,
       [] { return bullet_on_edge(1, 0.3, 0); }},
      {"needle", "a needle whose tips move at 500 m/s beside a sheet (A5)", 1e-3, 1e-4,
       [] { return needle_and_sheet(0, 0); }},
      {"tippe_top_coulomb", "a tippe-top under Coulomb's friction: it never inverts (B6)", 2, 1e-4,
       [] { return tippe_top(0); }},
      {"tippe_top", "a tippe-top with friction against pivoting, R_e = 1/3 mm: it inverts (B6)", 2, 1e-4,
       [] { return tippe_top(kTippeTopDrilling); }},
      {"rattleback", "a rattleback spun the wrong way turns back (B7)", 5, 1e-3,
       [] { return rattleback(-5); }},
      {"pressed_peg", "a robot presses a peg onto a plate, off its middle; for --selector", 0.1, 1e-3,
       pressed_peg},
      {"euler_disc", "a disc on edge rolls round without loss, ten turns (B8)", 0.614, 1e-4,
       [] { return euler_disc({}); }},
      {"euler_disc_descends", "the same with a moment of 80 uN m against rolling (B8)", 1.5, 1e-4,
       [] { return euler_disc({.contour = 8e-5}); }},
      {"dimer_drop", "two balls on a rod dropped on a plate (C4)", 0.4, 1e-4, dimer_drop},
      {"dimer_and_rod", "a rod pushed between two balls (C5)", 0.05, 1e-3,
       [] { return dimer_and_rod(0.015, 1e-3, 0.1); }},
  };
}

std::vector<LibraryScene> cables() {
  return {
      {"cable_on_peg", "a rubber cable falls across a peg, swings over it and slides off", 2, 5e-4,
       cable_on_peg},
      {"ball_on_rope", "a ball falls onto a rope that is held at both ends, and off it", 1, 1e-3,
       ball_on_rope},
      {"belt_drive", "a belt turns a pulley that is one per cent slower (K3)", 2, 5e-3, belt_drive},
      {"cable_in_clips", "a cable is pulled through three rings that are not in line (K10)", 2.5, 1e-3,
       cable_in_clips},
      {"capstan", "a thin rope is drawn over half a peg against 1 N until it slips (K2)", 0.5, 1e-3, capstan},
      {"knot", "an overhand knot in a rope whose ends are drawn apart", 2, 1e-3, knot},
      {"rope_coil", "a rope is let down onto a floor and coils onto itself", 2, 1e-3, rope_coil},
  };
}

std::vector<LibraryScene> solids() {
  return {
      {"soft_cubes", "four soft cubes fall onto each other", 1.5, 1e-3, soft_cubes},
      {"cloth_on_ball", "a square of cloth falls over a ball and folds onto itself", 1.5, 1e-3,
       cloth_on_ball},
      {"cook_panel", "Cook's membrane of rubber swings under a load (F2)", 0.5, 1e-3, cook_panel},
      {"o_ring", "a quarter of an O-ring is squeezed by a quarter (F12)", 0.5, 1e-3, o_ring},
      {"rubber_ball", "a rubber ball falls onto a plate and bounces (F3, F9)", 0.3, 1e-3, rubber_ball},
      {"snap_fit", "a catch lifts the tooth of a cantilever and passes it (F13)", 0.1, 2e-4, snap_fit},
  };
}

std::vector<LibraryScene> all() {
  std::vector<LibraryScene> out;
  for (const Case& c : cases()) out.push_back({c.name, c.what, c.t_end, c.h, c.scene});
  for (const std::string& name : peer_scene_names()) out.push_back(of_peers(name));
  for (const std::vector<LibraryScene>& more : {mechanisms(), toys(), cables(), solids()})
    out.insert(out.end(), more.begin(), more.end());
  std::ranges::sort(out, {}, &LibraryScene::name);
  return out;
}

}  // namespace

const std::vector<LibraryScene>& library_scenes() {
  static const std::vector<LibraryScene> scenes = all();
  return scenes;
}

const LibraryScene& library_scene(const std::string& name) {
  std::string known;
  for (const LibraryScene& s : library_scenes()) {
    if (s.name == name) return s;
    known += (known.empty() ? "" : ", ") + s.name;
  }
  throw std::invalid_argument("--scene = " + name + " must be one of " + known);
}

}  // namespace aussois
