// SPDX-License-Identifier: Apache-2.0
#include "io/fclib_file.hpp"

#include <bit>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <set>

#include "io/atomic_file.hpp"
#include "io/hdf5_file.hpp"
#include "tests/support/files.hpp"
#include "tests/support/leaks_of_hdf5.hpp"
#include "tests/support/little_memory.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

namespace fs = std::filesystem;

bool same_bits(const VecX& a, const VecX& b) {
  return a.size() == b.size() &&
         (a.size() == 0 || std::memcmp(a.data(), b.data(), std::size_t(a.size()) * sizeof(double)) == 0);
}

bool same_bits(SparseMatrix a, SparseMatrix b) {
  a.makeCompressed();
  b.makeCompressed();
  if (a.rows() != b.rows() || a.cols() != b.cols() || a.nonZeros() != b.nonZeros()) return false;
  for (int j = 0; j < a.outerSize(); ++j) {
    SparseMatrix::InnerIterator x(a, j), y(b, j);
    for (; x && y; ++x, ++y)
      if (x.row() != y.row() ||
          std::bit_cast<std::uint64_t>(x.value()) != std::bit_cast<std::uint64_t>(y.value()))
        return false;
    if (x || y) return false;
  }
  return true;
}

bool same(const std::vector<Law>& a, const std::vector<Law>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Law& x, const Law& y) {
    return x.kind == y.kind && x.rows == y.rows && x.mu == y.mu && x.mu_r == y.mu_r && x.radius == y.radius &&
           x.limit == y.limit;
  });
}

bool same(const FclibValues& a, const FclibValues& b) {
  return same_bits(a.r, b.r) && same_bits(a.u, b.u) && same_bits(a.v, b.v) && same_bits(a.l, b.l);
}

std::string difference(const LocalProblem& a, const LocalProblem& b) {
  if (!same(a.laws, b.laws)) return "laws";
  if (!same_bits(a.W, b.W)) return "W";
  return same_bits(a.q, b.q) ? "" : "q";
}

std::string difference(const FrictionProblem& a, const FrictionProblem& b) {
  if (!same(a.laws, b.laws)) return "laws";
  if (!same_bits(a.M, b.M)) return "M";
  if (!same_bits(a.H, b.H)) return "H";
  if (!same_bits(a.G, b.G)) return "G";
  if (!same_bits(a.f, b.f) || !same_bits(a.w, b.w)) return "f or w";
  return same_bits(a.b, b.b) && same_bits(a.R, b.R) ? "" : "b or R";
}

/// What is not the same to the last bit, or "".
std::string difference(const FclibFile& a, const FclibFile& b) {
  if (a.problem.index() != b.problem.index()) return "form";
  if (const auto* local = std::get_if<LocalProblem>(&a.problem))
    return difference(*local, std::get<LocalProblem>(b.problem));
  return difference(std::get<FrictionProblem>(a.problem), std::get<FrictionProblem>(b.problem));
}

std::string difference_of_all(const FclibFile& a, const FclibFile& b) {
  if (a.title != b.title || a.description != b.description || a.math_info != b.math_info) return "info";
  if (!std::equal(a.guesses.begin(), a.guesses.end(), b.guesses.begin(), b.guesses.end(),
                  [](const FclibValues& x, const FclibValues& y) { return same(x, y); }))
    return "guesses";
  if (a.solution.has_value() != b.solution.has_value() || (a.solution && !same(*a.solution, *b.solution)))
    return "solution";
  return difference(a, b);
}

// ---- random problems

/// Also numbers that a careless format loses.
double any_number(Random& random) {
  constexpr double kNasty[] = {-0.0, 5e-324, -1e-310, 1.7976931348623157e308, kInf, -kInf};
  return random.index(10) == 0 ? kNasty[random.index(6)] : random.uniform(-1, 1);
}

VecX any_vector(Random& random, int size) {
  VecX x(size);
  for (double& value : x) value = any_number(random);
  return x;
}

