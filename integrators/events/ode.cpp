// SPDX-License-Identifier: Apache-2.0
#include "integrators/events/ode.hpp"

#include <cmath>
#include <exception>
#include <stdexcept>
#include <vector>

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "geometry/check.hpp"

namespace aussois {

// What CVODE calls with: exceptions of the problem wait until C is left.
struct OdeCall {
  const OdeProblem& problem;
  std::exception_ptr thrown{};
};

namespace {

VecX values(N_Vector y) {
  return Eigen::Map<const VecX, Eigen::Unaligned>(N_VGetArrayPointer(y), N_VGetLength(y));
}
void store(const VecX& values, double* out) {
  for (Eigen::Index i = 0; i < values.size(); ++i) out[i] = values[i];
}

constexpr double kUnjudged = 1e20;  // tolerance of what is not looked at
constexpr int kTryShorter = 1;      // CVODE's word for a function that has no value here

template <class F>
int call(void* called, Eigen::Index size, double* out, const F& f) {
  constexpr int kStop = -1;
  auto& c = *static_cast<OdeCall*>(called);
  try {
    VecX value(size);
    if (!f(c.problem, value) || !value.allFinite()) return kTryShorter;
    store(value, out);
    return 0;
  } catch (...) {
    c.thrown = std::current_exception();
    return kStop;
  }
}

int rate(double t, N_Vector y, N_Vector out, void* called) {
  return call(called, N_VGetLength(y), N_VGetArrayPointer(out),
              [&](const OdeProblem& p, VecX& value) { return p.rate(t, values(y), value); });
}

int roots(double t, N_Vector y, double* out, void* called) {
  return call(called, static_cast<OdeCall*>(called)->problem.root_count, out,
              [&](const OdeProblem& p, VecX& value) { return p.roots(t, values(y), value); });
}

void require_ok(bool ok) {
  if (!ok) throw std::runtime_error("CVODE could not be set up");
}

}  // namespace

struct OdePiece::Memory {
  OdeCall called;
  explicit Memory(const OdeProblem& problem) : called{problem} {}
  SUNContext context = nullptr;
  void* cvode = nullptr;
  N_Vector y = nullptr, dense = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver linear = nullptr;
  SUNNonlinearSolver fixed_point = nullptr;
  double t = 0, t_stop = -kInf;
  VecX now{};
  std::string reason{};

  ~Memory() {
    if (cvode) CVodeFree(&cvode);
    if (linear) SUNLinSolFree(linear);
    if (fixed_point) SUNNonlinSolFree(fixed_point);
    if (matrix) SUNMatDestroy(matrix);
    for (const N_Vector v : {y, dense})
      if (v) N_VDestroy(v);
    if (context) SUNContext_Free(&context);
  }
};

OdePiece::OdePiece(const OdeProblem& problem, const OdeOptions& o, double t, const VecX& y)
    : memory_(std::make_unique<Memory>(problem)) {
  Memory& m = *memory_;
  m.t = t, m.now = y;
  const auto n = sunindextype(y.size());
  require_ok(SUNContext_Create(nullptr, &m.context) == 0);
  m.y = N_VNew_Serial(n, m.context);
  m.dense = N_VNew_Serial(n, m.context);
  m.cvode = CVodeCreate(o.method == OdeMethod::adams ? CV_ADAMS : CV_BDF, m.context);
  require_ok(m.y && m.dense && m.cvode);
  store(y, N_VGetArrayPointer(m.y));
  require_ok(CVodeInit(m.cvode, rate, t, m.y) == CV_SUCCESS);
  require_ok(CVodeSetErrHandlerFn(
                 m.cvode, [](int, const char*, const char*, char*, void*) {}, nullptr) == CV_SUCCESS);
  require_ok(CVodeSetUserData(m.cvode, &m.called) == CV_SUCCESS);
  // CVODE's norm is a mean over all entries: sums would loosen it
  const double share = std::sqrt(1 - double(problem.sums) / double(n));
  VecX absolute = VecX::Constant(y.size(), share * o.absolute);
  absolute.tail(problem.unjudged + problem.sums).setConstant(kUnjudged);
  store(absolute, N_VGetArrayPointer(m.dense));
  require_ok(CVodeSVtolerances(m.cvode, share * o.relative, m.dense) == CV_SUCCESS);  // which copies them
  if (o.largest_step < kInf) require_ok(CVodeSetMaxStep(m.cvode, o.largest_step) == CV_SUCCESS);
  if (o.method == OdeMethod::adams) {
    m.fixed_point = SUNNonlinSol_FixedPoint(m.y, 0, m.context);
    require_ok(m.fixed_point && CVodeSetNonlinearSolver(m.cvode, m.fixed_point) == CV_SUCCESS);
  } else {
    m.matrix = SUNDenseMatrix(n, n, m.context);
    m.linear = SUNLinSol_Dense(m.y, m.matrix, m.context);
    require_ok(m.matrix && m.linear && CVodeSetLinearSolver(m.cvode, m.linear, m.matrix) == CV_SUCCESS);
  }
  if (problem.root_count > 0) {
    std::vector<int> falling(std::size_t(problem.root_count), -1);
    require_ok(CVodeRootInit(m.cvode, problem.root_count, roots) == CV_SUCCESS);
    require_ok(CVodeSetRootDirection(m.cvode, falling.data()) == CV_SUCCESS);
    require_ok(CVodeSetNoInactiveRootWarn(m.cvode) == CV_SUCCESS);
  }
}

OdePiece::~OdePiece() = default;

OdeStop OdePiece::advance(double t_end) {
  Memory& m = *memory_;
  const auto failed = [&](const std::string& reason) {
    m.reason = reason;
    return OdeStop::failed;
  };
  if (m.t_stop != t_end) CVodeSetStopTime(m.cvode, m.t_stop = t_end);
  const int flag = CVode(m.cvode, t_end, m.y, &m.t, CV_ONE_STEP);
  if (m.called.thrown) std::rethrow_exception(m.called.thrown);
  m.now = values(m.y);
  switch (flag) {
    case CV_SUCCESS:
      return OdeStop::stepped;
    case CV_TSTOP_RETURN:
      return OdeStop::at_end;
    case CV_ROOT_RETURN:
      return OdeStop::at_root;
    default: {
      char* name = CVodeGetReturnFlagName(flag);
      const std::string text = std::string("CVODE ends with ") + name;
      free(name);
      return failed(text);
    }
  }
}

double OdePiece::time() const {
  return memory_->t;
}
const VecX& OdePiece::state() const {
  return memory_->now;
}
const std::string& OdePiece::reason() const {
  return memory_->reason;
}

VecX OdePiece::at(double t) const {
  return CVodeGetDky(memory_->cvode, t, 0, memory_->dense) == CV_SUCCESS ? values(memory_->dense)
                                                                         : memory_->now;
}

}  // namespace aussois
