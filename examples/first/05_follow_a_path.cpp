// SPDX-License-Identifier: Apache-2.0
// A box is pulled along a path that dips below a table: the spring pulls, the table and friction hold back.
// Folder out_first gets run.h5, steps.csv and replay.html for a browser.
#include <cstdio>

#include "geometry/primitives.hpp"
#include "io/record.hpp"
#include "io/recording.hpp"
#include "io/replay_html.hpp"
#include "mechanics/virtual_coupling.hpp"

namespace au = aussois;

int main() {
  au::Model model;
  model.contact_law.mu = 0.4;
  const au::SimplicialComplex box = au::make_box(0.1, 0.1, 0.1);
  add(model, au::fixed_body("table", add(model, prepare(dilate(au::make_plate(2, 1), 1e-3)))));
  const auto part =
      add(model, solid_body("box", add(model, prepare(dilate(box, 1e-3))), mass_properties(box, 500)));

  const au::Trajectory path{.t = {0, 1, 2},  // [s]
                            .pose = {{au::Quat::Identity(), au::Vec3(-0.5, 0, 0.2)},
                                     {au::Quat::Identity(), au::Vec3(0, 0, 0.04)},  // 12 mm into the table
                                     {au::Quat::Identity(), au::Vec3(0.5, 0, 0.2)}}};
  const au::VirtualCouplingOptions spring{.stiffness = 2000, .rotation_stiffness = 20};
  add(model, virtual_coupling(model, part, path, spring));

  au::State state = rest_state(model);
  pose(state, part) = path.pose.front();
  au::RecordingOptions files{.folder = "out_first"};
  files.pull = [&](const au::State& now) { return coupling_wrench(model, now, part, path, spring, now.t); };
  std::filesystem::create_directories(files.folder);
  std::vector<au::Gauge> gauges = au::gauges({"t", "contacts", "min_gap", "residual"});
  gauges.push_back({.column = "pull",
                    .total = "largest_pull",
                    .keep = au::GaugeTotal::most,
                    .value = [&](const au::Frame& f) { return files.pull(f.state).force.norm(); }});

  au::Recording recording(model, run_header(model), gauges, files, state);
  const au::StepReport last =
      record_run(au::make_scheme("moreau_jean", model, {.step = {.h = 2e-3}}), state, 2, recording);
  recording.close();
  au::RunReader run(files.folder / "run.h5");
  au::write_replay_html(files.folder / "replay.html", run);
  std::printf("%lld steps, largest pull %.1f N\n", static_cast<long long>(recording.steps()),
              recording.total("largest_pull"));
  const bool held = recording.total("min_gap") > -1e-4;                // by the table [m]
  const bool pulled = recording.total("largest_pull") > 2000 * 0.012;  // stiffness times the dip [N]
  return last.ok() && held && pulled ? 0 : 1;
}
