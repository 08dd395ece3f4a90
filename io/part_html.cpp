// SPDX-License-Identifier: Apache-2.0
#include "io/part_html.hpp"

#include <algorithm>

#include "geometry/check.hpp"
#include "geometry/simplicial_complex.hpp"
#include "io/html_page.hpp"

namespace aussois {
namespace {

template <class Layer>
void check(const Layer& layer, std::size_t items) {
  require(layer.colour.size() == items, "layer \"" + layer.name + "\" has " +
                                            std::to_string(layer.colour.size()) + " colours for " +
                                            std::to_string(items) + " items");
}

template <class Layer>
std::vector<std::string> names(const std::vector<Layer>& layers) {
  std::vector<std::string> all;
  for (const Layer& layer : layers) all.push_back(layer.name);
  return all;
}

template <class Layer>
std::vector<std::int64_t> shown(const std::vector<Layer>& layers) {
  std::vector<std::int64_t> all;
  for (const Layer& layer : layers) all.push_back(layer.shown ? 1 : 0);
  return all;
}

Vec3 centre_of(const PartPicture& picture) {
  Box box;
  const auto add = [&](const Vec3& x) { box = {box.lo.cwiseMin(x), box.hi.cwiseMax(x)}; };
  for (const auto& layer : picture.surfaces) std::ranges::for_each(layer.vertices, add);
  for (const auto& layer : picture.lines)
    for (const auto& line : layer.lines) std::ranges::for_each(line, add);
  for (const auto& layer : picture.points) std::ranges::for_each(layer.points, add);
  return box.lo.x() <= box.hi.x() ? Vec3(0.5 * (box.lo + box.hi)) : Vec3::Zero();
}

void append(std::vector<float>& values, const Vec3& x) {
  for (const double coordinate : x) values.push_back(float(coordinate));
}

// Coordinates are those about `centre`.
void add_surfaces(const PartPicture& picture, const Vec3& centre, PageArrays& arrays) {
  for (std::size_t i = 0; i < picture.surfaces.size(); ++i) {
    const SurfaceLayer& layer = picture.surfaces[i];
    check(layer, layer.triangles.size());
    std::vector<float> vertices;
    std::vector<std::int32_t> faces;
    for (const Vec3& x : layer.vertices) append(vertices, x - centre);
    for (const auto& corners : layer.triangles)
      for (const int corner : corners) {
        require(corner >= 0 && std::size_t(corner) < layer.vertices.size(),
                "layer \"" + layer.name + "\" has no vertex " + std::to_string(corner));
        faces.push_back(corner);
      }
    const std::string prefix = "surface" + std::to_string(i) + ".";
    arrays.add(prefix + "vertices", vertices);
    arrays.add(prefix + "faces", faces);
    arrays.add(prefix + "colour", layer.colour);
  }
}

void add_lines_and_points(const PartPicture& picture, const Vec3& centre, PageArrays& arrays) {
  for (std::size_t i = 0; i < picture.lines.size(); ++i) {
    const LineLayer& layer = picture.lines[i];
    check(layer, layer.lines.size());
    std::vector<float> ends;
    for (const auto& line : layer.lines)
      for (const Vec3& x : line) append(ends, x - centre);
    arrays.add("lines" + std::to_string(i) + ".ends", ends);
    arrays.add("lines" + std::to_string(i) + ".colour", layer.colour);
  }
  for (std::size_t i = 0; i < picture.points.size(); ++i) {
    const PointLayer& layer = picture.points[i];
    check(layer, layer.points.size());
    std::vector<float> at;
    for (const Vec3& x : layer.points) append(at, x - centre);
    arrays.add("points" + std::to_string(i) + ".at", at);
    arrays.add("points" + std::to_string(i) + ".colour", layer.colour);
  }
}

}  // namespace

void write_part_html(const std::filesystem::path& html, const PartPicture& picture) {
  const Vec3 centre = centre_of(picture);
  PageArrays arrays;
  add_surfaces(picture, centre, arrays);
  add_lines_and_points(picture, centre, arrays);
  std::vector<double> opacity;
  for (const SurfaceLayer& layer : picture.surfaces) opacity.push_back(layer.opacity);
  Summary page;
  page.set("kind", "part");
  page.set("title", picture.title);
  page.set("command_line", picture.command_line);
  page.set("build", picture.build);
  page.set("surface_name", names(picture.surfaces));
  page.set("surface_shown", shown(picture.surfaces));
  page.set("surface_opacity", opacity);
  page.set("lines_name", names(picture.lines));
  page.set("lines_shown", shown(picture.lines));
  page.set("points_name", names(picture.points));
  page.set("points_shown", shown(picture.points));
  std::vector<std::string> text, fact_name, fact_text;
  std::vector<std::int64_t> colour;
  for (const auto& [c, t] : picture.legend) colour.push_back(c), text.push_back(t);
  for (const auto& [n, t] : picture.facts) fact_name.push_back(n), fact_text.push_back(t);
  page.set("legend_colour", colour);
  page.set("legend_text", text);
  page.set("fact_name", fact_name);
  page.set("fact_text", fact_text);
  write_page(html, page, arrays);
}

}  // namespace aussois