SparseMatrix any_matrix(Random& random, int rows, int cols) {
  std::vector<Triplet> entries;
  for (int j = 0; j < cols; ++j)
    for (int i = 0; i < rows; ++i)
      if (random.index(3) == 0) entries.emplace_back(i, j, any_number(random));
  SparseMatrix A(rows, cols);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

Law any_law(Random& random) {
  const double mu = random.uniform(0, 2), second = random.uniform(0.1, 1);
  switch (random.index(7)) {
    case 0:
      return coulomb(mu);
    case 1:
      return coulomb_2d(mu);
    case 2:
      return rolling(mu, second);
    case 3:
      return contensou(mu, second);
    case 4:
      return unilateral();
    case 5:
      return bilateral(1 + random.index(6));
    default:
      return dry_friction(second);
  }
}

enum class Family { plane, space, rolling, mixed };

std::vector<Law> any_laws(Random& random, Family family) {
  std::vector<Law> laws(1 + random.index(5));
  for (Law& law : laws) {
    const double mu = random.uniform();
    law = family == Family::plane     ? coulomb_2d(mu)
          : family == Family::space   ? coulomb(mu)
          : family == Family::rolling ? rolling(mu, random.uniform())
                                      : any_law(random);
  }
  if (family == Family::mixed) laws.push_back(unilateral());  // never plain by accident
  return laws;
}

int rows_of(const std::vector<Law>& laws) {
  int rows = 0;
  for (const Law& law : laws) rows += law.rows;
  return rows;
}

FclibValues any_values(Random& random, int m, int n, int p) {
  return {.r = any_vector(random, m),
          .u = any_vector(random, m),
          .v = any_vector(random, n),
          .l = any_vector(random, p)};
}

FclibFile any_file(Random& random, Family family, bool is_local, bool has_joints, bool is_compliant) {
  FclibFile file{.title = "title", .description = "two\nlines, \xc3\xa9", .math_info = ""};
  const std::vector<Law> laws = any_laws(random, family);
  const int m = rows_of(laws), n = 1 + random.index(9), p = has_joints ? 1 + random.index(3) : 0;
  if (is_local) {
    file.problem = LocalProblem{.W = any_matrix(random, m, m), .q = any_vector(random, m), .laws = laws};
  } else {
    FrictionProblem problem{.M = any_matrix(random, n, n),
                            .H = any_matrix(random, n, m),
                            .f = any_vector(random, n),
                            .w = any_vector(random, m),
                            .laws = laws};
    if (has_joints) {
      problem.G = any_matrix(random, n, p);
      problem.b = any_vector(random, p);
    }
    if (is_compliant) problem.R = any_vector(random, m).cwiseAbs();
    file.problem = problem;
  }
  for (int i = random.index(4); i > 0; --i) file.guesses.push_back(any_values(random, m, n, p));
  if (random.index(2) == 0) file.solution = any_values(random, m, n, p);
  return file;
}

std::string group_of(const fs::path& path) {
  const Hdf5Silence silence;
  const Hdf5Id file = open_hdf5(path, Hdf5Access::read);
  for (const std::string& name : group_names(file, "/"))
    if (name != "guesses" && name != "solution") return name;
  return "";
}

/// Two contacts in space, small enough to say by hand what is wrong with it.
FclibFile small_local() {
  SparseMatrix W(6, 6);
  W.setIdentity();
  return {
      .problem = LocalProblem{.W = W, .q = VecX::LinSpaced(6, -1, 1), .laws = {coulomb(0.3), coulomb(0.5)}},
      .title = "small"};
}

FclibFile small_global() {
  SparseMatrix M(4, 4), H(4, 3), G(4, 1);
  M.setIdentity();
  H.insert(0, 0) = 1;
  G.insert(3, 0) = 1;
  return {.problem = FrictionProblem{.M = M,
                                     .H = H,
                                     .f = VecX::Ones(4),
                                     .w = VecX::Zero(3),
                                     .laws = {coulomb(0.3)},
                                     .G = G,
                                     .b = VecX::Zero(1)}};
}

FclibFile small_mixed() {
  FclibFile file = small_global();
  std::get<FrictionProblem>(file.problem).laws = {unilateral(), bilateral(2)};
  return file;
}

// ---- files with something wrong

using Change = std::function<void(hid_t)>;

void remove_link(hid_t file, const std::string& name) {
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
}
template <class T>
void replace(hid_t file, const std::string& name, const std::vector<T>& values) {
  remove_link(file, name);
  write_rows<T>(file, name, values);
}

/// What read_fclib says of the file after the change, without the path.
std::string complaint(const FclibFile& good, const Change& change) {
  const fs::path path = fresh_folder() / "changed.hdf5";
  write_fclib(path, good);
  {
    const Hdf5Silence silence;
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    change(file);
  }
  const std::string message = message_of<std::runtime_error>([&] { read_fclib(path); });
  return message.rfind(path.string() + ": ", 0) == 0 ? message.substr(path.string().size() + 2) : message;
}

fs::path library() {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  return data != nullptr && *data != '\0' ? fs::path(data) / "fclib" : fs::path();
}

/// Without the entries that are zero.
SparseMatrix pruned(SparseMatrix A) {
  A.prune([](Eigen::Index, Eigen::Index, double value) { return value != 0; });
  return A;
}

}  // namespace

