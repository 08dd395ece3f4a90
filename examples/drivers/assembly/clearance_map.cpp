// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/clearance_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "geometry/parallel.hpp"
#include "geometry/primitives.hpp"
#include "io/atomic_file.hpp"
#include "io/text.hpp"
#include "lmd/certificate.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {
namespace {

LmdShape point_shape() {
  return prepare({.complex = make_point(), .radius = 0});
}

// The stops of the replay page, even to the eye.
std::array<int, 3> colour(double share) {
  constexpr double kStops[][3] = {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
  if (!(share >= 0 && share <= 1)) return {128, 128, 128};
  const int at = std::min(3, int(4 * share));
  std::array<int, 3> out{};
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = int(std::lround(std::lerp(kStops[at][k], kStops[at + 1][k], 4 * share - at)));
  return out;
}

}  // namespace

ClearanceMapper::ClearanceMapper(const LmdShape& part, const LmdShape& other, double cutoff, int threads)
    : part_(part), other_(other), threads_(threads), point_(point_shape()) {
  const std::size_t n = part.complex.vertices.size();
  map_.distance.assign(n, cutoff);
  map_.pose.assign(n, -1);
  asked_at_.resize(n);
  last_.resize(n);
  then_.assign(n, -kInf);
}

void ClearanceMapper::add(const SE3& part_in_other) {
  const int n = int(map_.distance.size());
  std::vector<char> asked(std::size_t(n), 0);
  std::vector<double> moved(std::size_t(n), 0);
  parallel_for(n, threads_, [&](int i) {
    const auto k = std::size_t(i);
    const Vec3 x = part_in_other * part_.complex.vertices[k];
    if (poses_ > 0) moved[k] = (x - last_[k]).norm();
    last_[k] = x;
    if (then_[k] - (x - asked_at_[k]).norm() >= map_.distance[k]) return;
    asked[k] = 1;
    // Twice the record: what is farther than it is not asked again until it has come nearer by the difference
    const double distance = base_distance({&point_, {}, {.g = translation(x.x(), x.y(), x.z())}},
                                          {&other_, {}, {}}, 2 * map_.distance[k]);
    asked_at_[k] = x;
    then_[k] = distance;
    if (distance < map_.distance[k]) map_.distance[k] = distance, map_.pose[k] = poses_;
  });
  asked_ += std::count(asked.begin(), asked.end(), 1);
  // A vertex on its chord is within half of its way of one of the two ends
  map_.between = std::max(map_.between, 0.5 * *std::ranges::max_element(moved));
  ++poses_;
}

void write_clearance_ply(const std::filesystem::path& path, const SimplicialComplex& mesh,
                         const ClearanceMap& map, double largest) {
  std::string out =
      "ply\nformat ascii 1.0\ncomment least distance of each vertex over the way [m]\nelement vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\nproperty double quality\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (const double x : mesh.vertices[i]) append_number(out, x), out += ' ';
    append_number(out, map.distance[i]);
    for (const int part : colour(map.distance[i] / largest)) out += ' ' + std::to_string(part);
    out += '\n';
  }
  for (const auto& t : mesh.triangles)
    out += "3 " + std::to_string(t[0]) + ' ' + std::to_string(t[1]) + ' ' + std::to_string(t[2]) + '\n';
  write_whole_file(path, out);
}

}  // namespace aussois
