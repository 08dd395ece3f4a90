// SPDX-License-Identifier: Apache-2.0
#include "io/fclib_file.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/hdf5_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

// ---- vectors and single numbers

VecX read_sized(hid_t file, const std::string& name, Eigen::Index size) {
  VecX vector = read_vector(file, name);
  if (vector.size() != size)
    fail_hdf5(file, name,
              "has " + std::to_string(vector.size()) + " values, must have " + std::to_string(size));
  return vector;
}

void write_vector(hid_t file, const std::string& name, const VecX& vector) {
  write_fixed(file, name, std::vector<double>(vector.data(), vector.data() + vector.size()));
}

std::vector<int> read_integers(hid_t file, const std::string& name) {
  check_integers(file, name);
  return read_rows<int>(file, name);
}

int read_integer(hid_t file, const std::string& name) {
  const std::vector<int> values = read_integers(file, name);
  if (values.size() != 1)
    fail_hdf5(file, name, "has " + std::to_string(values.size()) + " values, must have 1");
  return values.front();
}

void write_integer(hid_t file, const std::string& name, Eigen::Index value) {
  write_fixed<int>(file, name, {int(value)});
}

// ---- sparse matrices

std::string entry(std::size_t k, const std::string& value) {
  return std::string("[").append(std::to_string(k)).append("] = ").append(value);
}
std::string entry(std::size_t k, int value) {
  return entry(k, std::to_string(value));
}

/// The first `count` indices; each must lie in [0, bound).
std::vector<int> read_indices(hid_t file, const std::string& name, std::size_t count, int bound) {
  std::vector<int> indices = read_integers(file, name);
  if (indices.size() < count)
    fail_hdf5(file, name,
              "has " + std::to_string(indices.size()) + " values, the matrix has " + std::to_string(count));
  indices.resize(count);
  for (std::size_t k = 0; k < count; ++k)
    if (indices[k] < 0 || indices[k] >= bound)
      fail_hdf5(file, name, entry(k, indices[k]) + " must lie in [0, " + std::to_string(bound) + ")");
  return indices;
}

/// Where the entries of each of `outer` columns (or rows) begin, and where the last ones end.
std::vector<int> read_starts(hid_t file, const std::string& name, int outer) {
  std::vector<int> starts = read_integers(file, name);
  if (starts.size() != std::size_t(outer) + 1)
    fail_hdf5(file, name,
              "has " + std::to_string(starts.size()) + " starts, must have " + std::to_string(outer + 1L));
  for (std::size_t k = 0; k < starts.size(); ++k)
    if (k == 0 ? starts[k] != 0 : starts[k] < starts[k - 1])
      fail_hdf5(file, name, entry(k, starts[k]) + " must be 0 first and not descend");
  return starts;
}

/// The column (or row) of each entry from the starts of the columns (or rows).
std::vector<int> outer_of(const std::vector<int>& starts) {
  std::vector<int> outer(starts.back());
  for (std::size_t k = 0; k + 1 < starts.size(); ++k)
    std::fill(outer.begin() + starts[k], outer.begin() + starts[k + 1], int(k));
  return outer;
}

