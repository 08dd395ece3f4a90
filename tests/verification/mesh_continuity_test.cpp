// SPDX-License-Identifier: Apache-2.0
// Contacts on repaired CAD meshes along motions beside the borders of their regions, from twice the dilations
// down to a thousandth of them: every event is explained, and no gap jumps by more than planes and chains are
// off (doc/theory/lmd.md, Coverage).
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "examples/assembly/assembly_input.hpp"
#include "tests/support/aimed_poses.hpp"
#include "tests/support/continuity_audit.hpp"

namespace aussois {
namespace {

constexpr double kDilation = 1e-2;  // of each, of shapes of 1 m

/// The part of a mesh, of 1 m.
SimplicialComplex unit_part(const std::filesystem::path& mesh) {
  AssemblyPart part = read_part(mesh, 1);
  const double size = part.report.box.diagonal();
  for (Vec3& x : part.complex.vertices) x /= size;
  return part.complex;
}

ContinuityAudit audit_beside(const LmdShape& shape, int motions, int steps) {
  ContinuityAudit audit;
  const AimedPoses aimed(shape);
  const std::vector<Probe> probes = make_probes(0.1, kDilation);
  Random random(7);
  RandomPair pair;
  pair.b = shape;
  for (int i = 0; i < motions; ++i) {
    const Probe& probe = probes[std::size_t(random.index(int(probes.size())))];
    const Aim aim = aimed.aim(random);
    const double away = 2 * kDilation * random.log_uniform(2e-3, 2);
    Mat3 axes;
    axes << aim.beside, aim.u.cross(aim.beside), aim.u;
    const Quat R = (Quat(axes) * exp_so3(random.log_uniform(1e-6, 0.3) * random.direction())).normalized();
    pair.a = probe.shape;
    pair.g_a = {R, aim.x + away * aim.u - R * probe.place};
    if (nested({&pair.a, pair.g_a, 0}, {&pair.b, {}, 1})) continue;
    const SmoothMotion motion{.g = pair.g_a,
                              .sway = random.vector(2 * away),
                              .turn = random.vector(2 * away),
                              .phase = Vec3::Zero()};
    const LmdOptions options{.threshold = 4 * away};
    ContinuityAuditor(pair, motion, options, 1e-3 * 2 * kDilation, coverage_tolerance(pair.a, pair.b))
        .run(6, steps, audit);
  }
  return audit;
}

TEST(MeshContinuity, EveryComingAndGoingOnSharedMeshesIsExplained) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  for (const char* name : {"nut_387266", "screw_387266", "featuretype_coarse", "factory_gear_medium"}) {
    SCOPED_TRACE(name);
    const LmdShape shape = prepare(
        dilate(unit_part(std::filesystem::path(data) / "meshes" / (std::string(name) + ".obj")), kDilation));
    const ContinuityAudit audit = audit_beside(shape, 100, 60);
    EXPECT_EQ(audit.unexplained, 0);
    EXPECT_GT(audit.handovers + audit.dominated, 20);  // the sample is not hollow
    EXPECT_LT(audit.handover_gap, coverage_tolerance(shape, shape));
    std::printf(
        "%s: %ld poses, %ld at the threshold, %ld at the angle, %ld handovers (%.1e m), %ld dominated, %ld "
        "unexplained\n",
        name, audit.poses, audit.at_threshold, audit.at_angle, audit.handovers, audit.handover_gap,
        audit.dominated, audit.unexplained);
  }
}

}  // namespace
}  // namespace aussois
