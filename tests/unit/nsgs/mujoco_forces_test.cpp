// SPDX-License-Identifier: Apache-2.0
// MuJoCo's own contact forces against the convex cone reading, on MuJoCo's matrices (REG-10).
#include <gtest/gtest.h>

#ifdef AUSSOIS_TEST_MUJOCO
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include <Eigen/Geometry>
#include <mujoco/mujoco.h>

#include "nsgs/regularised.hpp"
#include "tests/support/random.hpp"
#endif

namespace aussois {
namespace {

#ifndef AUSSOIS_TEST_MUJOCO
TEST(Regularised, T_5_1_FindsMuJoCosForces) {
  GTEST_SKIP() << "built without MuJoCo (Debian: libmujoco-dev)";
}
#else

using Model = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using Data = std::unique_ptr<mjData, void (*)(mjData*)>;

// One or two boxes and a ball, each pressed a little into the ground, turned and moving.
std::string random_scene(Random& random, int boxes) {
  char text[600];
  std::string out =
      "<mujoco><option cone=\"elliptic\" jacobian=\"dense\" solver=\"PGS\" tolerance=\"0\" "
      "iterations=\"1000\" impratio=\"";
  out += random.uniform() < 0.5 ? "1" : "4";
  out += "\"/><worldbody><geom type=\"plane\" size=\"5 5 1\"/>";
  for (int b = 0; b < boxes + 1; ++b) {
    const Vec3 half = Vec3(0.12, 0.1, 0.08) + random.vector(0.03);
    const double tilt = random.uniform(-2e-3, 2e-3), turn = random.uniform(0, kPi);
    const Quat R =
        Quat(Eigen::AngleAxisd(turn, Vec3::UnitZ())) * Quat(Eigen::AngleAxisd(tilt, Vec3::UnitX()));
    const double height = (b < boxes ? half.z() : half.x()) - 2e-3;
    const double density = random.log_uniform(100, 5000), mu = random.uniform(0.1, 0.9);
    const char* shape = b < boxes ? "box" : "sphere";
    std::snprintf(text, sizeof text,
                  "<body pos=\"%.17g 0 %.17g\" quat=\"%.17g %.17g %.17g %.17g\"><freejoint/>"
                  "<geom type=\"%s\" size=\"%.17g %.17g %.17g\" density=\"%.17g\" friction=\"%.17g 0 0\" "
                  "condim=\"3\" priority=\"1\"/></body>",
                  double(b), height, R.w(), R.x(), R.y(), R.z(), shape, half.x(), half.y(), half.z(), density,
                  mu);
    out += text;
  }
  return out + "</worldbody></mujoco>";
}

Model model_of(const std::string& text) {
  mjVFS files;
  mj_defaultVFS(&files);
  mj_makeEmptyFileVFS(&files, "scene.xml", int(text.size()));
  std::memcpy(files.filedata[0], text.data(), text.size());
  char error[500] = "";
  Model model(mj_loadXML("scene.xml", &files, error, sizeof error), mj_deleteModel);
  mj_deleteVFS(&files);
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

TEST(Regularised, T_5_1_FindsMuJoCosForces) {
  int sliding = 0, open = 0;
  double worst = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Model model = model_of(random_scene(random, 1 + int(seed % 2)));
    const Data data(mj_makeData(model.get()), mj_deleteData);
    for (int i = 0; i < model->nv; ++i) data->qvel[i] = random.uniform(-0.3, 0.3);
    mj_forward(model.get(), data.get());  // PGS, which needs efc_AR
    const int rows = data->nefc;
    ASSERT_GE(rows, 3) << "seed " << seed;
    ASSERT_EQ(rows, 3 * data->ncon) << "seed " << seed;

    LocalProblem problem;
    const VecX R = Eigen::Map<const VecX>(data->efc_R, rows);
    MatX A = Eigen::Map<const MatX>(data->efc_AR, rows, rows);
    A.diagonal() -= R;
    problem.W = A.sparseView();
    problem.q = Eigen::Map<const VecX>(data->efc_b, rows);
    for (int c = 0; c < data->ncon; ++c) problem.laws.push_back(coulomb(data->contact[c].friction[0]));

    model->opt.solver = mjSOL_NEWTON;
    mj_forward(model.get(), data.get());
    const VecX theirs = Eigen::Map<const VecX>(data->efc_force, rows);
    const RegularisedSolution ours = solve_regularised(
        problem, R, {}, {.reading = FrictionReading::convex_cone, .tolerance = 1e-11, .max_iterations = 100});
    ASSERT_EQ(ours.report.status, SolveStatus::converged) << "seed " << seed << " " << ours.report.residual;
    EXPECT_LE((ours.lambda - theirs).norm(), 1e-6 * theirs.norm()) << "seed " << seed;
    if (theirs.norm() > 0) worst = std::max(worst, (ours.lambda - theirs).norm() / theirs.norm());
    for (int c = 0; c < data->ncon; ++c) {
      const double normal = theirs[3 * c], tangential = theirs.segment<2>(3 * c + 1).norm();
      open += normal == 0;
      sliding += normal > 0 && tangential > 0.999 * problem.laws[c].mu * normal;
    }
  }
  RecordProperty("worst_relative_difference", std::to_string(worst));
  std::printf("worst relative difference %.1e, %d sliding, %d open\n", worst, sliding, open);
  EXPECT_GT(sliding, 50);  // or the sample says nothing
  EXPECT_GT(open, 20);
}
#endif

}  // namespace
}  // namespace aussois
