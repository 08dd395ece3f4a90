// SPDX-License-Identifier: Apache-2.0
#include "nsgs/friction_problem.hpp"

#include <string>

#include "geometry/check.hpp"

namespace aussois {

namespace {

bool same(const Law& a, const Law& b) {
  return a.kind == b.kind && a.rows == b.rows && a.mu == b.mu && a.mu_r == b.mu_r && a.radius == b.radius &&
         a.limit == b.limit;
}

int validated_rows(const std::vector<Law>& laws) {
  int rows = 0;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    if (i == 0 || !same(laws[i], laws[i - 1])) validate(laws[i], i);  // laws are many and alike
    rows += laws[i].rows;
  }
  return rows;
}

void require_size(Eigen::Index size, const char* field, Eigen::Index wanted, const char* of) {
  if (size == wanted) return;
  const std::string bound = "equal " + std::string(of) + " = " + std::to_string(wanted);
  require_field(false, field, size, bound.c_str());
}

}  // namespace

void validate(const FrictionProblem& problem) {
  const Eigen::Index n = problem.f.size(), rows = validated_rows(problem.laws);
  require_size(problem.M.rows(), "FrictionProblem::M.rows()", n, "f.size()");
  require_size(problem.M.cols(), "FrictionProblem::M.cols()", n, "f.size()");
  require_size(problem.w.size(), "FrictionProblem::w.size()", rows, "the rows of laws");
  require_size(problem.H.cols(), "FrictionProblem::H.cols()", rows, "the rows of laws");
  if (rows > 0) require_size(problem.H.rows(), "FrictionProblem::H.rows()", n, "f.size()");
  require_size(problem.G.cols(), "FrictionProblem::G.cols()", problem.b.size(), "b.size()");
  if (problem.b.size() > 0) require_size(problem.G.rows(), "FrictionProblem::G.rows()", n, "f.size()");
  if (problem.R.size() > 0)
    require_size(problem.R.size(), "FrictionProblem::R.size()", rows, "the rows of laws");
  for (Eigen::Index i = 0; i < problem.R.size(); ++i)
    require_field(problem.R[i] >= 0, ("FrictionProblem::R[" + std::to_string(i) + "]").c_str(), problem.R[i],
                  "be >= 0");
}

void validate(const LocalProblem& problem) {
  const Eigen::Index rows = validated_rows(problem.laws);
  require_size(problem.W.rows(), "LocalProblem::W.rows()", rows, "the rows of laws");
  require_size(problem.W.cols(), "LocalProblem::W.cols()", rows, "the rows of laws");
  require_size(problem.q.size(), "LocalProblem::q.size()", rows, "the rows of laws");
}

std::vector<int> first_rows(const std::vector<Law>& laws) {
  std::vector<int> first{0};
  first.reserve(laws.size() + 1);
  for (const Law& law : laws) first.push_back(first.back() + law.rows);
  return first;
}

}  // namespace aussois
