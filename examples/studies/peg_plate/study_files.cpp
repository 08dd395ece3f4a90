// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/peg_plate/study_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "examples/common/gnuplot.hpp"
#include "examples/common/kept_json.hpp"
#include "geometry/check.hpp"
#include "geometry/settings.hpp"
#include "io/atomic_file.hpp"
#include "io/csv_table.hpp"
#include "io/number_table.hpp"
#include "reduction/learned_selector.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> kColumns{"t",  "static", "px", "py", "pz", "qw", "qx", "qy",
                                        "qz", "vx",     "vy", "vz", "wx", "wy", "wz", "fx",
                                        "fy", "fz",     "tx", "ty", "tz", "Fx", "Fy", "Fz"};

struct ScoreField {
  const char* name;
  double PegScore::*value;
};
constexpr std::array kScoreFields{
    ScoreField{"static_size", &PegScore::still_size},  ScoreField{"static_vector", &PegScore::still},
    ScoreField{"moving_size", &PegScore::moving_size}, ScoreField{"moving_vector", &PegScore::moving},
    ScoreField{"chatter_N", &PegScore::chatter},       ScoreField{"case_mean", &PegScore::case_mean},
    ScoreField{"case_worst", &PegScore::case_worst}};

// By what a training check and a result are found in their files.
Json seed_key(std::uint64_t seed) {
  return Json::object({{"seed", seed}});
}

Json result_key(const std::string& set, std::uint64_t seed) {
  return {{"reference", "synthetic"}, {"set", set}, {"seed", seed}};
}

std::string preamble(const char* name, const char* size) {
  return std::string("# draws ") + name + ".png: gnuplot " + name + ".gp\nset terminal pngcairo size " +
         size + "; set output '" + name + ".png'\nset datafile separator ','; set grid\n";
}

// What the picture of forces shows, beside what was measured.
struct Curve {
  const char *method, *colour;
};
constexpr Curve kCurves[] = {{"kmc", "#88ccee"},        {"kmcw", "#ddaa33"},    {"mlc_argmin", "#aa4499"},
                             {"mlc_ranked", "#117733"}, {"upright", "#ddaa33"}, {"mlc_soft", "#cc6677"}};

// |F| over one test case.
bool draw_forces(const std::filesystem::path& folder, const std::vector<PegSample>& samples,
                 const std::vector<NamedMethod>& methods, const PegStudyOptions& options) {
  const bool edge = options.plant.scenario == PegScenario::edge;
  std::vector<std::string> columns{"t", "measured"};
  std::vector<PegMethod> made;
  std::string curves;
  for (const Curve& curve : kCurves) {
    const auto found = std::ranges::find(methods, curve.method, &NamedMethod::name);
    if (found == methods.end() || (!edge && found->name == "mlc_soft")) continue;
    made.push_back(found->make());
    columns.push_back(found->name);
    curves +=
        ", '' using 1:" + std::to_string(columns.size()) + " with lines lw 1.2 lc rgb '" + curve.colour + "'";
  }
  CsvTable csv(folder / "forces.csv", columns);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const PegSample& s = samples[i];
    std::vector<double> row{s.t, s.plate_force.norm()};
    for (const PegMethod& method : made)
      row.push_back(plate_force(options.view, s, method(s, i == 0)).norm());
    csv.add(row);
  }
  csv.close();
  write_whole_file(folder / "forces.gp",
                   preamble("forces", "1100,600") +
                       "set key autotitle columnhead outside right noenhanced\n" +
                       "set title 'Force on the plate over one test case; synthetic reference' noenhanced\n" +
                       "set xlabel 'time [s]'; set ylabel '|F| [N]'; set yrange [0:30]\n" +
                       "plot 'forces.csv' using 1:2 with lines lw 5 lc 'grey70'" + curves + "\n");
  return run_gnuplot(folder, "forces.gp");
}

