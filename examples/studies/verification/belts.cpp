// SPDX-License-Identifier: Apache-2.0
// A belt between two pulleys: row K3 of group K (doc/theory/beams.md).
#include "examples/scenes/belts.hpp"

#include <algorithm>
#include <cmath>

#include "examples/studies/verification/running.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

// Means over the last steps of a run that leads the belt more than once around.
struct Running {
  double tight = 0, slack = 0;  // tensions of the free spans [N]
  double sliding = 0;           // angle of the first pulley over which the belt slides where it leaves [rad]
};

// From where the belt leaves the pulley that drives to the first contact that sticks.
double sliding_angle(const BeltDrive& drive, const StepReport& report) {
  std::vector<std::pair<double, bool>> slides;  // by the angle from where it leaves
  for (const StepContact& c : report.contacts) {
    if (c.point.a.body != drive.pulleys[0] && c.point.b.body != drive.pulleys[0]) continue;
    const double across = std::abs(c.impulse.dot(c.point.normal)),
                 along = (c.impulse - c.impulse.dot(c.point.normal) * c.point.normal).norm();
    const Vec3 from = c.point.x_a - pose(drive.state, drive.pulleys[0]).p;
    if (across > 0)
      slides.emplace_back(std::atan2(-from.x(), -from.y()), along > (1 - 1e-6) * BeltDrive::kMu * across);
  }
  std::ranges::sort(slides);
  double out = 0;
  for (const auto& [angle, slid] : slides) {
    if (!slid && angle > BeltDrive::chord_angle()) break;  // not where it is leaving
    out = angle;
  }
  return out;
}

Running run_drive(double slower) {
  constexpr double kAdvance = 3e-3, kWay = 1.5;  // [m]
  constexpr int kMean = 40;
  BeltDrive drive(slower);
  const MoreauJean scheme(drive.model, {.h = kAdvance / BeltDrive::kSpeed, .solver = {.tolerance = 1e-10}},
                          {.theta = 1});
  const double end = kWay / BeltDrive::kSpeed;
  Running out;
  run_accepted(scheme, drive.state, end, [&](const StepReport& report) {
    if (report.t < end - (kMean + 0.5) * report.h) return true;
    double tight = 0, slack = 0, tight_count = 0, slack_count = 0;
    const std::vector<BeamLoad> loads = beam_loads(drive.belt.beam, drive.state);
    for (std::size_t i = 0; i < loads.size(); ++i) {
      const Vec3 x = pose(drive.state, drive.belt.nodes[i]).p;
      if (std::abs(x.x()) > BeltDrive::kApart / 4) continue;
      (x.y() > 0 ? tight : slack) += loads[i].stress[0];
      ++(x.y() > 0 ? tight_count : slack_count);
    }
    out.tight += tight / tight_count / kMean;
    out.slack += slack / slack_count / kMean;
    out.sliding += sliding_angle(drive, report) / kMean;
    return true;
  });
  return out;
}

// The loss of speed from the first pulley to the second that the tensions tell: as much belt arrives as
// leaves.
double told_by(const Running& r) {
  return 1 - (1 + r.slack / BeltDrive::kStiffness) / (1 + r.tight / BeltDrive::kStiffness);
}

VerificationCase belt_with_creep() {
  return {
      .name = "K3.belt",
      .what = "limp belt of 96 elements around two pulleys, mu = 0.5, the one that is driven 1 % slower",
      .rows = {{"creep", "loss of speed that its tensions tell, off 1 %, relative", "-", 2e-2,
                "continuity: 1 - (1 + T2 / EA) / (1 + T1 / EA)"},
               {"arc",
                "angle over which it slides where it leaves the pulley that drives, off ln(T1 / T2) / mu, "
                "over an element's",
                "-", 1, "Euler and Eytelwein; an element"},
               {"idle", "the loss that they tell where both are equally fast, over 1 %", "-", 2e-2,
                "nothing is transmitted"}},
      .measure =
          [] {
            constexpr double kSlower = 0.01;
            const Running r = run_drive(kSlower);
            return Figures{{"creep", std::abs(told_by(r) / kSlower - 1)},
                           {"arc", std::abs(r.sliding - std::log(r.tight / r.slack) / BeltDrive::kMu) /
                                       BeltDrive::chord_angle()},
                           {"idle", std::abs(told_by(run_drive(0))) / kSlower}};
          },
      .slow = true};
}

}  // namespace

std::vector<VerificationCase> belt_verification() {
  return {belt_with_creep()};
}

}  // namespace aussois
