// SPDX-License-Identifier: Apache-2.0
// All that deforms moves with the same bits: row S3 of group S.
#include <algorithm>

#include "examples/scenes/library.hpp"
#include "examples/studies/verification/running.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

struct Course {
  std::string scene{};
  double h = 1e-3, until = 0.1;  // [s]
};

// The hash of the state after each step; with a scheme made anew after every so many steps.
struct Hashes {
  std::vector<std::uint64_t> states{};
  std::size_t touching = 0;  // contacts at the end
};
Hashes hashes_of(const CaseScene& scene, const Course& course, int threads, int anew) {
  StepOptions options{.h = course.h, .threads = threads};
  options.lmd.threads = threads;
  const auto fresh = [&] { return MoreauJean(scene.model, options, {.theta = 1}); };
  MoreauJean scheme = fresh();
  State state = scene.state;
  Hashes out;
  while (state.t < course.until - course.h / 2) {
    if (out.states.size() % std::size_t(anew) == 0) scheme = fresh();
    const StepReport report = step(scheme, state);
    out.states.push_back(hash(state));
    out.touching = report.contacts.size();
  }
  return out;
}

int unlike(const Hashes& a, const Hashes& b) {
  int out = int(a.states.size() != b.states.size());
  for (std::size_t k = 0; k < std::min(a.states.size(), b.states.size()); ++k)
    out += a.states[k] != b.states[k];
  return out;
}

VerificationCase same_bits(const Course& course) {
  constexpr int kNever = 1 << 30;
  return {
      .name = "S3.same_bits",
      .setting = course.scene,
      .what =
          "the first steps of a scene, by one thread, by two and eight, and by a scheme made anew from "
          "the state at every seventh step",
      .rows = {{"threads", "states that differ with more threads", "-", 0, "the same bits", Sense::exactly},
               {"anew", "states that differ after a scheme was made anew", "-", 0, "the same bits",
                Sense::exactly},
               {"touching", "contacts at the end", "-", 1, "something touches", Sense::at_least}},
      .measure =
          [=] {
            const CaseScene scene = library_scene(course.scene).make();
            const Hashes one = hashes_of(scene, course, 1, kNever);
            int threads = 0;
            for (const int count : {2, 8}) threads += unlike(hashes_of(scene, course, count, kNever), one);
            return Figures{{"threads", threads},
                           {"anew", unlike(hashes_of(scene, course, 1, 7), one)},
                           {"touching", double(one.touching)}};
          },
      .slow = true,
      .certified = true};
}

}  // namespace

std::vector<VerificationCase> soft_repeat_verification() {
  std::vector<VerificationCase> out;
  for (const Course& course : {Course{"arm_with_peg", 1e-3, 0.1},
                               {"ball_on_rope", 4e-3, 0.2},
                               {"belt_drive", 2e-2, 0.6},
                               {"cable_in_clips", 2e-3, 0.1},
                               {"cable_on_peg", 2e-3, 0.12},
                               {"cloth_on_ball", 4e-3, 0.1},
                               {"knot", 4e-3, 0.2},
                               {"o_ring", 5e-3, 0.05},
                               {"rope_coil", 2e-3, 0.1},
                               {"rubber_ball", 4e-3, 0.13},
                               {"snap_fit", 2e-3, 0.04},
                               {"soft_cubes", 4e-3, 0.12}})
    out.push_back(same_bits(course));
  return out;
}

}  // namespace aussois
