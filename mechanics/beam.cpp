// SPDX-License-Identifier: Apache-2.0
#include "mechanics/beam.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "geometry/check.hpp"
#include "geometry/settings.hpp"
#include "mechanics/layout.hpp"
#include "mechanics/model.hpp"
#include "mechanics/state.hpp"

namespace aussois {
namespace {

const std::string kTooFar = "be below " + number_text(kLargestBeamTurn) + " rad: use more elements";

const BeamSection& section_of(const Beam& beam, const BeamElement& element) {
  return beam.sections[std::size_t(element.section)];
}

BeamEnds ends_of(const BeamElement& element, const State& state) {
  return {.g_a = pose(state, element.body_a),
          .g_b = pose(state, element.body_b),
          .v_a = twist(state, element.body_a),
          .v_b = twist(state, element.body_b),
          .frame_a = element.frame_a,
          .frame_b = element.frame_b};
}

BeamForces forces_of(const Beam& beam, const BeamElement& element, const State& state,
                     BeamTangent* tangent = nullptr) {
  const BeamSection& section = section_of(beam, element);
  return beam_forces(ends_of(element, state), section.stiffness, section.damping, element.length,
                     element.rest, tangent);
}

// A beam and where the blocks of its elements are in the derivatives of its force.
struct LaidBeam {
  Beam beam{};
  std::shared_ptr<const BlockPattern> pattern{};
  struct Place {
    std::array<int, 2> column{};             // of its nodes
    std::array<std::array<int, 2>, 2> at{};  // of the blocks between node i and node j
  };
  std::vector<Place> places{};  // of each element
  bool damped = false;
};

LaidBeam laid(Beam beam) {
  LaidBeam out{.beam = std::move(beam)};
  std::vector<int> entry;  // of the nodes
  for (const BeamElement& e : out.beam.elements)
    for (const BodyId node : {e.body_a, e.body_b}) entry.push_back(first_velocity(node));
  std::ranges::sort(entry);
  entry.erase(std::unique(entry.begin(), entry.end()), entry.end());
  std::vector<std::vector<int>> elements;
  for (const BeamElement& e : out.beam.elements) {
    LaidBeam::Place& place = out.places.emplace_back();
    for (const auto& [i, node] : {std::pair(0, e.body_a), std::pair(1, e.body_b)})
      place.column[i] = int(std::ranges::lower_bound(entry, first_velocity(node)) - entry.begin());
    elements.emplace_back(place.column.begin(), place.column.end());
    out.damped = out.damped || !section_of(out.beam, e).damping.isZero(0);
  }
  out.pattern = block_pattern(6, std::move(entry), elements);
  for (LaidBeam::Place& place : out.places)
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) place.at[i][j] = block_at(*out.pattern, place.column[i], place.column[j]);
  return out;
}

void add_blocks(const LaidBeam& laid, std::size_t element, const Eigen::Matrix<double, 12, 12>& block,
                std::vector<double>& values) {
  const LaidBeam::Place& place = laid.places[element];
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i)
      add_to_block<6>(*laid.pattern, place.at[i][j], place.column[j], block.block<6, 6>(6 * i, 6 * j),
                      values);
}

void add_forces(const LaidBeam& laid, const State& state, GeneralisedForce& force) {
  ForceMatrix& matrix = force.matrices.emplace_back(ForceMatrix{.pattern = laid.pattern});
  matrix.K.assign(laid.pattern->values(), 0);
  if (laid.damped) matrix.C.assign(laid.pattern->values(), 0);
  for (std::size_t i = 0; i < laid.beam.elements.size(); ++i) {
    const BeamElement& element = laid.beam.elements[i];
    BeamTangent tangent;
    const BeamForces of = forces_of(laid.beam, element, state, &tangent);
    body_part(force.f, element.body_a) += of.on_a;
    body_part(force.f, element.body_b) += of.on_b;
    add_blocks(laid, i, tangent.K, matrix.K);
    if (laid.damped) add_blocks(laid, i, tangent.C, matrix.C);
  }
}

void check_each(const Vec6& values, bool may_vanish, const std::string& field, const char* bound) {
  for (const double x : values)
    require_field(std::isfinite(x) && (may_vanish ? x >= 0 : x > 0), field.c_str(), x, bound);
}

void check_section(const BeamSection& section, const std::string& who) {
  check_each(section.stiffness, false, who + "stiffness",
             "be positive and finite; a string that does not resist its twist needs a small number");
  check_each(section.damping, true, who + "damping", "be finite and not negative");
  require_field(section.mass_per_length > 0 && std::isfinite(section.mass_per_length),
                (who + "mass_per_length").c_str(), section.mass_per_length, "be positive and finite [kg/m]");
  for (const double x : section.inertia_per_length)
    require_field(x > 0 && std::isfinite(x), (who + "inertia_per_length").c_str(), x,
                  "be positive and finite [kg m]");
  const Vec3& inertia = section.inertia_per_length;
  const double largest = inertia.maxCoeff(), others = inertia.sum() - largest;
  require_field(largest <= others * (1 + 1e-9), (who + "largest inertia_per_length").c_str(), largest,
                ("not exceed the sum of the others, " + number_text(others)).c_str());  // (MEC-3)
}