/// The matrix must be rows x cols, as the vectors that were read before it.
SparseMatrix read_matrix(hid_t file, const std::string& name, Eigen::Index rows, Eigen::Index cols) {
  const int m = read_integer(file, name + "/m"), n = read_integer(file, name + "/n"),
            nz = read_integer(file, name + "/nz"), nzmax = read_integer(file, name + "/nzmax");
  if (m != rows || n != cols)
    fail_hdf5(file, name,
              "is " + std::to_string(m) + " x " + std::to_string(n) + ", must be " + std::to_string(rows) +
                  " x " + std::to_string(cols) + " as its vectors are");
  if (nz < -2)
    fail_hdf5(file, name + "/nz",
              "is " + std::to_string(nz) +
                  ", must be -1 (compressed columns), -2 (compressed rows) or a number of triplets");
  // Of triplets p has columns and i rows: the comment in fclib.h says the opposite, the files do not.
  std::vector<int> row, col;  // the file holds one of them; the other is made when its size is known to fit
  if (nz == -1) {
    const std::vector<int> starts = read_starts(file, name + "/p", n);
    row = read_indices(file, name + "/i", std::size_t(starts.back()), m);
    col = outer_of(starts);
  } else if (nz == -2) {
    const std::vector<int> starts = read_starts(file, name + "/p", m);
    col = read_indices(file, name + "/i", std::size_t(starts.back()), n);
    row = outer_of(starts);
  } else {
    col = read_indices(file, name + "/p", std::size_t(nz), n);
    row = read_indices(file, name + "/i", std::size_t(nz), m);
  }
  if (nzmax < 0 || std::size_t(nzmax) < row.size())
    fail_hdf5(file, name + "/nzmax",
              "is " + std::to_string(nzmax) + ", must be >= " + std::to_string(row.size()) + " entries");
  const std::vector<double> x = read_rows<double>(file, name + "/x");
  if (x.size() < row.size())
    fail_hdf5(file, name + "/x",
              "has " + std::to_string(x.size()) + " values, the matrix has " + std::to_string(row.size()));
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(row.size());
  for (std::size_t k = 0; k < row.size(); ++k) entries.emplace_back(row[k], col[k], x[k]);
  SparseMatrix A(rows, cols);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

void write_matrix(hid_t file, const std::string& name, SparseMatrix A) {
  A.makeCompressed();
  const Eigen::Index count = A.nonZeros();
  write_integer(file, name + "/nzmax", count);
  write_integer(file, name + "/m", A.rows());
  write_integer(file, name + "/n", A.cols());
  write_integer(file, name + "/nz", -1);
  write_fixed(file, name + "/p", std::vector<int>(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1));
  write_fixed(file, name + "/i", std::vector<int>(A.innerIndexPtr(), A.innerIndexPtr() + count));
  write_fixed(file, name + "/x", std::vector<double>(A.valuePtr(), A.valuePtr() + count));
}

// ---- laws

int row_count(const std::vector<Law>& laws) {
  return std::accumulate(laws.begin(), laws.end(), 0, [](int sum, const Law& law) { return sum + law.rows; });
}

/// FCLIB's spacedim, the rows of every block, if it can represent these laws (all coulomb or all rolling).
/// Otherwise 0.
int spacedim(const std::vector<Law>& laws) {
  if (laws.empty()) return 3;
  const Law& first = laws.front();
  const bool all_alike = std::all_of(laws.begin(), laws.end(), [&](const Law& law) {
    return law.kind == first.kind && law.rows == first.rows;
  });
  const bool known = first.kind == LawKind::coulomb || first.kind == LawKind::rolling;
  return all_alike && known ? first.rows : 0;
}

VecX column_of(const std::vector<Law>& laws, double Law::*field) {
  VecX column(Eigen::Index(laws.size()));
  for (std::size_t i = 0; i < laws.size(); ++i) column[Eigen::Index(i)] = laws[i].*field;
  return column;
}

void check_laws(hid_t file, const std::string& name, const std::vector<Law>& laws) {
  try {
    for (std::size_t i = 0; i < laws.size(); ++i) validate(laws[i], i);
  } catch (const std::invalid_argument& error) {
    fail_hdf5(file, name, error.what());
  }
}

std::vector<Law> read_plain_laws(hid_t file, const std::string& group, bool is_rolling) {
  const int dim = read_integer(file, group + "/spacedim");
  if (is_rolling ? dim != 5 : dim != 2 && dim != 3)
    fail_hdf5(file, group + "/spacedim",
              "is " + std::to_string(dim) + ", must be " + (is_rolling ? "5" : "2 or 3"));
  const VecX mu = read_vector(file, group + "/vectors/mu"),
             mu_r = is_rolling ? read_sized(file, group + "/vectors/mu_r", mu.size()) : VecX();
  std::vector<Law> laws;
  for (Eigen::Index i = 0; i < mu.size(); ++i)
    laws.push_back(is_rolling ? rolling(mu[i], mu_r[i]) : dim == 2 ? coulomb_2d(mu[i]) : coulomb(mu[i]));
  check_laws(file, group + "/vectors", laws);
  return laws;
}

constexpr LawKind kKinds[] = {LawKind::coulomb,    LawKind::rolling,   LawKind::contensou,
                              LawKind::unilateral, LawKind::bilateral, LawKind::dry_friction};

LawKind read_kind(hid_t file, const std::string& name, std::size_t i, const std::string& text) {
  for (const LawKind kind : kKinds)
    if (text == to_string(kind)) return kind;
  fail_hdf5(file, name,
            entry(i, aussois::quoted(text)) +
                " must be coulomb, rolling, contensou, unilateral, bilateral or dry_friction");
}

std::vector<Law> read_law_table(hid_t file, const std::string& name) {
  const std::vector<std::string> kinds = read_texts(file, name + "/kind");
  const std::vector<int> rows = read_integers(file, name + "/rows");
  if (rows.size() != kinds.size())
    fail_hdf5(file, name + "/rows",
              "has " + std::to_string(rows.size()) + " values, must have " + std::to_string(kinds.size()));
  const auto column = [&](const char* field) {
    return read_sized(file, name + "/" + field, Eigen::Index(kinds.size()));
  };
  const VecX mu = column("mu"), mu_r = column("mu_r"), radius = column("radius"), limit = column("limit");
  std::vector<Law> laws;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const Eigen::Index k = Eigen::Index(i);
    laws.push_back({.kind = read_kind(file, name + "/kind", i, kinds[i]),
                    .rows = rows[i],
                    .mu = mu[k],
                    .mu_r = mu_r[k],
                    .radius = radius[k],
                    .limit = limit[k]});
  }
  check_laws(file, name, laws);
  return laws;
}

