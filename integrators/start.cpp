// SPDX-License-Identifier: Apache-2.0
#include "integrators/start.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {
namespace {

void check_joints(const Model& model, const State& state, double tolerance) {
  const std::string bound = "be at most " + number_text(tolerance) + "; see consistent()";
  for (int j = 0; j < int(model.joints.size()); ++j) {
    const std::string who =
        "start: joint " + std::to_string(j) + " (" + model.joints[std::size_t(j)].name + "): ";
    const JointError error = joint_error(model, state, j);
    require_field(error.translation <= tolerance, (who + "translation error [m]").c_str(), error.translation,
                  bound.c_str());
    require_field(error.rotation <= tolerance, (who + "rotation error [rad]").c_str(), error.rotation,
                  bound.c_str());
  }
  for (std::size_t i = 0; i < model.couplings.size(); ++i)
    require_field(
        std::abs(coupling_row(model, model.couplings[i], state.g, state.turns).value) <= tolerance,
        ("start: coupling " + std::to_string(i) + " (" + model.couplings[i].name + "): error").c_str(),
        coupling_row(model, model.couplings[i], state.g, state.turns).value, bound.c_str());
}

void check_size(const std::string& who, const MatX& A, Eigen::Index rows, Eigen::Index columns) {
  const auto text = [](Eigen::Index m, Eigen::Index n) {
    return std::to_string(m) + " x " + std::to_string(n);
  };
  require_field(A.rows() == rows && A.cols() == columns, ("start: " + who).c_str(), text(A.rows(), A.cols()),
                ("be " + text(rows, columns)).c_str());
}

void check_coordinates(const Model& model, const State& state) {
  for (int i = 0; i < int(model.coordinates.size()); ++i) {
    const Coordinates& block = model.coordinates[std::size_t(i)];
    const std::string who = "coordinates " + std::to_string(i) + " (" + block.name + "): ";
    const VecX q = coordinates(model, state, i);
    const MatX M = block.mass(q);
    check_size(who + "mass", M, block.size, block.size);
    const double asymmetry = (M - M.transpose()).cwiseAbs().maxCoeff();
    require_field(asymmetry <= 1e-9 * M.cwiseAbs().maxCoeff(),
                  ("start: " + who + "largest |mass - transpose|").c_str(), asymmetry,
                  "be at most 1e-9 of the largest entry");
    require(Eigen::LLT<MatX>(M).info() == Eigen::Success, "start: " + who + "mass must be positive definite");
    if (!block.force) continue;
    const CoordinateForce force = block.force(state.t, q, speeds(model, state, i));
    check_size(who + "force.f", force.f, block.size, 1);
    if (force.K.size() > 0) check_size(who + "force.K", force.K, block.size, block.size);
    if (force.C.size() > 0) check_size(who + "force.C", force.C, block.size, block.size);
  }
}

void check_gaps(const Model& model, const State& state) {
  for (std::size_t i = 0; i < model.gaps.size(); ++i) {
    const GapFunction& gap = model.gaps[i];
    const std::string who = "gap function " + std::to_string(i) + " (" + gap.name + "): ";
    const GapRows rows = gap.evaluate(model, state, state.t);
    require_field(rows.J.rows() >= 1 && rows.J.rows() <= 3, ("start: " + who + "rows of J").c_str(),
                  rows.J.rows(), "lie in [1, 3]");
    check_size(who + "J", rows.J, rows.J.rows(), gap_columns(model, gap));
    if (rows.rate.size() > 0) check_size(who + "rate", rows.rate, rows.J.rows(), 1);
  }
}

}  // namespace

void validate_start(const Model& model, const State& state, const AdvancementOptions& options,
                    double joint_tolerance) {
  validate(model);
  validate(model, state);
  validate(options);
  check_coordinates(model, state);
  check_gaps(model, state);
  check_joints(model, state, joint_tolerance);
  if (!options.certify) return;
  const std::string wrong =
      wrong_start(model, state, body_bounds(model), pieces_of_shapes(model), options, 1);
  require(wrong.empty(), "start: " + wrong);
}

}  // namespace aussois
