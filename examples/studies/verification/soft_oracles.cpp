// SPDX-License-Identifier: Apache-2.0
// Contacts and certificates of shapes that deform beside slow ways to the same: rows S2.refit, S2.search and
// S2.certificate of group S (doc/theory/deforming_shapes.md).
#include <algorithm>
#include <cmath>

#include "examples/common/random.hpp"
#include "examples/studies/verification/running.hpp"
#include "geometry/primitives.hpp"
#include "lmd/certificate.hpp"
#include "lmd/find_contacts.hpp"

namespace aussois {
namespace {

constexpr double kDilation = 0.02;

SimplicialComplex some_complex(Random& random) {
  switch (random.index(4)) {
    case 0:
      return make_box(1, 0.8, 0.6, 2);
    case 1:
      return make_sphere(0.5, 1);
    case 2:
      return make_plate(1, 1, 3, 3);
    default:
      return make_polyline({{-0.6, 0, 0}, {-0.2, 0.1, 0}, {0.3, 0, 0.1}, {0.6, 0.2, 0}});
  }
}

LmdShape soft(SimplicialComplex complex) {
  return prepare(dilate(std::move(complex), kDilation), {.deforming = true});
}

std::vector<Vec3> random_field(const LmdShape& shape, Random& random, double size) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < shape.complex.vertices.size(); ++i) out.push_back(random.vector(size));
  return out;
}

LmdShape moved(const LmdShape& shape, const std::vector<Vec3>& field, double time) {
  std::vector<Vec3> there = shape.complex.vertices.to_vector();
  for (std::size_t i = 0; i < there.size(); ++i) there[i] += time * field[i];
  return refit(shape, std::move(there));
}

// Contacts of either set that the other has not, with the same gap and normal to the last bit.
int difference(const ContactSet& a, const ContactSet& b) {
  int out = std::abs(int(a.points.size()) - int(b.points.size()));
  for (std::size_t i = 0; i < std::min(a.points.size(), b.points.size()); ++i) {
    const ContactPoint &c = a.points[i], &d = b.points[i];
    out += !(key_of(c) == key_of(d) && c.gap == d.gap && c.normal == d.normal);
  }
  return out;
}

struct SearchTally {
  int contacts = 0, off_fresh = 0, off_exhaustive = 0;
};
void add_search(std::uint64_t seed, SearchTally& tally) {
  Random random(seed);
  const LmdShape laid_a = soft(some_complex(random)), laid_b = soft(some_complex(random));
  const double size = random.log_uniform(1e-3, 0.3);
  const LmdShape a = moved(laid_a, random_field(laid_a, random, size), 1),
                 b = moved(laid_b, random_field(laid_b, random, size), 1), fresh_a = soft(a.complex),
                 fresh_b = soft(b.complex);
  const SE3 g = random.pose(0.7);
  const LmdOptions options{.threshold = 0.3};
  const auto found = [&](const LmdShape& at, const LmdShape& other, const auto& search) {
    return search(PosedShape{&at, SE3{}, BodyId(0)}, PosedShape{&other, g, BodyId(1)}, options);
  };
  const auto quick = [](const PosedShape& at, const PosedShape& other, const LmdOptions& o) {
    return find_contacts(at, other, o);
  };
  const auto exhaustive = [](const PosedShape& at, const PosedShape& other, const LmdOptions& o) {
    return find_contacts_exhaustive(at, other, o);
  };
  const ContactSet here = found(a, b, quick);
  tally.contacts += int(here.points.size());
  tally.off_fresh += difference(here, found(fresh_a, fresh_b, quick));
  tally.off_exhaustive += difference(here, found(a, b, exhaustive));
}

VerificationCase searches() {
  return {.name = "S2.search",
          .what = "contacts of 5000 random pairs of blocks, balls, sheets and wires, each deformed at random",
          .rows = {{"refit", "contacts that differ from those of shapes prepared afresh", "-", 0,
                    "exact: key, gap and normal to the last bit", Sense::exactly},
                   {"exhaustive", "contacts that differ from those of an exhaustive search", "-", 0,
                    "exact: key, gap and normal to the last bit", Sense::exactly},
                   {"contacts", "contacts compared", "-", 3000, "guard: the set-up", Sense::at_least}},
          .measure =
              [] {
                SearchTally tally;
                for (std::uint64_t seed = 0; seed < 5000; ++seed) add_search(seed, tally);
                return Figures{{"refit", tally.off_fresh},
                               {"exhaustive", tally.off_exhaustive},
                               {"contacts", tally.contacts}};
              },
          .slow = true};
}

struct CertificateTally {
  long samples = 0, below = 0;
  int refused = 0, rightly = 0;
};
// Rigid motion and deformation at once.
void add_certificate(std::uint64_t seed, CertificateTally& tally) {
  constexpr int kSamples = 100;
  Random random(seed);
  const LmdShape a = soft(some_complex(random)), b = soft(some_complex(random));
  const double speed = random.uniform(0, 1), turn = random.uniform(0, 2);
  const std::vector<Vec3> v_a = random_field(a, random, speed), v_b = random_field(b, random, speed);
  const SE3 g_a = random.pose(0.2);
  const SE3 g_b{random.rotation(), random.vector_of_length(0.8, 1.4)};
  const auto motion_at = [&](const SE3& g) {
    const Vec3 v = random.vector(0.5);
    return RigidMotion{g, v, turn * random.vector()};
  };
  const MovingShape m{.shape = &a, .motion = motion_at(g_a), .velocity = v_a},
      n{.shape = &b, .motion = motion_at(g_b), .velocity = v_b};
  const double dt = random.uniform(0.02, 0.3), required = 2 * kDilation;
  const Certificate proof = certify(m, n, dt, {.required = required, .wanted = 0.1});
  double nearest = kInf;
  for (int i = 0; i <= kSamples; ++i) {
    const double s = dt * i / kSamples;
    const LmdShape a_s = moved(a, v_a, s), b_s = moved(b, v_b, s);
    const double distance =
        base_distance({&a_s, {}, motion_after(m.motion, s)}, {&b_s, {}, motion_after(n.motion, s)}, 0.2);
    nearest = std::min(nearest, distance);
    if (!proof.certified) continue;
    ++tally.samples;
    tally.below += distance < std::max(required, proof.min_distance) - 1e-12;
  }
  if (!proof.certified) ++tally.refused, tally.rightly += nearest < required;
}

VerificationCase certificates() {
  return {.name = "S2.certificate",
          .what =
              "random pairs of blocks, balls, sheets and wires that move, turn and deform; each certified "
              "path sampled at 101 times",
          .rows = {{"below", "samples nearer than what is certified", "-", 0, "exact", Sense::exactly},
                   {"samples", "samples", "-", 1e5, "guard: the set-up", Sense::at_least},
                   {"refused", "of the paths refused, those that do come too near", "-", 0.5,
                    "guard: the certificate is no blanket refusal", Sense::at_least}},
          .measure =
              [] {
                CertificateTally tally;
                for (std::uint64_t seed = 0; tally.samples < 100000; ++seed) add_certificate(seed, tally);
                return Figures{{"below", double(tally.below)},
                               {"samples", double(tally.samples)},
                               {"refused", double(tally.rightly) / tally.refused}};
              },
          .slow = true};
}

}  // namespace

std::vector<VerificationCase> soft_oracle_verification() {
  return {searches(), certificates()};
}

}  // namespace aussois