void write_law_table(hid_t file, const std::string& name, const std::vector<Law>& laws) {
  std::vector<std::string> kinds;
  std::vector<int> rows;
  for (const Law& law : laws) {
    kinds.emplace_back(to_string(law.kind));
    rows.push_back(law.rows);
  }
  write_texts(file, name + "/kind", kinds);
  write_fixed(file, name + "/rows", rows);
  write_vector(file, name + "/mu", column_of(laws, &Law::mu));
  write_vector(file, name + "/mu_r", column_of(laws, &Law::mu_r));
  write_vector(file, name + "/radius", column_of(laws, &Law::radius));
  write_vector(file, name + "/limit", column_of(laws, &Law::limit));
}

void write_laws(hid_t file, const std::string& group, const std::vector<Law>& laws, int dim) {
  if (dim == 0) {
    write_law_table(file, group + "/laws", laws);
    return;
  }
  write_integer(file, group + "/spacedim", dim);
  write_vector(file, group + "/vectors/mu", column_of(laws, &Law::mu));
  if (dim == 5) write_vector(file, group + "/vectors/mu_r", column_of(laws, &Law::mu_r));
}

// ---- the problem

/// The form of a problem, which the name of its group gives.
struct Form {
  const char* group;
  bool is_local, is_rolling, has_table;
};
constexpr Form kForms[] = {
    {"/fclib_local", true, false, false},        {"/fclib_global", false, false, false},
    {"/fclib_local_rolling", true, true, false}, {"/fclib_global_rolling", false, true, false},
    {"/aussois_local", true, false, true},       {"/aussois_global", false, false, true},
};

const Form& form_of(hid_t file) {
  const Form* found = nullptr;
  for (const Form& form : kForms) {
    if (!has_link(file, form.group)) continue;
    if (found != nullptr)
      fail_hdf5(file, form.group,
                std::string("is in the file together with ") + found->group + ", must be the only problem");
    found = &form;
  }
  if (found == nullptr)
    fail_hdf5(file, "/",
              "has no group fclib_local, fclib_global, ..._rolling, aussois_local or aussois_global");
  return *found;
}

