// SPDX-License-Identifier: Apache-2.0
#include "mechanics/model.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "geometry/check.hpp"

namespace aussois {
namespace {

// Allowed asymmetry and violation of (MEC-3), relative to the largest moment
constexpr double kRounding = 1e-9;
constexpr double kLeastMoment = 1e-12;  // smallest principal moment, relative to the largest

void check_inertia(const Mat3& J, const std::string& who) {
  require(J.allFinite(), who + "inertia must be finite");
  const double size = J.cwiseAbs().maxCoeff();
  const double asymmetry = (J - J.transpose()).cwiseAbs().maxCoeff();
  require_field(asymmetry <= kRounding * size, (who + "largest |inertia - transpose|").c_str(), asymmetry,
                "be at most 1e-9 of the largest entry");
  const Vec3 moment =
      Eigen::SelfAdjointEigenSolver<Mat3>(0.5 * (J + J.transpose()), Eigen::EigenvaluesOnly).eigenvalues();
  require_field(moment[0] > kLeastMoment * moment[2], (who + "smallest principal moment of inertia").c_str(),
                moment[0], "be positive, above 1e-12 of the largest");
  require_field(moment[2] <= (moment[0] + moment[1]) + kRounding * moment[2],  // (MEC-3)
                (who + "largest principal moment of inertia").c_str(), moment[2],
                ("not exceed the sum of the others, " + std::to_string(moment[0] + moment[1])).c_str());
}

void check_body(const RigidBody& body, int index, std::size_t shape_count) {
  const std::string who = "body " + std::to_string(index) + " (" + body.name + "): ";
  require_field(body.shape >= -1 && body.shape < int(shape_count), (who + "shape").c_str(), body.shape,
                ("lie in [-1, " + std::to_string(shape_count) + ")").c_str());
  checked_pose(body.g_bs, (who + "g_bs").c_str());
  if (is_dynamic(body)) {
    require_field(body.mass > 0 && std::isfinite(body.mass), (who + "mass").c_str(), body.mass,
                  "be positive and finite [kg]");
    check_inertia(body.inertia, who);
  }
  if (const Prescribed* prescribed = std::get_if<Prescribed>(&body.motion)) {
    try {
      validate(prescribed->path);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(who + error.what());
    }
  }
}

void check_law(const ContactLaw& law, const std::string& who) {
  require_field(law.mu >= 0 && std::isfinite(law.mu), (who + "mu").c_str(), law.mu,
                "be at least 0 and finite");
  require_field(law.restitution >= 0 && law.restitution <= 1, (who + "restitution").c_str(), law.restitution,
                "lie in [0, 1]");
}

}  // namespace

int add(Model& model, LmdShape shape) {
  model.shapes.push_back(std::make_shared<const LmdShape>(std::move(shape)));
  return int(model.shapes.size()) - 1;
}

int add(Model& model, RigidBody body) {
  check_body(body, int(model.bodies.size()), model.shapes.size());
  model.bodies.push_back(std::move(body));
  return int(model.bodies.size()) - 1;
}

void add(Model& model, ForceLaw law) {
  require(bool(law.add_to), "force law (" + law.name + "): add_to must be callable");
  model.forces.push_back(std::move(law));
}

const ContactLaw& contact_law(const Model& model, int body_a, int body_b) {
  const auto named = model.pair_laws.find(std::minmax(body_a, body_b));
  return named == model.pair_laws.end() ? model.contact_law : named->second;
}

void validate(const Model& model) {
  require(model.gravity.allFinite(), "model: gravity must be finite [m/s^2]");
  check_law(model.contact_law, "model: contact_law.");
  const int count = int(model.bodies.size());
  for (const auto& [pair, law] : model.pair_laws) {
    const std::string who =
        "model: pair_laws{" + std::to_string(pair.first) + ", " + std::to_string(pair.second) + "}";
    require(0 <= pair.first && pair.first < pair.second && pair.second < count,
            who + ": bodies must be different, in [0, " + std::to_string(count) + ") and the smaller first");
    check_law(law, who + ".");
  }
  for (std::size_t i = 0; i < model.shapes.size(); ++i)
    require(model.shapes[i] != nullptr, "model: shape " + std::to_string(i) + " must not be empty");
  for (int i = 0; i < count; ++i) check_body(model.bodies[std::size_t(i)], i, model.shapes.size());
  for (const ForceLaw& law : model.forces)
    require(bool(law.add_to), "force law (" + law.name + "): add_to must be callable");
}

}  // namespace aussois
