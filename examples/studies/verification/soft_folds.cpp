// SPDX-License-Identifier: Apache-2.0
// All that touches itself: row S1 of group S (doc/theory/deforming_shapes.md).
#include "examples/scenes/cables.hpp"
#include "examples/studies/verification/running.hpp"
#include "integrators/prove/path_audit.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

struct Folding {
  std::string name{};
  std::function<CaseScene()> scene{};
  double h = 1e-3, until = 1;  // [s]
};

VerificationCase folds(const Folding& folding) {
  return {.name = "S1.touches_itself",
          .setting = folding.name,
          .what = "steps of up to fifteen iterations, each audited by samples of its path",
          .rows = {{"violations", "steps that the samples refute", "-", 0,
                    "certificate (CA-9): base complexes never cross, of one body neither", Sense::exactly},
                   {"contacts", "contacts with itself that bear, at most", "-", 3, "it folds onto itself",
                    Sense::at_least}},
          .measure =
              [=] {
                const CaseScene s = folding.scene();
                const MoreauJean scheme(s.model, {.h = folding.h},
                                        {.theta = 1, .newton = {.max_iterations = 15, .tolerance = 1e-6}});
                State state = s.state, before = state;
                PathAudit audit{.samples = 3};
                Worst contacts;
                run_accepted(scheme, state, folding.until, [&](const StepReport& report) {
                  audit_path(s.model, before, state, report, 1, audit);
                  before = state;
                  int with_itself = 0;
                  for (const StepContact& c : report.contacts)
                    with_itself += c.point.a.body == c.point.b.body && c.impulse.norm() > 0;
                  contacts.add(with_itself);
                  return true;
                });
                return Figures{{"violations", double(audit.violations)}, {"contacts", contacts}};
              },
          .slow = true,
          .certified = true};
}

}  // namespace

std::vector<VerificationCase> soft_fold_verification() {
  std::vector<VerificationCase> out;
  for (const Folding& folding : {Folding{"a rope lies down in coils", rope_coil, 2e-3, 0.7},
                                 {"a knot is drawn tight", knot, 4e-3, 0.8}})
    out.push_back(folds(folding));
  return out;
}

}  // namespace aussois
