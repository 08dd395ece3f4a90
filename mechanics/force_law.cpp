// SPDX-License-Identifier: Apache-2.0
#include "mechanics/force_law.hpp"

#include "geometry/check.hpp"
#include "mechanics/state.hpp"

namespace aussois {
namespace {

void check_entries(const std::vector<Triplet>& entries, std::size_t first, const char* name, int size) {
  for (std::size_t k = first; k < entries.size(); ++k) {
    const auto [i, j] = std::pair(entries[k].row(), entries[k].col());
    if (i >= 0 && j >= 0 && i < size && j < size) continue;
    std::ostringstream text;
    text << name << ": entry (" << i << ", " << j << ") must have both indices in [0, " << size << ")";
    throw std::invalid_argument(text.str());
  }
}

}  // namespace

void ForceVector::refuse(Eigen::Index first, Eigen::Index count) const {
  throw std::invalid_argument("GeneralisedForce::f: entries " + std::to_string(first) + " to " +
                              std::to_string(first + count - 1) + " must lie in [0, " +
                              std::to_string(size()) + ")");
}

std::string force_refusal(const Model& model, const State& state) {
  for (const ForceLaw& law : model.forces) {
    const std::string why = law.refusal ? law.refusal(model, state) : "";
    if (!why.empty()) return "force law (" + law.name + "): " + why;
  }
  return "";
}

GeneralisedForce total_force(const Model& model, const State& state, double t) {
  const int size = velocity_count(model);
  GeneralisedForce out{.f = VecX::Zero(size)};
  for (const ForceLaw& law : model.forces) {
    const std::size_t K = out.K.size(), C = out.C.size(), matrices = out.matrices.size();
    try {
      law.add_to(model, state, t, out);
      require_field(out.f.size() == size, "size of GeneralisedForce::f", out.f.size(),
                    ("stay " + std::to_string(size)).c_str());
      check_entries(out.K, K, "GeneralisedForce::K", size);
      check_entries(out.C, C, "GeneralisedForce::C", size);
      for (std::size_t k = matrices; k < out.matrices.size(); ++k) validate(out.matrices[k], size);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("force law (" + law.name + "): " + error.what());
    }
  }
  return out;
}

}  // namespace aussois
