// SPDX-License-Identifier: Apache-2.0
// Integrates ordinary differential equations with CVODE [Hindmarsh2005], and locates roots of functions of
// the solution inside the step that crosses them. SUNDIALS stays inside ode.cpp.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "integrators/events/event_driven.hpp"

namespace aussois {

/// y' = rate(t, y); at a root an entry of `roots` falls through zero. Both functions return false where they
/// have no value; a shorter step is then tried.
struct OdeProblem {
  std::function<bool(double t, const VecX& y, VecX& rate)> rate{};
  std::function<bool(double t, const VecX& y, VecX& value)> roots{};  // may be empty
  int root_count = 0;
  int unjudged = 0;  // number of entries of y, ahead of the sums, that do not shorten the step, however rough
                     // their rate
  int sums = 0;      // number of entries at the end of y that affect nothing else
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

  /// Takes one internal step, cut off at t_end; time() and state() are then those reached. Passes on whatever
  /// the problem throws.
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
