// SPDX-License-Identifier: Apache-2.0
#include "io/part_html.hpp"

#include <gtest/gtest.h>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

PartPicture triangle_picture() {
  PartPicture picture{.title = "a triangle"};
  picture.surfaces.push_back({.name = "face",
                              .vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                              .triangles = {{0, 1, 2}},
                              .colour = {0xff8000}});
  picture.lines.push_back({.name = "side", .lines = {{Vec3(0, 0, 0), Vec3(1, 0, 0)}}, .colour = {1}});
  picture.points.push_back({.name = "corner", .points = {{0, 1, 0}}, .colour = {2}});
  return picture;
}

TEST(PartHtml, IsOnePageThatFetchesNothing) {
  const auto file = fresh_folder() / "part.html";
  write_part_html(file, triangle_picture());
  const std::string page = content_of(file);
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_EQ(page.find("<!--RUN-->"), std::string::npos) << "the blob is in its place";
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
}

TEST(PartHtml, RefusesLayersThatDoNotFit) {
  const auto file = fresh_folder() / "part.html";
  PartPicture colours = triangle_picture(), index = triangle_picture();
  colours.lines[0].colour.clear();
  index.surfaces[0].triangles[0][2] = 3;
  EXPECT_NE(message_of([&] { write_part_html(file, colours); }).find("side"), std::string::npos);
  EXPECT_NE(message_of([&] { write_part_html(file, index); }).find("no vertex 3"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace aussois