// The face with its places, how often each is chosen in static samples, and the centres of pressure.
bool draw_places(const std::filesystem::path& folder, const std::vector<const PegSample*>& still,
                 const Network& network) {
  const std::vector<Vec3> places = face_places();
  std::vector<int> count(places.size(), 0);
  CsvTable pressure(folder / "pressure.csv", {"x_mm", "y_mm"});
  for (const PegSample* s : still) {
    const Vec2 at = 1e3 * centre_of_pressure(*s);
    pressure.add({at.x(), at.y()});
    for (const int i : learned_outputs(PegScenario::surface, network, *s)) ++count[i];
  }
  pressure.close();
  CsvTable csv(folder / "choices.csv", {"x_mm", "y_mm", "share"});
  for (std::size_t i = 0; i < places.size(); ++i)
    csv.add({1e3 * places[i].x(), 1e3 * places[i].y(), double(count[i]) / double(still.size())});
  csv.close();
  const double r = 1e3 * Peg().radius;
  std::ostringstream gp;
  gp << preamble("choices", "760,760") << "set size ratio -1; set key outside bottom center horizontal\n"
     << "set title 'Places that the network chooses, static test samples; synthetic reference' noenhanced\n"
     << "set xlabel 'x [mm]'; set ylabel 'y [mm]'; set xrange [-30:30]; set yrange [-30:30]\n"
     << "set object 1 circle at 0,0 size " << r << " fs empty border lc 'grey50'\n"
     << "set object 2 circle at 0,0 size " << 0.3 * r << " fs empty border lc 'grey70' dt 2\n"
     << "plot 'pressure.csv' every ::1 using 1:2 with points pt 7 ps 0.4 lc rgb '#cc6677' title 'centre of "
        "pressure', "
     << "'choices.csv' every ::1 using 1:2 with points pt 7 ps 0.8 lc 'black' title 'places', "
     << "'' every ::1 using 1:2:(2.2*$3) with circles fs transparent solid 0.4 lc rgb '#4477aa' "
     << "title 'chosen (radius by share)', "
     << "'' every ::1 using 1:2:($3 > 0.005 ? sprintf('%.0f %%', 100*$3) : '') with labels offset 2.2,1 "
        "notitle\n";
  write_whole_file(folder / "choices.gp", gp.str());
  return run_gnuplot(folder, "choices.gp");
}

// How often each of the 49 normals is chosen.
bool draw_normals(const std::filesystem::path& folder, const std::vector<const PegSample*>& still,
                  const Network& network) {
  std::vector<int> count(std::size_t(network.outputs()), 0);
  for (const PegSample* s : still)
    for (const int i : learned_outputs(PegScenario::edge, network, *s)) ++count[i];
  CsvTable csv(folder / "choices.csv", {"about_y_deg", "about_x_deg", "share"});
  for (int i = 0; i < int(count.size()); ++i) {
    const int about_y = i / 7 - 3, about_x = i % 7 - 3;
    csv.add({15.0 * about_y, 15.0 * about_x, double(count[i]) / double(still.size())});
  }
  csv.close();
  std::ostringstream gp;
  gp << preamble("choices", "760,700")
     << "set size ratio -1; unset grid; set palette defined (0 'white', 1 '#4477aa')\n"
     << "set title 'Normals that the network chooses, static test samples; synthetic reference' noenhanced\n"
     << "set xlabel 'angle along x [deg]'; set ylabel 'angle along y [deg]'; set xtics 15; set ytics 15\n"
     << "set cblabel 'share'; set cbrange [0:*]\n"
     << "plot [-52.5:52.5][-52.5:52.5] 'choices.csv' every ::1 using 1:2:3 with image notitle, "
     << "'' every ::1 using 1:2:($3 > 0.005 ? sprintf('%.0f %%', 100*$3) : '') with labels notitle\n";
  write_whole_file(folder / "choices.gp", gp.str());
  return run_gnuplot(folder, "choices.gp");
}

}  // namespace

void claim_folder(const std::filesystem::path& folder, const PegStudyOptions& options) {
  std::filesystem::create_directories(folder / "samples");
  const std::filesystem::path path = folder / "options.json";
  const Json wanted = settings_json(options);
  const std::optional<Json> found = read_kept(path, {}, [](const Json& json) {
    return Json(json.get_ref<const Json::object_t&>());  // throws if it is none
  });
  if (!found) return write_kept(path, wanted, {});
  for (const auto& [name, value] : wanted.items())
    require(found->value(name, Json()) == value, path.string() + ": the study there has " + name + " = " +
                                                     found->value(name, Json()).dump() + ", not " +
                                                     value.dump() + "; choose another folder");
}

std::filesystem::path samples_file(const std::filesystem::path& folder, int index) {
  char name[20];
  std::snprintf(name, sizeof name, "%03d.csv", index);
  return folder / "samples" / name;
}

