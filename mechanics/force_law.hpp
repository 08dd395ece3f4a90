// SPDX-License-Identifier: Apache-2.0
// The one extension point for forces: anything that adds a generalised force (MEC-5).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mechanics/force_matrix.hpp"

namespace aussois {

struct Model;
struct State;

/// A vector that user code writes to. [ ], ( ), segment, head and tail throw std::invalid_argument if out of
/// range, in release builds too; other access is Eigen's.
class ForceVector : public VecX {
 public:
  ForceVector() = default;
  template <class Other>
  ForceVector(const Eigen::MatrixBase<Other>& other) : VecX(other) {}  // NOLINT: as VecX does
  using VecX::operator=;

  double& operator[](Eigen::Index i) { return coeffRef(checked(i, 1)); }
  double operator[](Eigen::Index i) const { return coeff(checked(i, 1)); }
  double& operator()(Eigen::Index i) { return coeffRef(checked(i, 1)); }
  double operator()(Eigen::Index i) const { return coeff(checked(i, 1)); }
  template <int N>
  auto segment(Eigen::Index first) {
    return VecX::segment<N>(checked(first, N));
  }
  template <int N>
  auto segment(Eigen::Index first) const {
    return VecX::segment<N>(checked(first, N));
  }
  auto segment(Eigen::Index first, Eigen::Index count) { return VecX::segment(checked(first, count), count); }
  auto segment(Eigen::Index first, Eigen::Index count) const {
    return VecX::segment(checked(first, count), count);
  }
  template <int N>
  auto head() {
    return segment<N>(0);
  }
  template <int N>
  auto tail() {
    return segment<N>(size() - N);
  }
  auto head(Eigen::Index count) { return segment(0, count); }
  auto head(Eigen::Index count) const { return segment(0, count); }
  auto tail(Eigen::Index count) { return segment(size() - count, count); }
  auto tail(Eigen::Index count) const { return segment(size() - count, count); }

 private:
  Eigen::Index checked(Eigen::Index first, Eigen::Index count) const {
    if (first < 0 || count < 0 || first > size() - count) refuse(first, count);
    return first;
  }
  [[noreturn]] void refuse(Eigen::Index first, Eigen::Index count) const;
};

/// Forces and their derivatives in the velocity coordinates: six rows per body of the model (fixed ones too),
/// force in the world at the centre of mass [N], torque in the body [N m]; then one row per coordinate.
/// Without K and C, a force that depends on poses or velocities is integrated explicitly. The theta scheme is
/// then of order one, whatever theta is, and stiff forces are unstable.
struct GeneralisedForce {
  ForceVector f{};                      // laid out as State::v
  std::vector<Triplet> K{};             // -df/dq along the twist coordinates [N/m, N, N m]
  std::vector<Triplet> C{};             // -df/dv [N s/m, N s, N m s]
  std::vector<ForceMatrix> matrices{};  // what many elements add to K and C
};

/// Appends the entries of `block` to a sparse matrix, its corner at (row, column).
inline void add_block(std::vector<Triplet>& matrix, int row, int column, const Mat3& block) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) matrix.emplace_back(row + i, column + j, block(i, j));
}

struct ForceLaw {
  std::string name{};
  /// Adds the force at time t, at the poses and velocities of the state (its own t is the start of the step).
  std::function<void(const Model&, const State&, double t, GeneralisedForce&)> add_to{};
  /// Why there is no force at a state, or an empty text if there is one. A step is shortened before it leads
  /// through such a state. Without the function there always is a force.
  std::function<std::string(const Model&, const State&)> refusal{};
  /// Potential energy [J] at the state; empty: none (dissipative or not conservative).
  std::function<double(const Model&, const State&, double t)> potential{};
  // The potential depends on the state alone, and besides it the law only takes energy, from all that it acts
  // on, moved bodies included
  bool passive = false;
  bool internal = false;  // its forces act between parts of one body: they have no resultant and no moment
};

/// The first refusal of a law at a state, with the name of the law; empty: there is none.
std::string force_refusal(const Model& model, const State& state);
/// The sum over all laws of the model. Throws std::invalid_argument naming a law that writes outside the
/// model's velocities.
GeneralisedForce total_force(const Model& model, const State& state, double t);

}  // namespace aussois
