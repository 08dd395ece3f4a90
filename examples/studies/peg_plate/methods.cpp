// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/peg_plate/methods.hpp"

#include <memory>

#include "examples/studies/peg_plate/labels.hpp"
#include "reduction/learned_selector.hpp"
#include "reduction/mean_contacts.hpp"
#include "reduction/reduce.hpp"

namespace aussois {
namespace {

// The 17 places as contact determination would hand them over: body 0 is the peg, 1 the plate.
ContactSet as_contact_set(const PegSample& sample, const std::vector<PegContact>& contacts) {
  ContactSet set;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 at = sample.g.p + contacts[i].arm;
    ContactPoint point{.a = {.body = 0, .simplex = int(i), .region = int(i)},
                       .b = {.body = 1, .dim = 2},
                       .x_a = at,
                       .x_b = Vec3(at.x(), at.y(), 0),
                       .normal = contacts[i].normal,
                       .gap = at.z()};
    set.points.push_back(point);
  }
  return set;
}

// A reducer of the kernel on the 17 places; load_carrier learns what each carries from one full solve.
NamedMethod reducer_method(Reducer reducer, const SolverView& view) {
  const ReductionOptions options{.reducer = reducer, .layer = 0};
  return {to_string(reducer), [=] {
            return [=](const PegSample& sample, bool) {
              const std::vector<PegContact> all = peg_contacts(PegScenario::surface, sample);
              const ContactSet set = as_contact_set(sample, all);
              ReductionInput input{.contacts = set};
              if (options.reducer == Reducer::load_carrier) {
                input.h = view.step;
                for (const Vec3& force : contact_forces(view, sample, all))
                  input.impulse.push_back(view.step * force);
              }
              return picked(all, reduce(input, options).kept);
            };
          }};
}

// Means of positions: KMC starts from other random contacts every time, KMCW from its last centres [Kim2019].
NamedMethod mean_method(bool warm, std::uint64_t seed) {
  return {warm ? "kmcw" : "kmc", [=] {
            const auto next = std::make_shared<std::uint64_t>(seed);
            const auto centres = std::make_shared<MatX>();
            return [=](const PegSample& sample, bool first) {
              MeanContactOptions options{.seeding = SeedRandom{(*next)++}};
              if (warm && !first) {  // the last centres, carried along with the body
                MatX moved = *centres;
                for (Eigen::Index k = 0; k < moved.cols(); ++k) moved.col(k) = sample.g * Vec3(moved.col(k));
                options.seeding = SeedWarm{moved};
              }
              const MeanContacts means = mean_contacts(
                  as_contact_set(sample, peg_contacts(PegScenario::surface, sample)), {}, {}, options);
              *centres = means.centres;
              for (Eigen::Index k = 0; k < centres->cols(); ++k)
                centres->col(k) = inverse(sample.g) * Vec3(centres->col(k));
              std::vector<PegContact> out;
              for (Eigen::Index k = 0; k < means.centres.cols(); ++k)
                out.push_back({.arm = Vec3(means.centres.col(k)) - sample.g.p});
              return out;
            };
          }};
}

}  // namespace

std::vector<NamedMethod> untrained_methods(PegScenario scenario, const SolverView& view, std::uint64_t seed) {
  if (scenario == PegScenario::edge) return {fixed_method("upright", scenario, {kUprightNormal})};
  std::vector<int> all(face_places().size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = int(i);
  return {fixed_method("full", scenario, all),
          reducer_method(Reducer::hull_exact, view),
          reducer_method(Reducer::hull_margin, view),
          reducer_method(Reducer::extreme_points, view),
          reducer_method(Reducer::load_carrier, view),
          mean_method(false, seed),
          mean_method(true, seed)};
}

NamedMethod fixed_method(const std::string& name, PegScenario scenario, std::vector<int> outputs) {
  return {name, [scenario, outputs = std::move(outputs)] {
            return [=](const PegSample& sample, bool) {
              return picked(peg_contacts(scenario, sample), outputs);
            };
          }};
}

std::vector<int> learned_outputs(PegScenario scenario, const Network& network, const PegSample& sample) {
  const VecX probability = network_output(network, input_of(load_of(sample)));
  if (scenario == PegScenario::surface) return chosen_places(probability, face_places());
  Eigen::Index best = 0;
  probability.maxCoeff(&best);
  return {int(best)};
}

NamedMethod learned_method(const std::string& name, PegScenario scenario, Network network) {
  return {name, [scenario, network = std::move(network)] {
            return [=](const PegSample& sample, bool) {
              return picked(peg_contacts(scenario, sample), learned_outputs(scenario, network, sample));
            };
          }};
}

NamedMethod oracle_method(PegScenario scenario, const SolverView& view) {
  const auto make = [=] {
    return [=, choices = peg_choices(scenario)](const PegSample& sample, bool) {
      Eigen::Index best = 0;
      choice_errors(view, scenario, {sample}).col(0).minCoeff(&best);
      return picked(peg_contacts(scenario, sample), choices[best]);
    };
  };
  return {"oracle", make, true};
}

}  // namespace aussois