const Form& form_for(const std::vector<Law>& laws, bool is_local, bool is_compliant) {
  const int dim = is_compliant ? 0 : spacedim(laws);
  return *std::find_if(std::begin(kForms), std::end(kForms), [&](const Form& form) {
    return form.is_local == is_local && form.is_rolling == (dim == 5) && form.has_table == (dim == 0);
  });
}

std::vector<Law> read_laws(hid_t file, const Form& form) {
  const std::string group = form.group;
  return form.has_table ? read_law_table(file, group + "/laws")
                        : read_plain_laws(file, group, form.is_rolling);
}

LocalProblem read_local(hid_t file, const Form& form) {
  const std::string group = form.group;
  if (has_link(file, group + "/V"))
    fail_hdf5(file, group + "/V",
              "couples joints to a local problem: save the global one, or eliminate them");
  LocalProblem problem{.laws = read_laws(file, form)};
  const int m = row_count(problem.laws);
  problem.q = read_sized(file, group + "/vectors/q", m);
  problem.W = read_matrix(file, group + "/W", m, m);
  return problem;
}

FrictionProblem read_global(hid_t file, const Form& form) {
  const std::string group = form.group;
  FrictionProblem problem{.laws = read_laws(file, form)};
  const int m = row_count(problem.laws);
  problem.f = read_vector(file, group + "/vectors/f");
  problem.w = read_sized(file, group + "/vectors/w", m);
  const Eigen::Index n = problem.f.size();
  problem.M = read_matrix(file, group + "/M", n, n);
  problem.H = read_matrix(file, group + "/H", n, m);
  if (has_link(file, group + "/G")) {
    problem.b = read_vector(file, group + "/vectors/b");
    problem.G = read_matrix(file, group + "/G", n, problem.b.size());
  }
  if (form.has_table && has_link(file, group + "/vectors/R"))
    problem.R = read_sized(file, group + "/vectors/R", m);
  return problem;
}

void write_problem(hid_t file, const Form& form, const LocalProblem& problem) {
  const std::string group = form.group;
  write_laws(file, group, problem.laws, form.has_table ? 0 : spacedim(problem.laws));
  write_vector(file, group + "/vectors/q", problem.q);
  write_matrix(file, group + "/W", problem.W);
}

void write_problem(hid_t file, const Form& form, const FrictionProblem& problem) {
  const std::string group = form.group;
  const Eigen::Index n = problem.f.size();
  write_laws(file, group, problem.laws, form.has_table ? 0 : spacedim(problem.laws));
  write_vector(file, group + "/vectors/f", problem.f);
  write_vector(file, group + "/vectors/w", problem.w);
  write_matrix(file, group + "/M", problem.M);
  write_matrix(file, group + "/H", problem.laws.empty() ? SparseMatrix(n, 0) : problem.H);
  if (problem.b.size() > 0) {
    write_matrix(file, group + "/G", problem.G);
    write_vector(file, group + "/vectors/b", problem.b);
  }
  if (problem.R.size() > 0) write_vector(file, group + "/vectors/R", problem.R);
}

// ---- guesses and solution

/// How long the vectors of a start or an answer must be; -1: any.
struct Sizes {
  Eigen::Index r = 0, v = -1, l = -1;
};
Sizes sizes_of(const FclibFile& file) {
  if (const auto* problem = std::get_if<FrictionProblem>(&file.problem))
    return {.r = problem->w.size(), .v = problem->f.size(), .l = problem->b.size()};
  return {.r = std::get<LocalProblem>(file.problem).q.size()};
}

VecX read_optional(hid_t file, const std::string& name, Eigen::Index size) {
  if (!has_link(file, name)) return {};
  return size < 0 ? read_vector(file, name) : read_sized(file, name, size);
}

FclibValues read_values(hid_t file, const std::string& group, const Sizes& sizes) {
  group_names(file, group);  // fails with the name if there is no such group
  return {.r = read_optional(file, group + "/r", sizes.r),
          .u = read_optional(file, group + "/u", sizes.r),
          .v = read_optional(file, group + "/v", sizes.v),
          .l = read_optional(file, group + "/l", sizes.l)};
}

