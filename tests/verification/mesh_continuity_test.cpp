// SPDX-License-Identifier: Apache-2.0
// How contacts of repaired meshes move: along motions of probes beside the borders of their regions and
// beside wires, from a thousandth of the dilations to several of them, every coming and going is explained
// (doc/theory/lmd.md, Coming and going).
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "examples/drivers/assembly/assembly_input.hpp"
#include "tests/support/aimed_poses.hpp"
#include "tests/support/continuity_audit.hpp"
#include "tests/support/repaired_meshes.hpp"
#include "tests/support/shared_meshes.hpp"

namespace aussois {
namespace {

/// `motions` motions of the probes, which begin where they are aimed at the borders and wires of `shape` and
/// sway along it, towards it and away.
void audit_beside(const LmdShape& shape, int motions, std::uint64_t seed, ContinuityAudit& audit) {
  const AimedPoses aimed(shape);
  if (aimed.empty()) return;
  const double size = 2 * shape.bounding_radius, dilations = 2 * shape.radius;
  const std::vector<Probe> probes = make_probes(std::max(0.02 * size, 10 * shape.radius), shape.radius);
  RandomPair pair;
  pair.b = shape;
  for (int i = 0; i < motions; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", motion " + std::to_string(i));
    Random random(1000003 * seed + std::uint64_t(i));
    const Probe& probe = probes[random.index(int(probes.size()))];
    const Aim aim =
        i % 2 ? aimed.any(random) : aimed.due(i / 2 * std::ssize(kBeside) % aimed.due_count(), random);
    const double away = dilations * random.log_uniform(2e-3, 3);
    Mat3 axes;
    axes << aim.beside, aim.u.cross(aim.beside), aim.u;
    const Quat R = (Quat(axes) * exp_so3(random.vector_of_log_length(1e-6, 0.3))).normalized();
    pair.a = probe.shape;
    pair.g_a = {R, aim.x + away * aim.u - R * probe.place};
    if (nested({&pair.a, pair.g_a, 0}, {&pair.b, {}, 1})) continue;
    const Vec3 sway = away * random.vector_of_log_length(0.1, 30);
    const SmoothMotion motion{.g = pair.g_a,
                              .sway = sway - (sway.dot(aim.u) + away * random.uniform(-1, 1)) * aim.u,
                              .turn = random.vector_of_log_length(1e-6, 0.3),
                              .phase = Vec3::Zero()};
    const LmdOptions options{.threshold = dilations * random.log_uniform(0.3, 3)};
    ContinuityAuditor(pair, motion, options, 1e-3 * dilations, Faces::idealised).run(6, 60, audit);
  }
}

void expect_explained(const ContinuityAudit& audit, int motions) {
  EXPECT_EQ(audit.unexplained, 0);
  EXPECT_EQ(audit.uncovered, 0);
  EXPECT_GT(audit.motions, motions / 10) << "the sample is hollow";
  EXPECT_GT(audit.handovers + audit.dominated, motions / 2) << "the sample is hollow";
  EXPECT_LT(audit.track, 1);
  EXPECT_LE(audit.handover_share, 1);
}

TEST(MeshContinuity, EveryComingAndGoingBesideAVertexInsideAChainIsExplained) {
  constexpr double kDilation = 1e-3;
  const LmdShape shape = prepare(dilate(box_with_border({{0.1, 0.8e-6}}), kDilation));
  ASSERT_EQ(shape.straightened.size(), 1U);
  ContinuityAudit audit;
  audit_beside(shape, 150, 1, audit);
  expect_explained(audit, 150);
  EXPECT_LT(audit.nearest, 1.1e-3 * 2 * kDilation);
  EXPECT_GT(audit.farthest, 4 * kDilation);
  print("", audit);
}

TEST(MeshContinuity, EveryComingAndGoingOnRepairedMeshesIsExplained) {
  ContinuityAudit audit;
  for (unsigned seed = 0; seed < 15; ++seed) {
    SCOPED_TRACE("mesh " + std::to_string(seed));
    const LmdShape shape = prepare(dilate(damaged_and_repaired(seed), 1e-3));
    audit_beside(shape, 10, seed, audit);
  }
  expect_explained(audit, 150);
  print("", audit);
}

// All shared meshes; AUSSOIS_MESH_MOTIONS of each.
TEST(SharedMeshes, EveryComingAndGoingIsExplained) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  const char* count = std::getenv("AUSSOIS_MESH_MOTIONS");
  const int motions = count && *count ? std::atoi(count) : 30;
  int audited = 0, wires = 0;
  for (const std::filesystem::path& mesh : shared_meshes(data)) {
    SCOPED_TRACE(mesh.filename().string());
    const AssemblyPart part = read_part(mesh, 1e-3);
    if (part.complex.edges.empty()) continue;  // points alone have no border to aim at
    const double dilation = 1e-4 * part.report.box.diagonal();
    const LmdShape shape = prepare(dilate(part.complex, dilation));
    ContinuityAudit audit;
    audit_beside(shape, motions, 1, audit);
    expect_explained(audit, motions);
    EXPECT_LT(audit.nearest, 4e-3 * dilation);
    print(mesh.stem().string() + ": ", audit);
    ++audited;
    wires += part.complex.triangles.empty();
  }
  EXPECT_GT(audited, 20);
  EXPECT_GE(wires, 3);
}

}  // namespace
}  // namespace aussois
