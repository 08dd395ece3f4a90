// SPDX-License-Identifier: Apache-2.0
#include "mechanics/soft_surface.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "geometry/dilated_shape.hpp"
#include "mechanics/model.hpp"
#include "mechanics/state.hpp"

namespace aussois {

BodyId add(Model& model, SoftSurface surface) {
  LmdShape shape = prepare(dilate(std::move(surface.complex), surface.radius), {.deforming = true});
  if (surface.touches_itself) {
    double longest = 0;
    for (const auto& [a, b] : shape.complex.edges)
      longest = std::max(longest, (shape.complex.vertices[a] - shape.complex.vertices[b]).norm());
    shape = touching_itself(std::move(shape), std::max(4 * surface.radius, 2 * longest));
  }
  RigidBody body = fixed_body(surface.name, add(model, std::move(shape)));
  const auto under = std::make_shared<const std::vector<int>>(std::move(surface.point_of));
  body.deformation.vertices = [under, block = surface.points](const Model& m, const State& state) {
    const VecX q = coordinates(m, state, block);
    std::vector<Vec3> out;
    out.reserve(under->size());
    for (const int point : *under) out.push_back(point_place(m.coordinates[block], q, std::size_t(point)));
    return out;
  };
  body.deformation.columns = [under, block = surface.points](const Model& m, const State&, int vertex,
                                                             std::vector<VertexColumn>& out) {
    const int first = first_speed(m, block) + 3 * (*under)[std::size_t(vertex)];
    for (int d = 0; d < 3; ++d) out.push_back({.velocity = first + d, .column = Vec3::Unit(d)});
  };
  body.deformation.field = std::move(surface.field);
  return add(model, std::move(body));
}

}  // namespace aussois
