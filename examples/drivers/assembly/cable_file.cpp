// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/cable_file.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "examples/common/json_fields.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

constexpr Range kElements{2, 10000};

std::string item(std::string list, std::size_t i) {
  return list.append("[").append(std::to_string(i)).append("]");
}

/// Takes the options of a table from an object; those that it does not name keep their values.
class SettingReader final : public SettingVisitor {
 public:
  explicit SettingReader(Fields& fields) : fields_(fields) {}
  void number(const Setting& setting, double& value) override {
    if (fields_.has(setting.name) || !contains(setting.range, value))
      value = fields_.number(setting.name, setting.range);
  }
  void count(const Setting&, int&) override {}
  void toggle(const Setting&, bool&) override {}
  void seed(const Setting&, std::uint64_t&) override {}

 private:
  void choose(const Setting&, Choice&) override {}
  Fields& fields_;
};

OnPart place_in(Fields& fields) {
  OnPart out;
  const std::string part = fields.text("part");
  if (part != "fixed" && part != "moving")
    fields.fail("part", "= " + aussois::quoted(part) + " must be fixed or moving");
  out.moving = part == "moving";
  out.at = fields.vector("at");
  out.along = fields.vector("along");
  out.along.stableNormalize();
  if (!(std::abs(out.along.norm() - 1) < 1e-9)) fields.fail("along", "must not be zero");
  return out;
}

OnPart end_in(Fields fields) {
  OnPart out = place_in(fields);
  fields.end();
  return out;
}

CableStop clip_in(Fields fields, double cable_radius) {
  CableStop out{.place = place_in(fields),
                .hole = fields.number("hole", positive_range()),
                .thickness = fields.number("thickness", positive_range())};
  fields.end();
  if (!(out.hole > cable_radius))
    fields.fail("hole", "= " + number_text(out.hole) + " must exceed the cable's radius, " +
                            number_text(cable_radius));
  return out;
}

RoutedCable cable_in(const Json& json, const std::string& where, std::string name) {
  Fields fields(json, where);
  RoutedCable out{.name = std::move(name)};
  if (fields.has("name")) out.name = fields.text("name");
  const bool plain = std::ranges::all_of(out.name, [](unsigned char c) { return c >= 32 && c != '/'; });
  if (!plain || out.name.empty() || out.name == ".")
    fields.fail("name",
                "= " + aussois::quoted(out.name) + " must be a word without / and control characters");
  Fields section = fields.object("section");
  SettingReader reader(section);
  describe(reader, out.section);
  section.end();
  const double elements = fields.number("elements", kElements);
  if (elements != std::floor(elements))
    fields.fail("elements", "= " + number_text(elements) + " must be a whole number");
  out.elements = int(elements);
  out.from = end_in(fields.object("from"));
  out.to = end_in(fields.object("to"));
  if (fields.has("via")) {
    const Json& list = fields.take("via");
    if (!list.is_array()) fields.fail("via", "must be a list");
    for (std::size_t i = 0; i < list.size(); ++i)
      out.via.push_back(list[i].is_array()
                            ? CableStop{.place = {.at = fields.vector_in(list[i], item("via", i))}}
                            : clip_in({list[i], fields.inside(item("via", i))}, out.section.radius));
  }
  out.touches_itself = fields.flag("touches_itself", true);
  out.straight = fields.flag("straight", false);
  fields.end();
  return out;
}

}  // namespace

std::string clip_name(const RoutedCable& cable, int number) {
  return cable.name + " clip " + std::to_string(number);
}

std::vector<RoutedCable> cables_in(const std::string& text, const std::string& file,
                                   const std::vector<std::string>& taken) {
  try {
    const Json json = parse_json(text);
    std::vector<RoutedCable> out;
    if (json.is_array()) {
      for (std::size_t i = 0; i < json.size(); ++i)
        out.push_back(cable_in(json[i], item("", i), "cable " + std::to_string(i + 1)));
    } else {
      out.push_back(cable_in(json, "", "cable"));
    }
    if (out.empty()) throw std::runtime_error("must have at least one cable");
    std::set<std::string> names(taken.begin(), taken.end());
    for (const RoutedCable& cable : out) {
      const auto clips = std::ranges::count_if(cable.via, &CableStop::is_clip);
      std::vector<std::string> own{cable.name};
      for (int k = 1; k <= clips; ++k) own.push_back(clip_name(cable, k));
      for (const std::string& name : own)
        if (!names.insert(name).second)
          throw std::runtime_error("two bodies are named " + aussois::quoted(name) +
                                   ": give each cable a name of its own");
    }
    return out;
  } catch (const std::exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

}  // namespace aussois
