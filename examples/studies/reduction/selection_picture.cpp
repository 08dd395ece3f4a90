// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/reduction/selection_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace aussois {
namespace {

constexpr int kColumns = 5;
constexpr double kPanel = 190, kHead = 26, kFoot = 40, kMargin = 16;  // [px]

template <class... Values>
void print(std::string& out, const char* format, Values... values) {
  char line[512];
  std::snprintf(line, sizeof line, format, values...);
  out += line;
}

/// Where a contact lies in its panel.
struct View {
  Vec2 middle = Vec2::Zero();
  double scale = 1;
  Vec2 corner = Vec2::Zero();  // of the panel [px]
  Vec2 operator()(const Vec2& x) const {
    return corner +
           Vec2(kPanel / 2 + scale * (x - middle).x(), kHead + kPanel / 2 - scale * (x - middle).y());
  }
};

View view_of(const std::vector<Vec2>& points) {
  Vec2 lo = Vec2::Constant(kInf), hi = -lo;
  for (const Vec2& x : points) lo = lo.cwiseMin(x), hi = hi.cwiseMax(x);
  return {.middle = (lo + hi) / 2, .scale = (kPanel - 2 * kMargin) / std::max((hi - lo).maxCoeff(), 1e-9)};
}

void draw_polygon(std::string& out, const View& view, const std::vector<Vec2>& corners, const char* style) {
  out += "<polygon points=\"";
  for (const Vec2& x : corners) print(out, "%.1f,%.1f ", view(x).x(), view(x).y());
  print(out, "\" %s/>\n", style);
}

void draw(std::string& out, const View& view, const SelectionPanel& panel) {
  const Vec2 top = view.corner + Vec2(kPanel / 2, kHead - 8);
  print(out, "<text x=\"%.1f\" y=\"%.1f\" font-weight=\"bold\">%s</text>\n", top.x(), top.y(),
        panel.title.c_str());
  print(out, "<text x=\"%.1f\" y=\"%.1f\" fill=\"#555\">%s</text>\n", top.x(), top.y() + kPanel + 22,
        panel.note.c_str());
  draw_polygon(out, view, panel.hull_all, "fill=\"#f0f0f0\" stroke=\"#aaa\" stroke-width=\"0.8\"");
  draw_polygon(out, view, panel.hull_kept,
               "fill=\"#2b6cb0\" fill-opacity=\"0.16\" stroke=\"#2b6cb0\" stroke-width=\"1.2\"");
  double heaviest = 0;
  for (const double w : panel.weight) heaviest = std::max(heaviest, w);
  for (std::size_t i = 0; i < panel.weight.size() && heaviest > 0; ++i) {
    const double radius = 10 * std::sqrt(std::max(panel.weight[i], 0.0) / heaviest);
    const Vec2 at = view(panel.all[i]);
    if (radius > 0.5)
      print(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"#dd6b20\" fill-opacity=\"0.35\"/>\n",
            at.x(), at.y(), radius);
  }
  for (std::size_t i = 0; i < panel.all.size(); ++i) {
    const bool kept = std::find(panel.kept.begin(), panel.kept.end(), int(i)) != panel.kept.end();
    const Vec2 at = view(panel.all[i]);
    print(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%s\" fill=\"%s\"/>\n", at.x(), at.y(), kept ? "4" : "1.6",
          kept ? "#c53030" : "#777");
  }
}

}  // namespace

std::string selection_svg(const std::vector<SelectionPanel>& panels) {
  const int rows = (int(panels.size()) + kColumns - 1) / kColumns;
  const double width = kColumns * kPanel, height = rows * (kHead + kPanel + kFoot) + kHead;
  std::string out;
  print(out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\" "
        "font-family=\"sans-serif\" font-size=\"12\" text-anchor=\"middle\">\n<rect width=\"100%%\" "
        "height=\"100%%\" fill=\"white\"/>\n",
        width, height, width, height);
  View view = view_of(panels.front().all);
  for (int i = 0; i < int(panels.size()); ++i) {
    const int row = i / kColumns, column = i % kColumns;
    view.corner = Vec2(column * kPanel, row * (kHead + kPanel + kFoot));
    draw(out, view, panels[i]);
  }
  print(out,
        "<text x=\"%.1f\" y=\"%.1f\" fill=\"#555\">red: kept; m, A, t: what is left of the least support in "
        "any "
        "direction, of the area, of the drilling torque (1: all)</text>\n",
        width / 2, height - 8);
  return out + "</svg>\n";
}

}  // namespace aussois