TEST(FclibFile, ComesBackToTheLastBitInEveryForm) {
  const fs::path folder = fresh_folder();
  std::set<std::string> groups;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const Family family = Family(seed % 4);
    const bool is_local = seed / 4 % 2 == 0, has_joints = !is_local && seed / 8 % 2 == 0,
               is_compliant = !is_local && seed / 16 % 2 == 0;
    const FclibFile written = any_file(random, family, is_local, has_joints, is_compliant);
    write_fclib(folder / "a.hdf5", written);
    const FclibFile back = read_fclib(folder / "a.hdf5");
    EXPECT_EQ(difference_of_all(written, back), "") << "seed " << seed;
    write_fclib(folder / "b.hdf5", back);
    EXPECT_EQ(content_of(folder / "a.hdf5"), content_of(folder / "b.hdf5")) << "seed " << seed;
    const std::string group = group_of(folder / "a.hdf5");
    groups.insert(group);
    // What FCLIB would misread does not carry its name.
    EXPECT_EQ(group.rfind("aussois", 0) == 0, family == Family::mixed || is_compliant) << "seed " << seed;
  }
  EXPECT_EQ(groups, (std::set<std::string>{"fclib_local", "fclib_global", "fclib_local_rolling",
                                           "fclib_global_rolling", "aussois_local", "aussois_global"}));
}

TEST(FclibFile, HoldsProblemsWithoutContacts) {
  const fs::path folder = fresh_folder();
  SparseMatrix M(2, 2);
  M.setIdentity();
  const FclibFile local{.problem = LocalProblem{}},
      global{.problem = FrictionProblem{.M = M, .f = VecX::Ones(2)}};
  write_fclib(folder / "local.hdf5", local);
  EXPECT_EQ(laws_of(read_fclib(folder / "local.hdf5")).size(), 0u);
  write_fclib(folder / "global.hdf5", global);
  const auto back = std::get<FrictionProblem>(read_fclib(folder / "global.hdf5").problem);
  EXPECT_EQ(back.f, VecX::Ones(2));
  EXPECT_EQ(back.H.rows(), 2);
  EXPECT_EQ(back.H.cols(), 0);
}

TEST(FclibFile, LeavesNoTemporaryFileAndTheOldOneIfItFails) {
  const fs::path path = fresh_folder() / "problem.hdf5";
  write_fclib(path, small_local());
  EXPECT_EQ(names_in(path.parent_path()), std::set<std::string>{path.filename().string()});
  const std::string before = content_of(path);
  FclibFile wrong = small_local();
  std::get<LocalProblem>(wrong.problem).q = VecX::Zero(5);
  EXPECT_NE(message_of([&] { write_fclib(path, wrong); }), "");
  EXPECT_EQ(content_of(path), before);
  EXPECT_NE(message_of<std::runtime_error>([&] { write_fclib(path / "below" / "a_file", small_local()); }),
            "");
}

TEST(FclibFile, RefusesToWriteGuessesOfAnotherSize) {
  FclibFile file = small_global();
  file.guesses = {{}, {.r = VecX::Zero(2)}};
  const fs::path path = fresh_folder() / "problem.hdf5";
  EXPECT_EQ(message_of([&] { write_fclib(path, file); }),
            "FclibFile::guesses[1].r.size() = 2 must be 0 or 3");
  file.guesses.clear();
  file.solution = FclibValues{.l = VecX::Zero(2)};
  EXPECT_EQ(message_of([&] { write_fclib(path, file); }), "FclibFile::solution.l.size() = 2 must be 0 or 1");
  EXPECT_FALSE(fs::exists(path));
}