void check_element(const BeamElement& element, const Beam& beam, const Table<BodyId, RigidBody>& all,
                   const std::string& who) {
  const std::string bodies = "be one of the " + std::to_string(all.size()) + " bodies";
  require_field(all.contains(element.body_a), (who + "body_a").c_str(), element.body_a, bodies.c_str());
  require_field(all.contains(element.body_b), (who + "body_b").c_str(), element.body_b, bodies.c_str());
  require_field(element.body_a != element.body_b, (who + "body_b").c_str(), element.body_b,
                "differ from body_a");
  require(has_inertia(all[element.body_a]) || has_inertia(all[element.body_b]),
          who + "one of its nodes must be dynamic or carried");
  require_field(element.section >= 0 && element.section < std::ssize(beam.sections),
                (who + "section").c_str(), element.section,
                ("lie in [0, " + std::to_string(beam.sections.size()) + ")").c_str());
  require_field(element.length > 0 && std::isfinite(element.length), (who + "length").c_str(), element.length,
                "be positive and finite [m]");
  checked_pose(element.frame_a, (who + "frame_a").c_str());
  checked_pose(element.frame_b, (who + "frame_b").c_str());
  require(element.rest.allFinite(), who + "rest must be finite");
  const double turn = element.rest.tail<3>().norm();
  require_field(turn < kLargestBeamTurn, (who + "turn of rest").c_str(), turn, kTooFar.c_str());
}

}  // namespace

void describe(SettingVisitor& visit, RoundSection& o) {
  visit.begin("RoundSection");
  visit.number({"radius", "radius", "m", positive_range()}, o.radius);
  visit.number({"young", "Young's modulus", "Pa", positive_range()}, o.young);
  visit.number({"poisson", "Poisson's ratio", "-", open_range(-1, 0.5)}, o.poisson);
  visit.number({"density", "density", "kg/m^3", positive_range()}, o.density);
  visit.number({"bending_stiffness", "bending stiffness of a rope; 0: that of the circle", "N m^2",
                not_negative_range()},
               o.bending_stiffness);
  visit.number({"damping_time", "damping over stiffness", "s", not_negative_range()}, o.damping_time);
}

BeamSection beam_section(const RoundSection& round) {
  check_ranges(round);
  const double r = round.radius, nu = round.poisson, area = kPi * r * r, inertia = area * r * r / 4;
  const double shear = round.young / (2 * (1 + nu)), k = 6 * (1 + nu) / (7 + 6 * nu);
  const double bending = round.bending_stiffness > 0 ? round.bending_stiffness : round.young * inertia;
  BeamSection out;
  out.stiffness << round.young * area, k * shear * area, k * shear * area, 2 * shear * inertia, bending,
      bending;
  out.damping = round.damping_time * out.stiffness;
  out.mass_per_length = round.density * area;
  out.inertia_per_length = round.density * inertia * Vec3(2, 1, 1);
  return out;
}

Vec6 straight_rest(double length) {
  return length * Vec6::Unit(0);
}

void validate(const Beam& beam, const Table<BodyId, RigidBody>& bodies) {
  const std::string who = "beam (" + beam.name + "): ";
  for (std::size_t i = 0; i < beam.sections.size(); ++i)
    check_section(beam.sections[i], who + "section " + std::to_string(i) + ": ");
  for (std::size_t i = 0; i < beam.elements.size(); ++i)
    check_element(beam.elements[i], beam, bodies, who + "element " + std::to_string(i) + ": ");
}

void add(Model& model, Beam beam) {
  validate(beam, model.bodies);
  const auto kept = std::make_shared<const LaidBeam>(laid(std::move(beam)));
  add(model, ForceLaw{.name = kept->beam.name,
                      .add_to = [kept](const Model&, const State& state, double,
                                       GeneralisedForce& force) { add_forces(*kept, state, force); },
                      .refusal = [kept](const Model&,
                                        const State& state) { return beam_refusal(kept->beam, state); },
                      .potential = [kept](const Model&, const State& state,
                                          double) { return beam_energy(kept->beam, state); },
                      .passive = true,
                      .internal = true});
}

std::vector<BeamLoad> beam_loads(const Beam& beam, const State& state) {
  std::vector<BeamLoad> out;
  for (const BeamElement& element : beam.elements) {
    const BeamForces of = forces_of(beam, element, state);
    out.push_back({of.strain, of.stress});
  }
  return out;
}

double beam_energy(const Beam& beam, const State& state) {
  double sum = 0;
  for (const BeamElement& element : beam.elements) sum += forces_of(beam, element, state).energy;
  return sum;
}

std::string beam_refusal(const Beam& beam, const State& state) {
  for (std::size_t i = 0; i < beam.elements.size(); ++i) {
    const BeamElement& e = beam.elements[i];
    const Quat turn =
        (pose(state, e.body_a).R * e.frame_a.R).conjugate() * pose(state, e.body_b).R * e.frame_b.R;
    const double angle = log_so3(turn).norm();
    if (!(angle > kLargestBeamTurn)) continue;
    return "element " + std::to_string(i) + " turns by " + number_text(angle) + " rad, more than " +
           number_text(kLargestBeamTurn) + ": use more elements";
  }
  return "";
}

PerBody<NodeMass> node_masses(const Beam& beam, std::size_t body_count) {
  PerBody<NodeMass> out(body_count);
  for (const BeamElement& element : beam.elements) {
    const BeamSection& section = section_of(beam, element);
    const Vec3 inertia = element.length / 2 * section.inertia_per_length;
    for (const auto& [body, frame] :
         {std::pair(element.body_a, element.frame_a), std::pair(element.body_b, element.frame_b)}) {
      const Mat3 R = frame.R.toRotationMatrix();
      out[body].mass += element.length / 2 * section.mass_per_length;
      out[body].inertia += R * inertia.asDiagonal() * R.transpose();
    }
  }
  return out;
}

}  // namespace aussois
