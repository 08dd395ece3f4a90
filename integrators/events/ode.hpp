// SPDX-License-Identifier: Apache-2.0
// Ordinary differential equations by CVODE [Hindmarsh2005], with roots of functions of the solution located
// inside the step that crosses them. SUNDIALS stays inside ode.cpp.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "integrators/step_options.hpp"

namespace aussois {

/// y' = rate(t, y); a root is where an entry of `roots` falls through zero. Both return false where they have
/// no value: then a shorter step is tried.
struct OdeProblem {
  std::function<bool(double t, const VecX& y, VecX& rate)> rate{};
  std::function<bool(double t, const VecX& y, VecX& value)> roots{};  // may be empty
  int root_count = 0;
  int unjudged = 0;  // so many entries of y do not shorten the step, however rough their rate is
  int sums = 0;      // and so many after them, at the end of y, change nothing at all
};

enum class OdeStop { stepped, at_end, at_root, failed };

/// One smooth piece, from its start to a root or to the end. The problem must outlive it.
class OdePiece {
 public:
  /// Throws std::runtime_error if there is no memory.
  OdePiece(const OdeProblem& problem, const OdeOptions& options, double t, const VecX& y);
  OdePiece(const OdePiece&) = delete;
  OdePiece& operator=(const OdePiece&) = delete;
  ~OdePiece();

  /// One internal step, cut at t_end; passes on what the problem throws; then time() and state() are those
  /// reached.
  OdeStop advance(double t_end);
  double time() const;
  const VecX& state() const;
  VecX at(double t) const;            // dense output within the last internal step
  const std::string& reason() const;  // why it failed

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace aussois
