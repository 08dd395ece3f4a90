// SPDX-License-Identifier: Apache-2.0
#include "bench/peer_siconos.hpp"

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <NumericsVerbose.h>
#include <RollingFrictionContactProblem.h>
#include <SolverOptions.h>
#include <SparseBlockMatrix.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <map>
#include <memory>
#include <unistd.h>

#include <sys/time.h>
#include <sys/wait.h>

#include "bench/call_time.hpp"
#include "nsgs/residual.hpp"

// OpenBLAS, if that is the BLAS below Siconos: one thread, as for all other solvers here.
extern "C" __attribute__((weak)) void openblas_set_num_threads(int);

namespace aussois {
namespace {

// What differs from Siconos' defaults.
struct SiconosSolver {
  const char* name;
  int dimension;  // rows of a block
  int id;
  int inner = 0;        // solver of one contact; 0: the default
  int evaluation = -1;  // how NSGS evaluates its error
  double omega = 0;     // relaxation of NSGS; 0: none
  bool dense = false;   // it does not take blocks
};
constexpr int kLight = SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_LIGHT,
              kFull = SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_FULL;
constexpr std::array kSolvers{
    SiconosSolver{"nsgs", 3, SICONOS_FRICTION_3D_NSGS},
    SiconosSolver{"prox_nsn", 3, SICONOS_FRICTION_3D_PROX},
    SiconosSolver{"nsgs_quartic", 3, SICONOS_FRICTION_3D_NSGS, SICONOS_FRICTION_3D_ONECONTACT_QUARTIC},
    SiconosSolver{"nsgs_nsn", 3, SICONOS_FRICTION_3D_NSGS, SICONOS_FRICTION_3D_ONECONTACT_NSN},
    SiconosSolver{"nsgs_nsn_gp", 3, SICONOS_FRICTION_3D_NSGS, SICONOS_FRICTION_3D_ONECONTACT_NSN_GP},
    SiconosSolver{"nsgs_light", 3, SICONOS_FRICTION_3D_NSGS, 0, kLight},
    SiconosSolver{"nsgs_full", 3, SICONOS_FRICTION_3D_NSGS, 0, kFull},
    SiconosSolver{"nsgs_sor1.2", 3, SICONOS_FRICTION_3D_NSGS, 0, -1, 1.2},
    SiconosSolver{"nsgs_sor1.4", 3, SICONOS_FRICTION_3D_NSGS, 0, -1, 1.4},
    SiconosSolver{"nsgs_proj1", 3, SICONOS_FRICTION_3D_NSGS, SICONOS_FRICTION_3D_ONECONTACT_ProjectionOnCone},
    SiconosSolver{"nsgs_projlocal", 3, SICONOS_FRICTION_3D_NSGS,
                  SICONOS_FRICTION_3D_ONECONTACT_ProjectionOnConeWithLocalIteration},
    SiconosSolver{"nsn_ac", 3, SICONOS_FRICTION_3D_NSN_AC},
    SiconosSolver{"nsn_fb", 3, SICONOS_FRICTION_3D_NSN_FB},
    SiconosSolver{"admm", 3, SICONOS_FRICTION_3D_ADMM},
    SiconosSolver{"dsfp", 3, SICONOS_FRICTION_3D_DSFP},
    SiconosSolver{"vi_eg", 3, SICONOS_FRICTION_3D_VI_EG},
    SiconosSolver{"fc2d_nsgs", 2, SICONOS_FRICTION_2D_NSGS},
    SiconosSolver{"fc2d_cpg", 2, SICONOS_FRICTION_2D_CPG, 0, -1, 0, true},
    SiconosSolver{"fc2d_lemke", 2, SICONOS_FRICTION_2D_LEMKE, 0, -1, 0, true},
    SiconosSolver{"rolling_nsgs", 5, SICONOS_ROLLING_FRICTION_3D_NSGS, 0, -1, 0, true},
    SiconosSolver{"rolling_nsgs_proj1", 5, SICONOS_ROLLING_FRICTION_3D_NSGS,
                  SICONOS_ROLLING_FRICTION_3D_ONECONTACT_ProjectionOnCone, -1, 0, true},
    SiconosSolver{"rolling_admm", 5, SICONOS_ROLLING_FRICTION_3D_ADMM},
};
constexpr int kMostDenseRows = 2000;

struct FreeOptions {
  void operator()(SolverOptions* options) const { solver_options_delete(options), std::free(options); }
};
using OptionsPtr = std::unique_ptr<SolverOptions, FreeOptions>;

OptionsPtr make_options(const SiconosSolver& solver, double tolerance) {
  OptionsPtr options(solver_options_create(solver.id));
  options->dparam[SICONOS_DPARAM_TOL] = tolerance;
  options->iparam[SICONOS_IPARAM_MAX_ITER] = std::max(options->iparam[SICONOS_IPARAM_MAX_ITER], 10'000'000);
  if (solver.inner != 0) solver_options_update_internal(options.get(), 0, solver.inner);
  if (solver.evaluation >= 0)
    options->iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] = solver.evaluation;
  if (solver.omega > 0) {
    options->iparam[SICONOS_FRICTION_3D_NSGS_RELAXATION] = SICONOS_FRICTION_3D_NSGS_RELAXATION_TRUE;
    options->dparam[SICONOS_FRICTION_3D_NSGS_RELAXATION_VALUE] = solver.omega;
  }
  return options;
}

// W as rows of square blocks, those of the diagonal always there.
struct BlockRows {
  std::vector<std::size_t> begin{}, column{};
  std::vector<unsigned> end_row{};  // of each block row: rows up to its end
  std::vector<double> value{};      // block after block, each by columns
};

BlockRows block_rows(const SparseMatrix& W, int dimension) {
  const auto d = Eigen::Index(dimension), count = W.rows() / d;
  std::map<std::pair<Eigen::Index, Eigen::Index>, std::vector<double>> blocks;
  for (Eigen::Index c = 0; c < count; ++c) blocks[{c, c}].assign(std::size_t(d * d), 0);
  for (Eigen::Index j = 0; j < W.cols(); ++j)
    for (SparseMatrix::InnerIterator it(W, j); it; ++it) {
      std::vector<double>& block = blocks[{it.row() / d, j / d}];
      block.resize(d * d);
      block[j % d * d + it.row() % d] = it.value();
    }
  BlockRows out;
  out.begin.assign(std::size_t(count) + 1, 0);
  for (const auto& [place, block] : blocks) {
    ++out.begin[std::size_t(place.first) + 1];
    out.column.push_back(place.second);
    out.value.insert(out.value.end(), block.begin(), block.end());
  }
  for (std::size_t c = 0; c < std::size_t(count); ++c) {
    out.begin[c + 1] += out.begin[c];
    out.end_row.push_back(unsigned(dimension) * unsigned(c + 1));
  }
  return out;
}

// One problem for one call: Siconos may change matrices and options as it likes.
class Call {
 public:
  Call(const LocalProblem& problem, const BlockRows& W, const SiconosSolver& solver, double tolerance)
      : solver_(solver),
        blocks_(W),
        q_(problem.q),
        r_(VecX::Zero(q_.size())),
        u_(VecX::Zero(q_.size())),
        options_(make_options(solver, tolerance)) {
    for (const Law& law : problem.laws) mu_.push_back(law.mu), mu_r_.push_back(law.mu_r);
    const int n = int(q_.size());
    if (solver.dense) {
      dense_ = problem.W;
      M_ = NM_create_from_data(NM_DENSE, n, n, dense_.data());
      return;
    }
    const auto size = std::size_t(solver.dimension * solver.dimension);
    for (std::size_t k = 0; k < blocks_.column.size(); ++k) block_.push_back(&blocks_.value[k * size]);
    SBM_null(&rows_);
    rows_.nbblocks = unsigned(block_.size());
    rows_.block = block_.data();
    rows_.blocknumber0 = rows_.blocknumber1 = unsigned(mu_.size());
    rows_.blocksize0 = rows_.blocksize1 = blocks_.end_row.data();
    rows_.filled1 = blocks_.begin.size();
    rows_.filled2 = blocks_.column.size();
    rows_.index1_data = blocks_.begin.data();
    rows_.index2_data = blocks_.column.data();
    M_ = NM_new_SBM(n, n, &rows_);
    SBM_diagonal_block_indices(&rows_);
  }
  ~Call() {
    M_->matrix0 = nullptr, M_->matrix1 = nullptr;  // ours
    NM_clear(M_);
    std::free(M_);
    std::free(rows_.diagonal_blocks);
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  int operator()() {
    const int count = int(mu_.size());
    if (solver_.dimension == 5) {
      RollingFrictionContactProblem problem{5, count, M_, q_.data(), mu_.data(), mu_r_.data()};
      return rolling_fc3d_driver(&problem, r_.data(), u_.data(), options_.get());
    }
    FrictionContactProblem problem{solver_.dimension, count, M_, q_.data(), mu_.data()};
    return (solver_.dimension == 2 ? fc2d_driver : fc3d_driver)(&problem, r_.data(), u_.data(),
                                                                options_.get());
  }
  const VecX& r() const { return r_; }
  int iterations() const { return options_->iparam[SICONOS_IPARAM_ITER_DONE]; }

 private:
  SiconosSolver solver_;
  BlockRows blocks_;
  MatX dense_{};
  VecX q_, r_, u_;
  std::vector<double> mu_{}, mu_r_{};
  std::vector<double*> block_{};
  SparseBlockStructuredMatrix rows_{};
  NumericsMatrix* M_ = nullptr;
  OptionsPtr options_;
};

// Ends this process after so much CPU time; 0: never.
void set_alarm(double seconds) {
  itimerval timer{};
  timer.it_value.tv_sec = time_t(seconds);
  timer.it_value.tv_usec = suseconds_t(1e6 * (seconds - double(timer.it_value.tv_sec)));
  setitimer(ITIMER_PROF, &timer, nullptr);
}

// What a child sends through a pipe.
struct Message {
  int solved = 0, iterations = 0;
  double cpu_s = 0, residual = 0, own_tolerance = 0;
};

Message solve_in_child(const LocalProblem& problem, const SiconosSolver& solver, double tolerance,
                       double time_limit, double budget) {
  const BlockRows W = solver.dense ? BlockRows{} : block_rows(problem.W, solver.dimension);
  const auto calls = [&](double own_tolerance, int n) {
    std::vector<std::unique_ptr<Call>> out;
    for (int i = 0; i < n; ++i) out.push_back(std::make_unique<Call>(problem, W, solver, own_tolerance));
    return out;
  };
  Message out{.residual = kInf};
  for (double own = std::min(100 * tolerance, 0.1); own >= 1e-30; own /= std::sqrt(10)) {
    const std::unique_ptr<Call> call = std::move(calls(own, 1).front());
    set_alarm(time_limit);
    const double begin = cpu_seconds();
    const int info = (*call)();
    const double took = cpu_seconds() - begin;
    set_alarm(0);
    const double residual = scaled_residual(problem, call->r());
    if (residual < out.residual) out.residual = residual;
    if (residual <= tolerance)
      return {.solved = 1,
              .iterations = call->iterations(),
              .cpu_s = fastest_call(
                  took, budget, [&](int n) { return calls(own, n); },
                  [](const std::unique_ptr<Call>& again) { (*again)(); }),
              .residual = residual,
              .own_tolerance = own};
    if (info != 0) break;  // it misses its own tolerance: a smaller one does not help
  }
  return out;
}

[[noreturn]] void be_child(int pipe, const LocalProblem& problem, const SiconosSolver& solver,
                           double tolerance, double time_limit, double budget) {
  signal(SIGINT, SIG_IGN);  // the parent ends the run, after this child
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  numerics_set_verbose(0);
  if (openblas_set_num_threads) openblas_set_num_threads(1);
  alarm(unsigned(20 * time_limit) + 60);  // waiting for nothing takes no CPU time
  int code = EXIT_FAILURE;
  try {
    const Message message = solve_in_child(problem, solver, tolerance, time_limit, budget);
    if (write(pipe, &message, sizeof message) == ssize_t(sizeof message)) code = EXIT_SUCCESS;
  } catch (...) {  // no memory: the parent finds a failed child
  }
  _exit(code);
}

// `call` again as long as a signal interrupts it.
template <class SystemCall>
auto uninterrupted(const SystemCall& call) {
  for (;;)
    if (const auto result = call(); result >= 0 || errno != EINTR) return result;
}

std::string failure_of(int status) {
  if (WIFSIGNALED(status))
    return WTERMSIG(status) == SIGPROF ? "time" : "signal " + std::to_string(WTERMSIG(status));
  return WEXITSTATUS(status) == EXIT_SUCCESS ? "residual" : "exit " + std::to_string(WEXITSTATUS(status));
}

// Of all blocks; 0 for laws that Siconos does not have.
int dimension_of(const std::vector<Law>& laws) {
  if (laws.empty()) return 0;
  const Law& first = laws.front();
  const bool known = first.kind == LawKind::coulomb || first.kind == LawKind::rolling;
  const bool uniform = std::ranges::all_of(
      laws, [&](const Law& law) { return law.kind == first.kind && law.rows == first.rows; });
  return known && uniform ? first.rows : 0;
}

}  // namespace

std::vector<std::string> siconos_solvers(const LocalProblem& problem) {
  std::vector<std::string> names;
  for (const SiconosSolver& solver : kSolvers)
    if (solver.dimension == dimension_of(problem.laws) &&
        !(solver.dense && problem.q.size() > kMostDenseRows))
      names.emplace_back(solver.name);
  return names;
}

SiconosRun run_siconos(const LocalProblem& problem, const std::string& name, double tolerance,
                       double time_limit, double budget) {
  const auto solver =
      std::ranges::find_if(kSolvers, [&](const SiconosSolver& known) { return known.name == name; });
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe to a peer's process");
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process for a peer");
  if (child == 0) {
    close(ends[0]);
    be_child(ends[1], problem, *solver, tolerance, time_limit, budget);
  }
  close(ends[1]);
  Message message;
  const bool told =
      uninterrupted([&] { return read(ends[0], &message, sizeof message); }) == ssize_t(sizeof message);
  close(ends[0]);
  int status = 0;
  uninterrupted([&] { return waitpid(child, &status, 0); });
  SiconosRun run{.solved = told && message.solved != 0,
                 .cpu_s = message.cpu_s,
                 .iterations = message.iterations,
                 .residual = told ? message.residual : kInf,
                 .own_tolerance = message.own_tolerance};
  if (!run.solved) run.failure = failure_of(status);
  return run;
}

}  // namespace aussois
