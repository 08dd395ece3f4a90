// SPDX-License-Identifier: Apache-2.0
// Gauss-Seidel in the order of colours (COL-1), (COL-2): blocks of one colour share no velocities, so they
// are solved at once, on as many threads as there are, with the same bits.
#include <algorithm>
#include <cmath>

#include "nsgs/fixed_point.hpp"

namespace aussois {

namespace {

constexpr int kChunk = 64;  // blocks that a thread takes at a time

// Blocks sorted by colour, ascending within each.
struct Palette {
  std::vector<int> blocks{};
  std::vector<int> begin{0};  // of each colour, and the end
};

Palette palette(const std::vector<int>& colour) {
  Palette out;
  for (int now = 0; out.blocks.size() < colour.size(); ++now) {
    for (std::size_t c = 0; c < colour.size(); ++c)
      if (colour[c] == now) out.blocks.push_back(int(c));
    out.begin.push_back(int(out.blocks.size()));
  }
  return out;
}

}  // namespace

Iterate coloured_nsgs(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  const SweepOptions sweep{.local = options.local, .relaxation = options.relaxation};
  const Palette colours = palette(W.colours());
  SweepCounts counts;
  std::vector<BlockChange> done(colours.blocks.size());
  const auto step = [&](VecX& r) {
    for (std::size_t k = 0; k + 1 < colours.begin.size(); ++k) {
      const int begin = colours.begin[k], end = colours.begin[k + 1];
      for_all(options, (end - begin + kChunk - 1) / kChunk, [&](int chunk) {
        const int from = begin + chunk * kChunk;
        for (int i = from; i < std::min(from + kChunk, end); ++i)
          done[i] = W.relax(colours.blocks[i], r, sweep);
      });
    }
    double change = 0;
    for (const BlockChange& block : done) change += counts.add(block);
    return std::sqrt(change);
  };
  Iterate best = fixed_point(W, start, Method::coloured_nsgs, options, report, step);
  report.local_failures += counts.failures;
  report.local_fail_safes += counts.fail_safes;
  return best;
}

}  // namespace aussois
