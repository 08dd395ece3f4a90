// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include "geometry/mesh_report.hpp"
#include "geometry/primitives.hpp"
#include "io/atomic_file.hpp"
#include "io/checkpoint.hpp"
#include "io/fclib_file.hpp"
#include "io/part_mesh.hpp"
#include "io/sealed_file.hpp"
#include "io/shape_cache.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/fuzz/hdf5_edits.hpp"
#include "tests/unit/io/io_samples.hpp"

namespace aussois {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kKey = 1;  // of the cached shapes and the checkpoint

/// Good files, made before the first input.
using Originals = std::vector<std::string>;

template <class Content, class Write>
Originals originals(const std::vector<Content>& contents, const Write& write) {
  Originals out;
  const fs::path file = fs::temp_directory_path() / ("aussois-fuzz-" + std::to_string(getpid()) + ".h5");
  for (const Content& content : contents) {
    write(file, content);
    out.push_back(content_of(file));
  }
  fs::remove(file);
  return out;
}

/// The first byte of an input chooses the file that the others change; `finish` has the last word.
auto edited(Originals originals, std::function<void(const fs::path&)> finish = {}) {
  return [originals = std::move(originals), finish = std::move(finish)](const fs::path& file, Bytes input) {
    write_bytes(file, originals[input.empty() ? 0 : input[0] % originals.size()]);
    if (!input.empty()) edit_hdf5(file, input.subspan(1));
    if (finish) finish(file);
  };
}

std::vector<FclibFile> problems() {
  SparseMatrix W(6, 6), M(5, 5), H(5, 3), G(5, 1);
  W.setIdentity();
  M.setIdentity();
  H.insert(0, 0) = 1;
  G.insert(3, 0) = 1;
  const LocalProblem local{.W = W, .q = VecX::LinSpaced(6, -1, 1), .laws = {coulomb(0.3), coulomb(0.5)}};
  const FrictionProblem global{.M = M,
                               .H = H,
                               .f = VecX::Ones(5),
                               .w = VecX::Zero(3),
                               .laws = {coulomb(0.3)},
                               .G = G,
                               .b = VecX::Zero(1)};
  FrictionProblem mixed = global, rolls = global;
  mixed.laws = {unilateral(), bilateral(2)};
  mixed.R = VecX::Ones(3);
  rolls.laws = {rolling(0.3, 0.01)};
  rolls.w = VecX::Zero(5);
  rolls.H = SparseMatrix(5, 5);
  return {{.problem = local, .title = "local", .guesses = {{.r = VecX::Zero(6)}, {}}},
          {.problem = global, .solution = FclibValues{.r = VecX::Zero(3), .v = VecX::Zero(5)}},
          {.problem = mixed, .description = "mixed"},
          {.problem = rolls}};
}

void use_problem(const fs::path& file) {
  std::visit([](const auto& problem) { validate(problem); }, read_fclib(file).problem);
}

void write_run(const fs::path& file, const RunData& run) {
  RunWriter writer(file, run.header);
  for (const RunStep& step : run.steps) writer.append(step);
  writer.close();
}

std::vector<RunData> runs() {
  RunData run = peg_run(7);  // with the fewest simplices that a run can have: others are only longer
  for (auto& [name, mesh] : run.header.meshes) {
    mesh.vertices.resize(4);
    mesh.faces = {{0, 1, 2}};
    mesh.wires = {{0, 3}};
  }
  RunData bare;
  bare.steps.resize(1);
  return {run, bare};
}

// A run that was interrupted goes on after its first step.
void resume_run(const fs::path& file) {
  fs::rename(file, growing_name(file));
  RunWriter::resume(file, 1).close();
  read_run(file);
}

std::vector<Checkpoint> checkpoints() {
  Checkpoint checkpoint{.fingerprint = kKey, .step = 7};
  State& state = checkpoint.state;
  state.g.resize(2);
  state.v = VecX::LinSpaced(15, -1, 1);
  state.q = Vec3(1, 2, 3);
  state.turns = {0, 1};
  state.r = Vec2(1, 2);
  state.memory.contacts.resize(2);
  checkpoint.numbers = {{"force", 1.5}, {"gap", kInf}};
  checkpoint.counts = {{"rows", 7}};
  return {checkpoint, {.fingerprint = kKey}};
}

std::vector<LmdShape> shapes() {
  const SimplicialComplex mixed = make_complex(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {3, 0, 0}, {3, 0.1, 0.5}, {-2, 0, 0}},
      {{0, 1, 2}, {0, 2, 3}}, {{0, 4}, {5, 6}});
  return {prepare(dilate(mixed, 0.01)), prepare(dilate(make_box(1, 1, 1, 2), 0.01)),
          prepare(dilate(make_point(), 0.1)),
          prepare(dilate(make_sphere(1, 2), 0.01), {.levels = 1})};  // 320 triangles: the fewest with a level
}

std::vector<PartMesh> kept_meshes() {
  PartMesh mesh{.complex = make_box(1, 1, 1), .notes = {"mended", "twice"}};
  mesh.report = report_mesh(mesh.complex);
  const SimplicialComplex plate = make_plate(1, 1);
  return {mesh, {.complex = plate, .report = report_mesh(plate)}};
}

/// A shape that passed all checks is one that searches walk through, whatever they find.
void use_shape(const fs::path& file) {
  const LmdShape shape = read_lmd_shape(file, kKey);
  const LmdShape box = prepare(dilate(make_box(1, 1, 1), 0));
  for (const double x : {0.0, 1.2, 4.0})
    find_contacts({&shape, {}, 0}, {&box, translation(x, 0.3, 0.7), 1}, {.threshold = 1});
}

}  // namespace

std::vector<FuzzedReader> hdf5_readers() {
  const auto unseal = [](const fs::path& file) {
    fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
    fs::resize_file(file, fs::file_size(file) - sizeof(std::uint64_t));  // `seal` follows the changes
  };
  const auto write_shape = [unseal](const fs::path& file, const LmdShape& shape) {
    write_lmd_shape(file, shape, kKey);
    unseal(file);
  };
  const auto write_mesh = [unseal](const fs::path& file, const PartMesh& mesh) {
    write_kept_mesh(file, mesh, kKey);
    unseal(file);
  };
  return {{"fclib", ".hdf5", edited(originals(problems(), write_fclib)), use_problem},
          {"run", ".h5", edited(originals(runs(), write_run)), read_run},
          {"resume", ".h5", edited(originals(runs(), write_run)), resume_run},
          {"checkpoint", ".h5", edited(originals(checkpoints(), write_checkpoint)),
           [](const fs::path& file) { read_checkpoint(file, kKey, OtherProgram::accept); }},
          {"shape", ".h5", edited(originals(shapes(), write_shape), seal), use_shape},
          {"mesh", ".h5", edited(originals(kept_meshes(), write_mesh), seal),
           [](const fs::path& file) { read_kept_mesh(file, kKey); }}};
}

}  // namespace aussois
