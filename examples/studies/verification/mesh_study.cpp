// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/mesh_study.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "examples/common/gnuplot.hpp"
#include "examples/common/kept_json.hpp"
#include "examples/common/many_tasks.hpp"
#include "examples/scenes/shared_series.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

Json key_of(const MeshStudy& s, std::uint64_t program) {
  return {{"case", s.name},
          {"setting", s.setting},
          {"sizes", s.sizes},
          {"data", shared_series_digest()},
          {"program", program}};
}

Json fields_of(const MeshStudy& s, const Convergence& result) {
  return {{"error_of", s.error_of}, {"unit", s.unit},        {"counted", s.counted},
          {"errors", result.error}, {"order", result.order}, {"expected", s.order}};
}

std::string full_name(const MeshStudy& s) {
  return s.setting.empty() ? s.name : s.name + " (" + s.setting + ")";
}

std::string what_is_off(const MeshStudy& s) {
  return s.error_of + (s.unit == "-" ? ", relative" : " [" + s.unit + "]");
}

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::vector<double> lengths(const MeshStudy& s) {
  std::vector<double> out;
  for (const int size : s.sizes) out.push_back(1.0 / size);
  return out;
}

}  // namespace

const std::vector<MeshStudy>& mesh_studies() {
  static const std::vector<MeshStudy> all = [] {
    std::vector<MeshStudy> out = beam_mesh_studies();
    std::ranges::move(solid_mesh_studies(), std::back_inserter(out));
    return out;
  }();
  return all;
}

const MeshStudy& mesh_study(const std::string& name, const std::string& setting) {
  for (const MeshStudy& s : mesh_studies())
    if (s.name == name && s.setting == setting) return s;
  throw std::logic_error("there is no study of meshes " + name + " " + setting);
}

Convergence measured(const MeshStudy& study) {
  std::vector<double> errors;
  for (const int size : study.sizes) errors.push_back(study.error(size));
  return convergence_study(lengths(study), errors);
}

bool reaches_its_order(const MeshStudy& study, const Convergence& result) {
  return result.order >= study.order - kMeshOrderSlack;
}

std::string stem_of(const MeshStudy& study) {
  return file_stem(full_name(study));
}

void write_mesh_study(const std::filesystem::path& path, const MeshStudy& study, const Convergence& result,
                      std::uint64_t program) {
  write_kept(path, key_of(study, program), fields_of(study, result));
}

std::optional<Convergence> read_mesh_study(const std::filesystem::path& path, const MeshStudy& study,
                                           std::uint64_t program) {
  return read_kept(path, key_of(study, program), [&](const Json& json) {
    return convergence_study(lengths(study), json.at("errors").get<std::vector<double>>());
  });
}

bool write_picture(const std::filesystem::path& dir, const MeshStudy& study, const Convergence& result) {
  const std::string stem = stem_of(study);
  write_convergence(
      dir, stem, result,
      {.step = "1 / number of " + study.counted, .error = what_is_off(study), .order = study.order});
  return run_gnuplot(dir, stem + ".gp");
}

std::string to_json(const std::vector<MeshResult>& results, std::uint64_t program) {
  Json out = Json::array();
  for (const auto& [study, errors] : results)
    out.push_back(with_key(key_of(*study, program), fields_of(*study, errors)));
  return file_text(out);
}

std::string mesh_table(const std::vector<MeshResult>& results) {
  std::string out = "| case | what is off | meshes | errors | order | theory |\n|---|---|---|---|---|---|\n";
  for (const auto& [study, result] : results) {
    std::string sizes, errors;
    for (std::size_t i = 0; i < study->sizes.size(); ++i) {
      sizes.append(i > 0 ? ", " : "").append(std::to_string(study->sizes[i]));
      errors.append(i > 0 ? ", " : "").append(number("%.2e", result.error[i]));
    }
    const std::string order = number("%.2f", result.order);
    out += "| `" + full_name(*study) + "` | " + what_is_off(*study) + " | " + sizes + " " + study->counted +
           " | " + errors + " | " + (reaches_its_order(*study, result) ? order : "**" + order + "**") +
           " | " + number("%g", study->order) + " |\n";
  }
  return out;
}

}  // namespace aussois