void write_values(hid_t file, const std::string& group, const FclibValues& values) {
  make_group(file, group);
  if (values.v.size() > 0) write_vector(file, group + "/v", values.v);
  if (values.u.size() > 0) write_vector(file, group + "/u", values.u);
  if (values.r.size() > 0) write_vector(file, group + "/r", values.r);
  if (values.l.size() > 0) write_vector(file, group + "/l", values.l);
}

void validate(const FclibValues& values, const Sizes& sizes, const std::string& name) {
  const auto fits = [&](const char* field, const VecX& vector, Eigen::Index size) {
    require_field(vector.size() == 0 || size < 0 || vector.size() == size, (name + field).c_str(),
                  vector.size(), ("be 0 or " + std::to_string(size)).c_str());
  };
  fits(".r.size()", values.r, sizes.r);
  fits(".u.size()", values.u, sizes.r);
  fits(".v.size()", values.v, sizes.v);
  fits(".l.size()", values.l, sizes.l);
}

void validate(const FclibFile& file) {
  std::visit([](const auto& problem) { validate(problem); }, file.problem);
  const Sizes sizes = sizes_of(file);
  for (std::size_t i = 0; i < file.guesses.size(); ++i)
    validate(file.guesses[i], sizes, "FclibFile::guesses[" + std::to_string(i) + "]");
  if (file.solution) validate(*file.solution, sizes, "FclibFile::solution");
}

void write_all(const std::filesystem::path& path, const FclibFile& content) {
  const Hdf5Id file = create_hdf5(path);
  const auto* global = std::get_if<FrictionProblem>(&content.problem);
  const Form& form = form_for(laws_of(content), global == nullptr, global != nullptr && global->R.size() > 0);
  std::visit([&](const auto& problem) { write_problem(file, form, problem); }, content.problem);
  const std::string info = std::string(form.group) + "/info";
  write_text_dataset(file, info + "/title", content.title);
  write_text_dataset(file, info + "/description", content.description);
  write_text_dataset(file, info + "/math_info", content.math_info);
  if (!content.guesses.empty()) {
    write_integer(file, "/guesses/number_of_guesses", Eigen::Index(content.guesses.size()));
    for (std::size_t i = 0; i < content.guesses.size(); ++i)
      write_values(file, "/guesses/" + std::to_string(i + 1), content.guesses[i]);
  }
  if (content.solution) write_values(file, "/solution", *content.solution);
  flush_hdf5(file);
}

}  // namespace

const std::vector<Law>& laws_of(const FclibFile& file) {
  return std::visit([](const auto& problem) -> const std::vector<Law>& { return problem.laws; },
                    file.problem);
}

FclibFile read_fclib(const std::filesystem::path& path) {
  const Hdf5Silence silence;
  const Hdf5Id file = open_hdf5(path, Hdf5Access::read);
  const Form& form = form_of(file);
  FclibFile out;
  if (form.is_local)
    out.problem = read_local(file, form);
  else
    out.problem = read_global(file, form);
  const std::string info = std::string(form.group) + "/info";
  const auto text = [&](const char* name) {
    return has_link(file, info) && has_link(file, info + name) ? read_text_dataset(file, info + name)
                                                               : std::string();
  };
  out.title = text("/title");
  out.description = text("/description");
  out.math_info = text("/math_info");
  const Sizes sizes = sizes_of(out);
  if (has_link(file, "/guesses")) {
    const int count = read_integer(file, "/guesses/number_of_guesses");
    for (int i = 1; i <= count; ++i)
      out.guesses.push_back(read_values(file, "/guesses/" + std::to_string(i), sizes));
  }
  if (has_link(file, "/solution")) out.solution = read_values(file, "/solution", sizes);
  try {
    validate(out);
  } catch (const std::invalid_argument& error) {
    fail_hdf5(file, form.group, error.what());
  }
  return out;
}

void write_fclib(const std::filesystem::path& path, const FclibFile& file) {
  validate(file);
  const Hdf5Silence silence;
  write_atomically(path, [&](const std::filesystem::path& temporary) { write_all(temporary, file); });
}

}  // namespace aussois
