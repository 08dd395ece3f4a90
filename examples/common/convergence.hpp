// SPDX-License-Identifier: Apache-2.0
// Observed order of convergence: errors at several steps, a fitted slope, a table and a gnuplot script.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aussois {

struct Convergence {
  std::vector<double> h{};      // [s], descending
  std::vector<double> error{};  // in the unit of the quantity
  double order = 0;             // slope of the least-squares line through (log h, log error)
};

/// h0 and its halvings, each turned a little (by up to 7 %), so that no event falls into the same place of
/// every step: steps that are powers of two of each other fake orders.
std::vector<double> step_sizes(double h0, int levels);

/// Slope of the least-squares line through (log h, log error) (CONV-5). Throws std::invalid_argument for
/// fewer than three steps or an error that is not positive and finite.
double fitted_order(const std::vector<double>& h, const std::vector<double>& error);
/// From level i - 1 to i >= 1 (CONV-6).
double pairwise_order(const std::vector<double>& h, const std::vector<double>& error, std::size_t i);

/// With the fitted order; throws what that throws.
Convergence convergence_study(const std::vector<double>& steps, const std::vector<double>& errors);

std::string to_string(const Convergence& study, const std::string& quantity);

/// What a picture of convergence says at its axes, and the order of the line beside the errors.
struct ConvergencePicture {
  std::string step = "step h [s]", error{};
  double order = 1;
};
/// DIR/NAME.csv (h, error, pairwise order) and DIR/NAME.gp, which draws DIR/NAME.png: gnuplot NAME.gp. DIR
/// exists.
void write_convergence(const std::filesystem::path& dir, const std::string& name, const Convergence& study,
                       const ConvergencePicture& picture);

}  // namespace aussois
