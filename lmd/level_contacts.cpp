// SPDX-License-Identifier: Apache-2.0
#include "lmd/level_contacts.hpp"

#include <algorithm>

#include "lmd/gap_fade.hpp"
#include "lmd/shape_levels.hpp"

namespace aussois {
namespace {

constexpr double kFarAgainstOff = 8;       // 1 / kappa: gaps that a level answers for, over what it is off
constexpr double kFarAgainstDilation = 4;  // and over the dilations: what is nearer is contact
constexpr double kFarAgainstSize = 1e-6;   // and over the size, for shapes without dilation
constexpr double kBand = 0.25;             // of the gap where two levels meet: each fades over so much

PosedShape posed_level(const PosedShape& posed, int level) {
  PosedShape out = posed;
  out.shape = &level_shape(*posed.shape, level);
  return out;
}

// Of a coarser level that answers from `from` to `to` [m].
void fade(double from, double to, double threshold, ContactSet& contacts) {
  std::erase_if(contacts.points, [&](ContactPoint& c) {
    const double near = smooth_step(((1 - kBand) * from - c.gap) / (kBand * from));
    const double far = to < kInf ? smooth_step((c.gap - to) / (kBand * to)) : 0;
    c.gap += threshold * (near + far);
    return near >= 1 || c.gap > threshold;
  });
}

}  // namespace

double answers_from(const LmdShape& a, const LmdShape& b, int level) {
  if (level == 0) return 0;
  return std::max({kFarAgainstOff * (level_off(a, level) + level_off(b, level)),
                   kFarAgainstDilation * (a.radius + b.radius),
                   kFarAgainstSize * (a.bounding_radius + b.bounding_radius)});
}

LevelContacts find_contacts_by_level(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                                     const LevelUse& use, PairScratch* scratch) {
  const int last = std::min(use.levels, std::max(level_count(*a.shape), level_count(*b.shape)));
  LevelContacts out;
  double from = 0;
  for (int level = 0; level <= last; ++level) {
    const double to =
        level < last ? std::max({from, use.fine_to, answers_from(*a.shape, *b.shape, level + 1)}) : kInf;
    if (level > 0 && to == from) continue;  // the finer one answers here too
    if ((1 - 2 * kBand) * from > options.threshold) break;
    LmdOptions of_level = options;
    of_level.threshold = std::min(options.threshold, (1 + kBand) * to);
    const PosedShape level_a = posed_level(a, level), level_b = posed_level(b, level);
    if (level == 0) {
      out.fine = scratch ? find_contacts(level_a, level_b, of_level, *scratch)
                         : find_contacts(level_a, level_b, of_level);
      if (use.fine_alone) return out;
    } else {
      ContactSet found = find_contacts(level_a, level_b, of_level);
      fade(from, to, options.threshold, found);
      out.coarse.points.insert(out.coarse.points.end(), found.points.begin(), found.points.end());
    }
    from = to;
  }
  return out;
}

}  // namespace aussois