void write_samples(const std::filesystem::path& path, const std::vector<PegSample>& samples) {
  CsvTable csv(path, kColumns);
  for (const PegSample& s : samples) {
    const Quat& R = s.g.R;
    csv.add({s.t,
             double(s.is_static),
             s.g.p.x(),
             s.g.p.y(),
             s.g.p.z(),
             R.w(),
             R.x(),
             R.y(),
             R.z(),
             s.v.x(),
             s.v.y(),
             s.v.z(),
             s.omega.x(),
             s.omega.y(),
             s.omega.z(),
             s.force.x(),
             s.force.y(),
             s.force.z(),
             s.torque.x(),
             s.torque.y(),
             s.torque.z(),
             s.plate_force.x(),
             s.plate_force.y(),
             s.plate_force.z()});
  }
  csv.close();
}

std::vector<PegSample> read_samples(const std::filesystem::path& path) {
  const NumberTable table = read_number_table(path);
  if (table.columns != kColumns)
    throw std::runtime_error(path.string() + ":1: the columns are not those of samples");
  std::vector<PegSample> out;
  for (const std::vector<double>& x : table.rows)
    out.push_back({.t = x[0],
                   .is_static = x[1] != 0,
                   .g = pose_in(table, out.size(), {2, 3, 4, 5, 6, 7, 8}, path),
                   .v = Vec3(x[9], x[10], x[11]),
                   .omega = Vec3(x[12], x[13], x[14]),
                   .force = Vec3(x[15], x[16], x[17]),
                   .torque = Vec3(x[18], x[19], x[20]),
                   .plate_force = Vec3(x[21], x[22], x[23])});
  return out;
}

PegData read_data(const std::filesystem::path& folder, int cases) {
  PegData data;
  for (int i = 0; i < cases; ++i) data.push_back(read_samples(samples_file(folder, i)));
  return data;
}

void write_lessons(const std::filesystem::path& path, const LessonsLearnt& lessons) {
  write_kept(path, {},
             {{"best_choice", lessons.best_choice}, {"upright_share", number_json(lessons.upright_share)}});
}

std::optional<LessonsLearnt> read_lessons(const std::filesystem::path& path, PegScenario scenario) {
  return read_kept(path, {}, [&](const Json& json) {
    const LessonsLearnt out{json.at("best_choice"), number_in(json.at("upright_share"))};
    require_field(out.best_choice >= 0 && out.best_choice < int(peg_choices(scenario).size()), "best_choice",
                  out.best_choice, "be one of the scenario's choices");
    return out;
  });
}

void write_result(const std::filesystem::path& path, const PegResult& result) {
  Json json{{"upright_share", number_json(result.upright_share)}, {"methods", Json::object()}};
  for (const PegScore& score : result.scores)
    for (const ScoreField& field : kScoreFields)
      json["methods"][score.name][field.name] = number_json(score.*field.value);
  write_kept(path, result_key(result.set, result.seed), json);
}

std::optional<PegResult> read_result(const std::filesystem::path& path, const std::string& set,
                                     std::uint64_t seed) {
  return read_kept(path, result_key(set, seed), [&](const Json& json) {
    PegResult out{.set = set, .seed = seed, .upright_share = number_in(json.at("upright_share"))};
    for (const auto& [name, fields] : json.at("methods").items()) {
      PegScore score{.name = name};
      for (const ScoreField& field : kScoreFields) score.*field.value = number_in(fields.at(field.name));
      out.scores.push_back(score);
    }
    return out;
  });
}

void write_training_check(const std::filesystem::path& path, const TrainingCheck& check) {
  write_kept(path, seed_key(check.seed),
             {{"gradient_error", number_json(check.gradient)},
              {"weights_that_differ", check.weights_that_differ},
              {"loss", number_json(check.loss)},
              {"reference_loss", kSciPyLoss},
              {"loss_error", number_json(check.loss_error())}});
}

std::optional<TrainingCheck> read_training_check(const std::filesystem::path& path, std::uint64_t seed) {
  return read_kept(path, seed_key(seed), [&](const Json& json) {
    return TrainingCheck{.seed = seed,
                         .gradient = number_in(json.at("gradient_error")),
                         .weights_that_differ = json.at("weights_that_differ"),
                         .loss = number_in(json.at("loss"))};
  });
}

bool write_pictures(const std::filesystem::path& folder, const PegData& data, const std::vector<int>& cases,
                    const std::vector<NamedMethod>& methods, const Network& network,
                    const PegStudyOptions& options) {
  const bool drawn = draw_forces(folder, data[cases.front()], methods, options);
  std::vector<const PegSample*> still;
  for (const int i : cases)
    for (const PegSample& s : data[i])
      if (s.is_static) still.push_back(&s);
  if (still.empty()) return drawn;
  return (options.plant.scenario == PegScenario::surface ? draw_places(folder, still, network)
                                                         : draw_normals(folder, still, network)) &&
         drawn;
}

}  // namespace aussois
