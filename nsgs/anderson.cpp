// SPDX-License-Identifier: Apache-2.0
#include "nsgs/anderson.hpp"

#include <Eigen/QR>

namespace aussois {

VecX Anderson::propose(const VecX& x, const VecX& g) {
  if (memory_ == 0) return {};
  const VecX f = g - x;
  if (f_.size() > 0) {
    df_.push_back(f - f_);
    dg_.push_back(g - g_);
    if (df_.size() > memory_) df_.pop_front(), dg_.pop_front();
  }
  f_ = f;
  g_ = g;
  if (df_.empty()) return {};
  MatX F(f.size(), Eigen::Index(df_.size()));
  for (std::size_t k = 0; k < df_.size(); ++k) F.col(Eigen::Index(k)) = df_[k];
  Eigen::ColPivHouseholderQR<MatX> qr(F.rows(), F.cols());
  qr.setThreshold(1e-12);                     // directions that rounding made are left out
  const VecX gamma = qr.compute(F).solve(f);  // (AA-1)
  VecX proposed = g;
  for (std::size_t k = 0; k < dg_.size(); ++k) proposed -= gamma[Eigen::Index(k)] * dg_[k];  // (AA-2)
  return proposed.allFinite() ? proposed : VecX();
}

}  // namespace aussois
