// SPDX-License-Identifier: Apache-2.0
// Generalised coordinates beside the bodies: the open door for models of one's own (GEN-1) to (GEN-4). A
// block obeys M(q) dv = f(t, q, v) dt + H dr, dq = v dt; gap functions say where it, or a body, may not go.
#pragma once

#include <functional>
#include <string>

#include "mechanics/contact_law.hpp"

namespace aussois {

struct Model;
struct State;

/// Of one block; an empty K or C is zero, and its force is then integrated explicitly.
struct CoordinateForce {
  VecX f{};  // all of it, Coriolis terms of M(q) included
  MatX K{};  // -df/dq
  MatX C{};  // -df/dv
};

struct Coordinates {
  std::string name{};
  int size = 0;                               // n, >= 1
  std::function<MatX(const VecX& q)> mass{};  // n x n, symmetric and positive definite
  std::function<CoordinateForce(double t, const VecX& q, const VecX& v)> force{};  // empty: none
  std::function<double(const VecX& q)> potential{};  // of the conservative part of the force [J]; empty: none
};

/// What a gap function says at a state: velocities u = J v + rate, the normal first.
struct GapRows {
  double gap = 0;  // [m], negative in penetration
  MatX J{};        // 1 row: frictionless, 2: friction in a plane, 3: in space
  VecX rate{};     // what moves by itself, dgap/dt and tangential speeds at fixed q [m/s]; empty: nothing
};

/// A contact of one's own. It is always a candidate: no search finds it, no certificate proves it.
struct GapFunction {
  std::string name{};
  int block = -1;  // columns of J: the velocities of this block of coordinates; -1: all of State::v
  std::function<GapRows(const Model&, const State&, double t)> evaluate{};
  ContactLaw law{};  // its Contensou radius must be 0
};

}  // namespace aussois
