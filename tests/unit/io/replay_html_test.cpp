// SPDX-License-Identifier: Apache-2.0
#include "io/replay_html.hpp"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <zlib.h>

#include <nlohmann/json.hpp>

#include "tests/support/little_memory.hpp"
#include "tests/unit/io/io_samples.hpp"

namespace aussois {
namespace {

/// What the page's own script does, written another way: base64 by a table of digits, gzip by zlib.
std::string decoded(const std::string& page) {
  const std::string open = "<script type=\"text/plain\" id=\"run\">";
  const std::size_t begin = page.find(open) + open.size(), end = page.find("</script>", begin);
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (std::size_t i = begin; i < end && page[i] != '='; ++i) {
    const std::size_t digit = digits.find(page[i]);
    EXPECT_NE(digit, std::string::npos) << "not base64 at " << i;
    bits = bits << 6 | unsigned(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += char(bits >> count & 255);
  }
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_in = uInt(bytes.size());
  std::string plain;
  int status = Z_OK;
  while (status == Z_OK) {
    char chunk[1 << 16];
    stream.next_out = reinterpret_cast<Bytef*>(chunk);
    stream.avail_out = sizeof chunk;
    status = inflate(&stream, Z_NO_FLUSH);
    plain.append(chunk, sizeof chunk - stream.avail_out);
  }
  inflateEnd(&stream);
  EXPECT_EQ(status, Z_STREAM_END);
  return plain;
}

struct Page {
  std::string html{};
  nlohmann::json header{};
  std::map<std::string, std::string> arrays{};

  explicit Page(const std::filesystem::path& path) : html(content_of(path)) {
    const std::string blob = decoded(html);
    std::uint32_t length = 0;
    std::memcpy(&length, blob.data(), 4);
    header = nlohmann::json::parse(blob.substr(4, length));
    std::size_t at = 4 + length;
    EXPECT_EQ(at % 4, 0u) << "typed arrays must be aligned";
    for (const std::string entry : header["arrays"]) {
      const std::size_t last = entry.rfind(':'), bytes = 4 * std::stoul(entry.substr(last + 1));
      arrays[entry.substr(0, last)] = blob.substr(at, bytes);
      at += bytes;
    }
    EXPECT_EQ(at, blob.size());
  }
  std::vector<float> floats(const std::string& name) const {
    const std::string& bytes = arrays.at(name + ":f32");
    std::vector<float> values(bytes.size() / 4);
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  std::vector<std::int32_t> ints(const std::string& name) const {
    const std::string& bytes = arrays.at(name + ":i32");
    std::vector<std::int32_t> values(bytes.size() / 4);
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
};

/// World point of mesh vertex `v` of `body` in frame `k` as the page draws it, relative to the page's origin.
Vec3 drawn(const Page& page, int bodies, int k, int body, const std::vector<float>& vertices, int v) {
  const std::vector<float> pose = page.floats("pose");
  const float* g = pose.data() + 7 * (k * bodies + body);
  const Quat R(g[6], g[3], g[4], g[5]);
  return R * Vec3(vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]) + Vec3(g[0], g[1], g[2]);
}

}  // namespace

TEST(ReplayHtml, NeedsNothingButItself) {
  const auto path = fresh_folder() / "replay.html";
  write_replay_html(path, peg_run(120));
  const std::string html = content_of(path);
  // Whatever makes a browser fetch; the namespaces of SVG and XHTML in three.js are names, not addresses.
  for (const char* fetched :
       {"<link", "<img", "<iframe", "@import", "src=\"", "src='", "href=\"", "href='", "url(http",
        "url(\"http", "url('http", "fetch(\"http", "fetch('http", "fetch(`http", "import(\"http",
        "import('http", "from\"http", "from 'http", "sourceMappingURL"})
    EXPECT_EQ(html.find(fetched), std::string::npos) << fetched << html.substr(html.find(fetched), 80);
  EXPECT_NE(html.find("three.js authors"), std::string::npos) << "the notice of three.js must travel with it";
  EXPECT_EQ(html.find("<!--RUN-->"), std::string::npos);
}

TEST(ReplayHtml, TellsOfJoints) {
  const auto path = fresh_folder() / "replay.html";
  RunData run = peg_run(3);
  run.header.joints = {{"guide", "prismatic", {1, -1}}, {"clamp", "fixed", {1, 0}}};
  for (RunStep& step : run.steps)
    step.joints = {{.coordinate = Vec3(0.1, 0, 0), .force = Vec3(3, 0, 4), .effort = Vec3(7, 0, 0)},
                   {.torque = Vec3(0, 0, double(step.step))}};
  write_replay_html(path, run);
  const Page page(path);
  EXPECT_EQ(page.header["joint_name"], (std::vector<std::string>{"guide", "clamp"}));
  EXPECT_EQ(page.header["joint_kind"], (std::vector<std::string>{"prismatic", "fixed"}));
  EXPECT_EQ(page.floats("joint.force"), (std::vector<float>{5, 0, 5, 0, 5, 0}));
  EXPECT_EQ(page.floats("joint.coordinate").size(), 18u);
  EXPECT_EQ(page.floats("joint.coordinate")[6], 0.1F);
  EXPECT_EQ(page.floats("joint.effort")[12], 7);
  EXPECT_EQ(page.floats("joint.torque")[5], float(run.steps[2].step));
}

TEST(ReplayHtml, HoldsTheRun) {
  const auto path = fresh_folder() / "replay.html";
  const RunData run = peg_run(120);
  write_replay_html(path, run);
  const Page page(path);
  EXPECT_EQ(page.header["title"], run.header.title);
  EXPECT_EQ(page.header["recorded"], 120);
  EXPECT_EQ(page.header["step"].size(), 120u);
  EXPECT_EQ(page.header["body_name"], (std::vector<std::string>{"bush", "peg"}));
  EXPECT_EQ(page.header["body_fixed"], (std::vector<int>{1, 0}));
  EXPECT_EQ(page.header["body_mesh"], (std::vector<int>{0, 1}));
  EXPECT_EQ(page.floats("frame.time").size(), 120u);
  EXPECT_EQ(page.floats("frame.min_gap")[0] == page.floats("frame.min_gap")[0], false)
      << "no gap: not a number";
  const auto offset = page.ints("contact.offset");
  ASSERT_EQ(offset.size(), 121u);
  for (int k = 0; k < 120; ++k) EXPECT_EQ(offset[k + 1] - offset[k], k % 6);

  // A is the fixed bush in every contact, so the page shows B's side: normal and force reversed, at point_b.
  const std::size_t c = std::size_t(offset[7]);
  const RunContact& contact = run.steps[7].contacts[0];
  const Vec3 origin = run.steps[0].pose[1].p;  // where the only moving body begins
  for (int d = 0; d < 3; ++d) {
    const std::size_t at = 3 * c + std::size_t(d);
    EXPECT_NEAR(page.floats("contact.point")[at], contact.point_b[d] - origin[d], 1e-8);
    EXPECT_NEAR(page.floats("contact.normal")[at], -contact.normal[d], 1e-6);
    EXPECT_NEAR(page.floats("contact.force")[at], -contact.impulse[d] / run.steps[7].h, 1e-5);
  }
}

TEST(ReplayHtml, DrawsEveryVertexWhereTheBodyIs) {
  const auto path = fresh_folder() / "replay.html";
  RunData run = peg_run(30);
  const SE3 far = translation(1000, -2000, 500);  // a part far from the origin keeps its digits
  for (RunStep& step : run.steps)
    for (SE3& g : step.pose) g = far * g;
  write_replay_html(path, run);
  const Page page(path);
  const Vec3 origin = run.steps[0].pose[1].p;
  for (const int k : {0, 13, 29})
    for (const int body : {0, 1}) {
      const RunBody& row = run.header.bodies[body];
      const RunMesh& mesh = run.header.meshes.at(row.mesh);
      const std::vector<float> vertices = page.floats("mesh" + std::to_string(body) + ".vertices");
      ASSERT_EQ(vertices.size(), 3 * mesh.vertices.size());
      for (const int v : {0, 17, 200}) {
        const Vec3 x = run.steps[k].pose[body] * (row.g_bs * mesh.vertices[v]);
        EXPECT_LT((drawn(page, 2, k, body, vertices, v) - (x - origin)).norm(), 2e-8);  // float32 of 0.05 m
      }
    }
}

TEST(ReplayHtml, ThinsFramesButKeepsTheEndsAndThePeaks) {
  const auto path = fresh_folder() / "replay.html";
  RunData run = peg_run(1000);
  run.steps[613].residual = 0.5;
  run.steps[614].min_gap = -4e-5;
  run.steps[615].coupling_force = Vec3(0, 0, 900);
  run.steps[616].gauges[1] = -40;
  write_replay_html(path, run, {.max_frames = 50, .max_plot_points = 64});
  const Page page(path);
  const std::vector<int> steps = page.header["step"];
  ASSERT_EQ(steps.size(), 50u);
  EXPECT_EQ(steps.front(), 0);
  EXPECT_EQ(steps.back(), 999);
  for (std::size_t i = 1; i < steps.size(); ++i) EXPECT_NEAR(steps[i] - steps[i - 1], 999.0 / 49, 1);
  EXPECT_EQ(page.header["recorded"], 1000);
  const auto curve = [&](const char* name) { return page.floats(std::string("curve.") + name); };
  EXPECT_EQ(curve("time").size(), 64u);
  const auto residual = curve("residual");
  EXPECT_EQ(*std::max_element(residual.begin(), residual.end()), 0.5f);
  const auto gap = curve("min_gap");
  EXPECT_EQ(*std::min_element(gap.begin(), gap.end()), -4e-5f);
  const auto pull = curve("coupling");
  EXPECT_EQ(*std::max_element(pull.begin(), pull.end()), 900.f);
  EXPECT_EQ(page.header["gauge_name"], run.header.gauges);
  const auto work = curve("gauge1");
  EXPECT_EQ(*std::min_element(work.begin(), work.end()), -40.f);
  EXPECT_EQ(page.floats("frame.gauge0").back(), 1.f);
}

// A page is drawn from a file in one pass: it is the page of the run in memory, and a run that is four times
// as long takes no more memory.
TEST(ReplayHtml, IsDrawnFromAFileOfAnyLength) {
  const auto folder = fresh_folder();
  const auto write = [&](const std::string& name, int steps) {
    RunWriter writer(folder / name, peg_header());
    for (int k = 0; k < steps; ++k) writer.append(peg_step(k, steps - 1));
    writer.close();
  };
  const auto draw = [&](const std::string& name, const std::string& page) {
    RunReader reader(folder / name);
    write_replay_html(folder / page, reader, {.max_frames = 50, .max_plot_points = 64});
  };
  write("short.h5", 1000);
  draw("short.h5", "file.html");
  write_replay_html(folder / "memory.html", peg_run(1000), {.max_frames = 50, .max_plot_points = 64});
  EXPECT_EQ(content_of(folder / "file.html"), content_of(folder / "memory.html"));
#ifdef AUSSOIS_LIMIT_MEMORY
  write("10000.h5", 10000);
  write("40000.h5", 40000);
  const double of_10000 = peak_memory_of([&] { draw("10000.h5", "10000.html"); }),
               of_40000 = peak_memory_of([&] { draw("40000.h5", "40000.html"); }),
               in_memory = peak_memory_of([&] { (void)read_run(folder / "40000.h5"); });
  ASSERT_GT(of_10000, 0);
  ASSERT_GT(of_40000, 0);
  EXPECT_LT(of_40000 - of_10000, 4e6);
  EXPECT_GT(in_memory - of_40000, 4e7);  // what it would be if all steps were read
#endif
}

TEST(ReplayHtml, TakesNamesThatLookLikeMarkup) {
  const auto path = fresh_folder() / "replay.html";
  RunData run = peg_run(3);
  run.header.title = "</script><script>alert(1)</script>";
  run.header.bodies[1].name = "\"peg\" & <b>";
  write_replay_html(path, run);
  EXPECT_EQ(content_of(path).find("alert(1)"), std::string::npos);
  EXPECT_EQ(Page(path).header["title"], run.header.title);
}

TEST(ReplayHtml, RefusesWhatItCannotShow) {
  const auto path = fresh_folder() / "replay.html";
  EXPECT_THROW(write_replay_html(path, {peg_header(), {}}), std::invalid_argument);
  EXPECT_THROW(write_replay_html(path, peg_run(3), {.max_frames = 1}), std::invalid_argument);
  RunData run = peg_run(3);
  run.steps[1].pose.clear();
  EXPECT_THROW(write_replay_html(path, run), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THROW(write_replay_html(path / "no" / "replay.html", peg_run(3)), std::runtime_error);
}

}  // namespace aussois