// The matrix [1 0 5; 0 4 0; 0 0 2.5 (as 2 + 0.5)] in each storage, arrays longer than they need be.
TEST(FclibFile, ReadsCompressedColumnsRowsAndTriplets) {
  struct Storage {
    int nz;
    std::vector<int> p, i;
    std::vector<double> x;
  };
  const std::vector<Storage> storages = {
      {-1, {0, 1, 2, 5}, {0, 1, 2, 0, 2, 77}, {1, 4, 2, 5, 0.5, 9}},
      {-2, {0, 2, 3, 5}, {2, 0, 1, 2, 2, -1}, {5, 1, 4, 2, 0.5, 9}},
      {5, {2, 0, 1, 2, 2, -3}, {2, 0, 1, 0, 2, 99}, {2, 1, 4, 5, 0.5, 9}},
  };
  MatX expected(3, 3);
  expected << 1, 0, 5, 0, 4, 0, 0, 0, 2.5;
  FclibFile good{.problem = LocalProblem{.W = SparseMatrix(3, 3), .q = VecX::Zero(3), .laws = {coulomb(1)}}};
  const fs::path path = fresh_folder() / "problem.hdf5";
  for (const Storage& storage : storages) {
    write_fclib(path, good);
    {
      const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
      replace<int>(file, "/fclib_local/W/nz", {storage.nz});
      replace<int>(file, "/fclib_local/W/nzmax", {6});
      replace<int>(file, "/fclib_local/W/p", storage.p);
      replace<int>(file, "/fclib_local/W/i", storage.i);
      replace<double>(file, "/fclib_local/W/x", storage.x);
    }
    EXPECT_EQ(MatX(std::get<LocalProblem>(read_fclib(path).problem).W), expected) << "nz " << storage.nz;
  }
}

