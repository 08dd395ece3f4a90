// SPDX-License-Identifier: Apache-2.0
#include "examples/common/convergence.hpp"

#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/csv_table.hpp"

namespace aussois {
namespace {

constexpr double kNoOrder = std::numeric_limits<double>::quiet_NaN();  // of the first level

}  // namespace

std::vector<double> step_sizes(double h0, int levels) {
  std::vector<double> steps;
  for (int k = 0; k < levels; ++k) {
    const double turn = std::fmod(0.6180339887498949 * k, 1.0);  // golden ratio: spread evenly
    steps.push_back(h0 * std::pow(0.5, k) * (1 - 0.07 * turn));
  }
  return steps;
}

double fitted_order(const std::vector<double>& h, const std::vector<double>& error) {
  require(h.size() >= 3 && error.size() == h.size(), "a convergence study needs at least three step sizes");
  const double n = double(h.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    require_field(std::isfinite(error[i]) && error[i] > 0, "error", error[i], "be positive and finite");
    const double x = std::log(h[i]), y = std::log(error[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);  // (CONV-5)
}

double pairwise_order(const std::vector<double>& h, const std::vector<double>& error, std::size_t i) {
  return std::log(error[i] / error[i - 1]) / std::log(h[i] / h[i - 1]);  // (CONV-6)
}

Convergence convergence_study(const std::vector<double>& steps, const std::vector<double>& errors) {
  return {.h = steps, .error = errors, .order = fitted_order(steps, errors)};
}

std::string to_string(const Convergence& s, const std::string& quantity) {
  std::ostringstream out;
  char line[120];
  std::snprintf(line, sizeof line, "%12s %16s %8s\n", "h [s]", quantity.c_str(), "order");
  out << line;
  for (std::size_t i = 0; i < s.h.size(); ++i) {
    if (i == 0)
      std::snprintf(line, sizeof line, "%12.5e %16.5e %8s\n", s.h[i], s.error[i], "-");
    else
      std::snprintf(line, sizeof line, "%12.5e %16.5e %8.3f\n", s.h[i], s.error[i],
                    pairwise_order(s.h, s.error, i));
    out << line;
  }
  std::snprintf(line, sizeof line, "fitted order %.4f\n", s.order);
  out << line;
  return out.str();
}

void write_convergence(const std::filesystem::path& dir, const std::string& name, const Convergence& s,
                       const ConvergencePicture& picture) {
  CsvTable csv(dir / (name + ".csv"), {"h", "error", "order"});
  for (std::size_t i = 0; i < s.h.size(); ++i)
    csv.add({s.h[i], s.error[i], i == 0 ? kNoOrder : pairwise_order(s.h, s.error, i)});
  csv.close();
  std::ostringstream gp;
  const double factor = s.error.back() / std::pow(s.h.back(), picture.order);
  gp << "# draws " << name << ".png: gnuplot " << name << ".gp\n"
     << "set terminal pngcairo size 800,600; set output '" << name << ".png'\n"
     << "set datafile separator ','; set logscale xy; set format '%g'; set key left top; set grid\n"
     << "set xlabel \"" << picture.step << "\"; set ylabel \"" << picture.error << "\"\n"
     << "plot '" << name
     << ".csv' every ::1 using 1:2 with linespoints pt 7 title sprintf('observed order %.3f', " << s.order
     << "), \\\n"
     << "     " << factor << "*x**" << picture.order << " with lines dt 2 title 'order " << picture.order
     << "'\n";
  write_whole_file(dir / (name + ".gp"), gp.str());
}

}  // namespace aussois