TEST(FclibFile, ReadsTextsOfVariableLengthAndFilesWithoutInfo) {
  const fs::path path = fresh_folder() / "problem.hdf5";
  write_fclib(path, small_local());
  {
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    remove_link(file, "/fclib_local/info/title");
    const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
    H5Tset_size(type, H5T_VARIABLE);
    const Hdf5Id title(
        H5Dcreate2(file, "/fclib_local/info/title", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    const char* text = "of any length";
    H5Dwrite(title, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text);
  }
  EXPECT_EQ(read_fclib(path).title, "of any length");
  EXPECT_EQ(complaint(small_local(), [](hid_t file) { remove_link(file, "/fclib_local/info"); }), "");
}

TEST(FclibFile, ComplainsAboutEveryDatasetThatIsMissing) {
  const auto complaints = [](const FclibFile& good, const std::string& group,
                             const std::vector<std::string>& names) {
    for (const std::string& name : names)
      EXPECT_EQ(complaint(good, [&](hid_t file) { remove_link(file, group + name); }).rfind(group + name, 0),
                0u)
          << group + name;
  };
  complaints(small_local(), "/fclib_local",
             {"/spacedim", "/vectors/mu", "/vectors/q", "/W/m", "/W/n", "/W/nz", "/W/nzmax", "/W/p", "/W/i",
              "/W/x"});
  complaints(small_global(), "/fclib_global",
             {"/spacedim", "/vectors/mu", "/vectors/f", "/vectors/w", "/vectors/b", "/M/x", "/H/x", "/G/x"});
  complaints(small_mixed(), "/aussois_global",
             {"/laws/kind", "/laws/rows", "/laws/mu", "/laws/mu_r", "/laws/radius", "/laws/limit"});
}

TEST(FclibFile, ComplainsWithDatasetValueAndBound) {
  const std::string W = "/fclib_local/W";
  const struct {
    const char* what;
    FclibFile good;
    Change change;
    const char* says;
  } cases[] = {
      {"no group", small_local(), [](hid_t f) { remove_link(f, "/fclib_local"); },
       "/: has no group fclib_local, fclib_global, ..._rolling, aussois_local or aussois_global"},
      {"two groups", small_local(), [](hid_t f) { make_group(f, "/fclib_global"); },
       "/fclib_global: is in the file together with /fclib_local, must be the only problem"},
      {"joints of a local problem", small_local(), [](hid_t f) { make_group(f, "/fclib_local/V"); },
       "/fclib_local/V: couples joints to a local problem: save the global one, or eliminate them"},
      {"spacedim", small_local(), [](hid_t f) { replace<int>(f, "/fclib_local/spacedim", {4}); },
       "/fclib_local/spacedim: is 4, must be 2 or 3"},
      {"spacedim that does not fit", small_local(),
       [](hid_t f) { replace<int>(f, "/fclib_local/spacedim", {2}); },
       "/fclib_local/vectors/q: has 6 values, must have 4"},
      {"two values for one", small_local(),
       [&](hid_t f) {
         replace<int>(f, W + "/m", {6, 6});
       },
       "/fclib_local/W/m: has 2 values, must have 1"},
      {"numbers for integers", small_local(), [&](hid_t f) { replace<double>(f, W + "/m", {6.5}); },
       "/fclib_local/W/m: does not hold integers"},
      {"negative friction", small_local(),
       [](hid_t f) {
         replace<double>(f, "/fclib_local/vectors/mu", {0.3, -1});
       },
       "/fclib_local/vectors: laws[1].mu = -1 must be finite and >= 0"},
      {"friction that is not a number", small_local(),
       [](hid_t f) {
         replace<double>(f, "/fclib_local/vectors/mu", {std::nan(""), 1});
       },
       "/fclib_local/vectors: laws[0].mu = nan must be finite and >= 0"},
      {"too few q", small_local(),
       [](hid_t f) {
         replace<double>(f, "/fclib_local/vectors/q", {1, 2});
       },
       "/fclib_local/vectors/q: has 2 values, must have 6"},
      {"another shape", small_local(), [&](hid_t f) { replace<int>(f, W + "/m", {5}); },
       "/fclib_local/W: is 5 x 6, must be 6 x 6 as its vectors are"},
      {"unknown storage", small_local(), [&](hid_t f) { replace<int>(f, W + "/nz", {-3}); },
       "/fclib_local/W/nz: is -3, must be -1 (compressed columns), -2 (compressed rows) or a number of "
       "triplets"},
      {"too few starts", small_local(),
       [&](hid_t f) {
         replace<int>(f, W + "/p", {0, 1, 2});
       },
       "/fclib_local/W/p: has 3 starts, must have 7"},
      {"starts that descend", small_local(),
       [&](hid_t f) {
         replace<int>(f, W + "/p", {0, 1, 2, 1, 4, 5, 6});
       },
       "/fclib_local/W/p: [3] = 1 must be 0 first and not descend"},
      {"a first start", small_local(),
       [&](hid_t f) {
         replace<int>(f, W + "/p", {1, 1, 2, 3, 4, 5, 6});
       },
       "/fclib_local/W/p: [0] = 1 must be 0 first and not descend"},
      {"an index beyond", small_local(),
       [&](hid_t f) {
         replace<int>(f, W + "/i", {0, 1, 2, 3, 4, 6});
       },
       "/fclib_local/W/i: [5] = 6 must lie in [0, 6)"},
      {"a negative index", small_local(),
       [&](hid_t f) {
         replace<int>(f, W + "/i", {0, 1, -2, 3, 4, 5});
       },
       "/fclib_local/W/i: [2] = -2 must lie in [0, 6)"},
      {"too few indices", small_local(),
       [&](hid_t f) {
         replace<int>(f, W + "/i", {0, 1});
       },
       "/fclib_local/W/i: has 2 values, the matrix has 6"},
      {"more triplets than columns of them", small_local(), [&](hid_t f) { replace<int>(f, W + "/nz", {9}); },
       "/fclib_local/W/p: has 7 values, the matrix has 9"},
      {"too few values", small_local(),
       [&](hid_t f) {
         replace<double>(f, W + "/x", {1, 2});
       },
       "/fclib_local/W/x: has 2 values, the matrix has 6"},
      {"nzmax below nz", small_local(), [&](hid_t f) { replace<int>(f, W + "/nzmax", {5}); },
       "/fclib_local/W/nzmax: is 5, must be >= 6 entries"},
      {"texts for numbers", small_local(),
       [](hid_t f) {
         remove_link(f, "/fclib_local/vectors/q");
         write_texts(f, "/fclib_local/vectors/q", std::vector<std::string>(6, "one"));
       },
       "/fclib_local/vectors/q: cannot be read"},
      {"numbers for texts", small_local(),
       [](hid_t f) { replace<double>(f, "/fclib_local/info/title", {1}); },
       "/fclib_local/info/title: is not one text"},
      {"joints without their bias", small_global(),
       [](hid_t f) { remove_link(f, "/fclib_global/vectors/b"); }, "/fclib_global/vectors/b: is missing"},
      {"directions of another number of rows", small_global(),
       [](hid_t f) { replace<int>(f, "/fclib_global/H/n", {6}); },
       "/fclib_global/H: is 4 x 6, must be 4 x 3 as its vectors are"},
      {"an unknown law", small_mixed(),
       [](hid_t f) {
         remove_link(f, "/aussois_global/laws/kind");
         write_texts(f, "/aussois_global/laws/kind", {"unilateral", "sticky"});
       },
       "/aussois_global/laws/kind: [1] = 'sticky' must be coulomb, rolling, contensou, unilateral, bilateral "
       "or "
       "dry_friction"},
      {"rows that do not fit a law", small_mixed(),
       [](hid_t f) {
         replace<int>(f, "/aussois_global/laws/rows", {2, 1});
       },
       "/aussois_global/laws: laws[0].rows = 2 must be 1 of this law"},
      {"a column of another length", small_mixed(),
       [](hid_t f) { replace<int>(f, "/aussois_global/laws/rows", {1}); },
       "/aussois_global/laws/rows: has 1 values, must have 2"},
      {"guesses that are not there", small_local(),
       [](hid_t f) { write_rows<int>(f, "/guesses/number_of_guesses", {1}); },
       "/guesses/1: is missing or not a group"},
      {"a guess of another size", small_local(),
       [](hid_t f) {
         write_rows<int>(f, "/guesses/number_of_guesses", {1});
         write_rows<double>(f, "/guesses/1/r", {1});
       },
       "/guesses/1/r: has 1 values, must have 6"},
      {"a compliance below zero", small_mixed(),
       [](hid_t f) {
         write_rows<double>(f, "/aussois_global/vectors/R", {0, -62, 1});
       },
       "/aussois_global: FrictionProblem::R[1] = -62 must be >= 0"},
      {"a solution of another size", small_global(),
       [](hid_t f) { write_rows<double>(f, "/solution/v", {1}); }, "/solution/v: has 1 values, must have 4"},
  };
  for (const auto& wrong : cases) EXPECT_EQ(complaint(wrong.good, wrong.change), wrong.says) << wrong.what;
}

// A few bytes that announce eight gigabytes: refused with the same words where there is no memory for them.
TEST(FclibFile, AsksForNoMemoryThatItsBytesDoNotFill) {
  const fs::path path = fresh_folder() / "bomb.hdf5";
  for (const int storage : {-1, -2}) {
    write_fclib(path, small_local());
    {
      const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
      replace<int>(file, "/fclib_local/W/nz", {storage});
      replace<int>(file, "/fclib_local/W/p", {0, 0, 0, 0, 0, 0, 2147483647});
      replace<int>(file, "/fclib_local/W/nzmax", {2147483647});
    }
    EXPECT_LT(fs::file_size(path), 30000U);
    EXPECT_EQ(message_with_little_memory([&] { read_fclib(path); }),
              path.string() + ": /fclib_local/W/i: has 6 values, the matrix has 2147483647");
  }
}

// 7 times its inverse modulo 2^64 is one: for HDF5, these are a dataset of one text.
TEST(FclibFile, CountsTheValuesOfADatasetWithoutOverflow) {
  const fs::path path = fresh_folder() / "wraps.hdf5";
  write_fclib(path, small_local());
  {
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    remove_link(file, "/fclib_local/info/title");
    const hsize_t sides[] = {7, 0x6db6db6db6db6db7}, endless[] = {H5S_UNLIMITED, H5S_UNLIMITED},
                  chunk[] = {7, 1000};
    const Hdf5Id space(H5Screate_simple(2, sides, endless), H5Sclose), type(H5Tcopy(H5T_C_S1), H5Tclose),
        layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    ASSERT_EQ(H5Sget_simple_extent_npoints(space), 1);
    H5Pset_chunk(layout, 2, chunk);
    const Hdf5Id title(
        H5Dcreate2(file, "/fclib_local/info/title", type, space, H5P_DEFAULT, layout, H5P_DEFAULT), H5Dclose);
    ASSERT_GE(title, 0);
  }
  EXPECT_EQ(message_of<std::runtime_error>([&] { read_fclib(path); }),
            path.string() + ": /fclib_local/info/title: is not one text");
}

TEST(FclibFile, ComplainsAboutFilesThatAreNone) {
  const fs::path folder = fresh_folder();
  const auto message = [](const fs::path& path) {
    return message_of<std::runtime_error>([&] { read_fclib(path); });
  };
  EXPECT_EQ(message(folder / "none.hdf5"), (folder / "none.hdf5").string() + ": no such file");
  EXPECT_EQ(message(folder), folder.string() + ": no such file");
  EXPECT_NE(message(write_bytes(folder / "text.hdf5", "not HDF5")).find("text.hdf5: not an HDF5 file"),
            std::string::npos);
  write_fclib(folder / "good.hdf5", small_global());
  const std::string good = content_of(folder / "good.hdf5");
  for (std::size_t size = 0; size < good.size(); size += good.size() / 37)  // never a crash
    EXPECT_NE(message(write_bytes(folder / "cut.hdf5", good.substr(0, size))), "") << size << " bytes";
}

// HDF5 1.10 itself loses a few hundred bytes over some damaged files and then says "infinite loop closing
// library" as the process ends.
TEST(FclibFile, NeverCrashesOnFlippedBits) {
  const LeaksOfHdf5 leaks_of_hdf5;
  const fs::path folder = fresh_folder();
  write_fclib(folder / "good.hdf5", small_mixed());
  const std::string good = content_of(folder / "good.hdf5");
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    std::string bad = good;
    char& byte = bad[random.index(int(bad.size()))];
    byte = char(byte ^ (1 << random.index(8)));
    refused +=
        message_of<std::runtime_error>([&] { read_fclib(write_bytes(folder / "bad.hdf5", bad)); }) != "";
  }
  EXPECT_GT(refused, 10);  // the others hit padding, or a number that may be anything
}

TEST(FclibFile, ReadsEveryProblemOfTheLibrary) {
  if (library().empty()) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  int files = 0, locals = 0, contacts = 0, most = 0;
  std::set<int> dimensions;
  const fs::path copy = fresh_folder() / "copy.hdf5";
  for (const auto& item : fs::recursive_directory_iterator(library())) {
    if (item.path().extension() != ".hdf5") continue;
    const FclibFile file = read_fclib(item.path());
    const int count = int(laws_of(file).size());
    ++files;
    locals += file.problem.index() == 0;
    contacts += count;
    most = std::max(most, count);
    for (const Law& law : laws_of(file)) dimensions.insert(law.rows);
    write_fclib(copy, file);
    EXPECT_EQ(difference_of_all(file, read_fclib(copy)), "") << item.path();
  }
  EXPECT_EQ(files, 45);
  EXPECT_EQ(locals, 23 + 7 + 3 + 1);  // 3D, 2D, rolling, and one original
  EXPECT_EQ(most, 7002);
  EXPECT_EQ(dimensions, (std::set<int>{2, 3, 5}));
  EXPECT_GT(contacts, 0);
}

TEST(FclibFile, OriginalsOfOtherStoragesAreThoseRewritten) {
  if (library().empty()) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  const auto both = [](const char* name) {
    std::array<FclibFile, 2> files = {read_fclib(library() / name),
                                      read_fclib(library() / "originals" / name)};
    for (FclibFile& file : files) {
      if (auto* local = std::get_if<LocalProblem>(&file.problem)) {
        local->W = pruned(local->W);
      } else {
        FrictionProblem& global = std::get<FrictionProblem>(file.problem);
        global.M = pruned(global.M);
        global.H = pruned(global.H);
      }
    }
    return files;
  };
  const auto boxes = both("Box_Stacks-i0122-82-5.hdf5"), capsules = both("Capsules-i125-1213.hdf5");
  EXPECT_EQ(difference(boxes[0], boxes[1]), "");        // triplets, nz != nzmax
  EXPECT_EQ(difference(capsules[0], capsules[1]), "");  // compressed rows
  EXPECT_TRUE(same(boxes[0].guesses.at(0), boxes[1].guesses.at(0)));
}

}  // namespace aussois
