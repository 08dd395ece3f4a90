// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <stdexcept>

#include "io/atomic_file.hpp"
#include "io/hdf5_file.hpp"
#include "tests/support/leaks_of_hdf5.hpp"
#include "tests/support/little_memory.hpp"
#include "tests/unit/io/io_samples.hpp"

namespace aussois {
namespace {

void write_run(const std::filesystem::path& path, const RunData& run) {
  RunWriter writer(path, run.header);
  for (const RunStep& step : run.steps) writer.append(step);
  writer.close();
}

bool same(const SE3& a, const SE3& b) {
  return a.p == b.p && a.R.coeffs() == b.R.coeffs();
}

void expect_same(const RunContact& a, const RunContact& b) {
  EXPECT_EQ(a.pair, b.pair);
  EXPECT_EQ(a.feature, b.feature);
  EXPECT_EQ(a.point, b.point);
  EXPECT_EQ(a.point_b, b.point_b);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.impulse, b.impulse);
  EXPECT_EQ(a.gap, b.gap);
}

void expect_same(const RunJoint& a, const RunJoint& b) {
  EXPECT_EQ(a.coordinate, b.coordinate);
  EXPECT_EQ(a.speed, b.speed);
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.torque, b.torque);
  EXPECT_EQ(a.effort, b.effort);
  EXPECT_EQ(a.translation_error, b.translation_error);
  EXPECT_EQ(a.rotation_error, b.rotation_error);
  const auto work = [](const RunJoint& j) {
    return std::vector<double>{j.work_locked, j.work_couplings, j.work_stops,   j.work_friction,
                               j.work_motors, j.work_springs,   j.work_supports};
  };
  EXPECT_EQ(work(a), work(b));
}

void expect_same(const RunStep& a, const RunStep& b) {
  SCOPED_TRACE("step " + std::to_string(b.step));
  ASSERT_EQ(a.pose.size(), b.pose.size());
  for (std::size_t i = 0; i < a.pose.size(); ++i) EXPECT_TRUE(same(a.pose[i], b.pose[i]));
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.q_speed, b.q_speed);
  ASSERT_EQ(a.gauges.size(), b.gauges.size());
  for (Eigen::Index i = 0; i < a.gauges.size(); ++i)
    EXPECT_TRUE(a.gauges[i] == b.gauges[i] || (std::isnan(a.gauges[i]) && std::isnan(b.gauges[i])));
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t i = 0; i < a.joints.size(); ++i) expect_same(a.joints[i], b.joints[i]);
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t i = 0; i < a.contacts.size(); ++i) expect_same(a.contacts[i], b.contacts[i]);
  EXPECT_EQ(a.coupling_force, b.coupling_force);
  EXPECT_EQ(a.coupling_torque, b.coupling_torque);
  const auto counts = [](const RunStep& s) {
    return std::vector<std::int64_t>{s.step,
                                     s.status,
                                     s.attempts,
                                     s.contacts_found,
                                     s.contacts_kept,
                                     s.contacts_matched,
                                     s.certificate_rounds,
                                     s.solver_status,
                                     s.iterations,
                                     s.local_failures,
                                     s.local_fail_safes,
                                     s.matched_by_key,
                                     s.matched_by_adjacency,
                                     s.matched_by_geometry,
                                     s.unmatched,
                                     s.inherited};
  };
  EXPECT_EQ(counts(a), counts(b));
  const auto numbers = [](const RunStep& s) {
    return std::vector<double>{s.time,
                               s.h,
                               s.threshold,
                               s.min_gap,
                               s.min_base_distance,
                               s.residual,
                               s.kinetic,
                               s.gravity,
                               s.laws,
                               s.gravity_work,
                               s.law_work,
                               s.contact_work,
                               s.gyroscopic_work,
                               s.joint_work,
                               s.joint_time,
                               s.numerical_work,
                               s.energy_residual,
                               s.impulse_gain,
                               s.seconds_contact,
                               s.seconds_solve,
                               s.seconds_certificate,
                               s.seconds_total};
  };
  EXPECT_EQ(numbers(a), numbers(b));
}

void expect_same(const RunHeader& a, const RunHeader& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.command_line, b.command_line);
  EXPECT_EQ(a.build, b.build);
  EXPECT_EQ(a.notes, b.notes);
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (const auto& [name, mesh] : b.meshes) {
    ASSERT_EQ(a.meshes.count(name), 1u);
    EXPECT_EQ(a.meshes.at(name).vertices, mesh.vertices);
    EXPECT_EQ(a.meshes.at(name).faces, mesh.faces);
    EXPECT_EQ(a.meshes.at(name).wires, mesh.wires);
  }
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    EXPECT_EQ(a.bodies[i].name, b.bodies[i].name);
    EXPECT_EQ(a.bodies[i].mesh, b.bodies[i].mesh);
    EXPECT_TRUE(same(a.bodies[i].g_bs, b.bodies[i].g_bs));
    EXPECT_EQ(a.bodies[i].fixed, b.bodies[i].fixed);
    EXPECT_EQ(a.bodies[i].dilation, b.bodies[i].dilation);
    EXPECT_EQ(a.bodies[i].mass, b.bodies[i].mass);
    EXPECT_EQ(a.bodies[i].inertia, b.bodies[i].inertia);
  }
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t i = 0; i < a.joints.size(); ++i) {
    EXPECT_EQ(a.joints[i].name, b.joints[i].name);
    EXPECT_EQ(a.joints[i].kind, b.joints[i].kind);
    EXPECT_EQ(a.joints[i].pair, b.joints[i].pair);
  }
  EXPECT_EQ(a.gauges, b.gauges);
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (std::size_t i = 0; i < a.blocks.size(); ++i) {
    EXPECT_EQ(a.blocks[i].name, b.blocks[i].name);
    EXPECT_EQ(a.blocks[i].size, b.blocks[i].size);
  }
}

void expect_same(const RunData& a, const RunData& b) {
  expect_same(a.header, b.header);
  ASSERT_EQ(a.steps.size(), b.steps.size());
  for (std::size_t k = 0; k < a.steps.size(); ++k) expect_same(a.steps[k], b.steps[k]);
}

/// Every dataset of a file by name: its type, shape and stored values as bytes.
std::map<std::string, std::string> datasets_of(const std::filesystem::path& path) {
  std::map<std::string, std::string> found;
  const Hdf5Id file = open_hdf5(path, Hdf5Access::read);
  const auto collect = [](hid_t root, const char* name, const H5O_info_t* info, void* all) -> herr_t {
    if (info->type != H5O_TYPE_DATASET) return 0;
    const Hdf5Id data(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose), type(H5Dget_type(data), H5Tclose);
    const Hdf5Id space(H5Dget_space(data), H5Sclose);
    const std::size_t size = H5Tget_size(type);
    std::string bytes(size * std::size_t(H5Sget_simple_extent_npoints(space)), '\0');
    H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
    hsize_t shape[8]{};
    const int rank = H5Sget_simple_extent_dims(space, shape, nullptr);
    std::string key = std::to_string(H5Tget_class(type)) + ":" + std::to_string(size);
    for (int i = 0; i < rank; ++i) key += "," + std::to_string(shape[i]);
    (*static_cast<std::map<std::string, std::string>*>(all))[name] = key + "|" + bytes;
    return 0;
  };
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, collect, &found, H5O_INFO_BASIC);
  return found;
}

}  // namespace

TEST(RunFile, GivesBackEverythingThatWasWritten) {
  const auto path = fresh_folder() / "run.h5";
  RunData run = peg_run(150);  // two whole blocks and a part
  run.header.meshes["cable"] = {{Vec3(0, 0, 0), Vec3(1, 0, 0)}, {}, {{0, 1}}};
  run.header.bodies.push_back(
      {"frame without shape", "", translation(1, 2, 3), false, 0, 2.5, Mat3::Identity()});
  for (RunStep& step : run.steps) {
    step.pose.push_back(rotation(Vec3(1, 2, 3), 0.4));
    step.velocity = VecX::LinSpaced(18, -1, 1);
  }
  write_run(path, run);
  EXPECT_FALSE(std::filesystem::exists(growing_name(path)));
  expect_same(read_run(path), run);
}

TEST(RunFile, AppearsOnlyWhenComplete) {
  const auto path = fresh_folder() / "run.h5";
  RunWriter writer(path, peg_header());
  writer.append(peg_step(0, 10));
  EXPECT_FALSE(std::filesystem::exists(path));
  writer.close();
  EXPECT_TRUE(std::filesystem::exists(path));
  EXPECT_THROW(writer.append(peg_step(1, 10)), std::invalid_argument);
}

TEST(RunFile, OfARunWithoutStepsOrBodiesIsReadable) {
  const auto folder = fresh_folder();
  write_run(folder / "no_steps.h5", {peg_header(), {}});
  EXPECT_TRUE(read_run(folder / "no_steps.h5").steps.empty());
  RunData empty;
  empty.steps.resize(3);
  for (int k = 0; k < 3; ++k) empty.steps[k].step = k;
  write_run(folder / "no_bodies.h5", empty);
  EXPECT_EQ(read_run(folder / "no_bodies.h5").steps.size(), 3u);
}

// What is resumed at any step, early or late, inside a block or at its end, has the datasets of the
// uninterrupted run.
class ResumedRunFile : public ::testing::TestWithParam<int> {};
TEST_P(ResumedRunFile, HasTheSameDataAsOneThatWasNeverInterrupted) {
  const auto folder = fresh_folder();
  const RunData run = peg_run(200);
  write_run(folder / "whole.h5", run);
  const int checkpoint = GetParam(), killed = std::min(199, checkpoint + 37);
  {
    RunWriter writer(folder / "parts.h5", run.header);
    for (int k = 0; k < checkpoint; ++k) writer.append(run.steps[k]);
    writer.flush();
    for (int k = checkpoint; k < killed; ++k) {
      RunStep lost = run.steps[k];  // what the killed process wrote after its checkpoint, and must not stay
      lost.kinetic = 1e9;
      if (!lost.contacts.empty()) lost.contacts.pop_back();
      writer.append(lost);
    }
  }
  RunWriter writer = RunWriter::resume(folder / "parts.h5", std::size_t(checkpoint));
  EXPECT_EQ(writer.rows(), std::size_t(checkpoint));
  for (int k = checkpoint; k < 200; ++k) writer.append(run.steps[k]);
  writer.close();
  const auto whole = datasets_of(folder / "whole.h5"), parts = datasets_of(folder / "parts.h5");
  // The layout of doc/run_file.md: 2 x 3 mesh, 10 body, 3 joint, 2 coordinates, 1 gauge; 58 of steps, 8 of
  // contacts.
  EXPECT_EQ(whole.size(), 89u);
  EXPECT_TRUE(whole == parts);
}
INSTANTIATE_TEST_SUITE_P(Steps, ResumedRunFile, ::testing::Values(0, 1, 63, 64, 65, 100, 128, 199));

TEST(RunFile, RefusesToResumeWhatIsNotThereOrTooShort) {
  const auto path = fresh_folder() / "run.h5";
  EXPECT_NE(
      message_of<std::runtime_error>([&] { RunWriter::resume(path, 0); }).find("run.h5.tmp: no such file"),
      std::string::npos);
  {
    RunWriter writer(path, peg_header());
    for (int k = 0; k < 5; ++k) writer.append(peg_step(k, 10));
  }
  const std::string message = message_of<std::runtime_error>([&] { RunWriter::resume(path, 6); });
  EXPECT_NE(message.find("7 are needed to resume"), std::string::npos) << message;
}

TEST(RunFile, RefusesStepsThatDoNotFit) {
  RunWriter writer(fresh_folder() / "run.h5", peg_header());
  const RunStep good = peg_step(5, 10);
  writer.append(good);
  EXPECT_THROW(writer.append(good), std::invalid_argument) << "the step number must ascend";
  RunStep bad = peg_step(6, 10);
  bad.pose.pop_back();
  EXPECT_THROW(writer.append(bad), std::invalid_argument);
  bad = peg_step(6, 10);
  bad.time = std::nan("");
  EXPECT_THROW(writer.append(bad), std::invalid_argument);
  bad = peg_step(6, 10);
  bad.joints.pop_back();
  EXPECT_EQ(message_of<std::invalid_argument>([&] { writer.append(bad); }),
            "RunStep::joints: size = 1 must be the number of joints");
  bad = peg_step(6, 10);
  bad.q_speed.conservativeResize(2);
  EXPECT_EQ(message_of<std::invalid_argument>([&] { writer.append(bad); }),
            "RunStep::q, q_speed: size = 2 must be the sum of the sizes of the blocks");
  bad = peg_step(10, 10);
  bad.contacts.resize(1);
  bad.contacts[0].pair = {0, 2};
  const std::string message = message_of<std::invalid_argument>([&] { writer.append(bad); });
  EXPECT_EQ(message, "RunContact::pair = 2 must be the index of a body");
  EXPECT_EQ(writer.rows(), 1u);
}

TEST(RunFile, RefusesHeadersThatDoNotFit) {
  const auto path = fresh_folder() / "run.h5";
  RunHeader header = peg_header();
  header.bodies[1].mesh = "pegg";
  EXPECT_THROW(RunWriter(path, header), std::invalid_argument);
  header = peg_header();
  header.meshes["a/b"] = {};
  EXPECT_THROW(RunWriter(path, header), std::invalid_argument);
  header = peg_header();
  header.joints[1].pair = {1, 2};
  EXPECT_EQ(message_of<std::invalid_argument>([&] { RunWriter(path, header); }),
            "RunHeader: joint clamp: body 2 must lie in [-1, 2)");
  header = peg_header();
  header.blocks[0].size = 0;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { RunWriter(path, header); }),
            "RunHeader: block spring: size = 0 must be at least 1");
  header = peg_header();
  header.meshes["peg"].faces[3][1] = 999;
  const std::string message = message_of<std::invalid_argument>([&] { RunWriter(path, header); });
  EXPECT_EQ(message, "RunHeader: mesh peg, face 3: vertex 999 must lie in [0, 256)");
  EXPECT_FALSE(std::filesystem::exists(growing_name(path)));
}

TEST(RunFile, MayLackTheWorkOfJoints) {
  const auto path = fresh_folder() / "run.h5";
  RunData run = peg_run(10);
  write_run(path, run);
  {
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    for (const char* name : {"time", "work_locked", "work_couplings", "work_stops", "work_friction",
                             "work_motors", "work_springs", "work_supports"})
      ASSERT_GE(H5Ldelete(file, (std::string("/joint/") + name).c_str(), H5P_DEFAULT), 0) << name;
  }
  for (RunStep& step : run.steps) {
    step.joint_time = 0;
    for (RunJoint& j : step.joints)
      j.work_locked = j.work_couplings = j.work_stops = j.work_friction = j.work_motors = j.work_springs =
          j.work_supports = 0;
  }
  expect_same(read_run(path), run);
}

TEST(RunFile, MayLackFieldsOfBodies) {
  const auto path = fresh_folder() / "run.h5";
  const RunData run = peg_run(10);
  write_run(path, run);
  {
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    for (const char* name : {"/body/field", "/body/field_unit"})
      ASSERT_GE(H5Ldelete(file, name, H5P_DEFAULT), 0) << name;
  }
  expect_same(read_run(path), run);
}

TEST(RunFile, MayLackGauges) {
  const auto path = fresh_folder() / "run.h5";
  RunData run = peg_run(10);
  write_run(path, run);
  {
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    for (const char* name : {"/gauge/name", "/gauge/value"}) H5Ldelete(file, name, H5P_DEFAULT);
  }
  run.header.gauges.clear();
  for (RunStep& step : run.steps) step.gauges.resize(0);
  expect_same(read_run(path), run);
}

TEST(RunFile, SaysWhatIsWrongWithAFile) {
  const auto folder = fresh_folder();
  const auto wrong = [&](const char* name) {
    return message_of<std::runtime_error>([&] { read_run(folder / name); });
  };
  EXPECT_NE(wrong("missing.h5").find("missing.h5: no such file"), std::string::npos);
  write_bytes(folder / "text.h5", "this is no HDF5 file");
  EXPECT_NE(wrong("text.h5").find("text.h5: not an HDF5 file"), std::string::npos);

  write_run(folder / "run.h5", peg_run(100));
  const std::string whole = content_of(folder / "run.h5");
  write_bytes(folder / "half.h5", whole.substr(0, whole.size() / 2));
  EXPECT_NE(wrong("half.h5").find("truncated"), std::string::npos);

  {
    const Hdf5Id file = create_hdf5(folder / "foreign.h5");
    write_rows(file, "/x", std::vector<double>{1});
  }
  EXPECT_NE(wrong("foreign.h5").find("/@format: is not 'aussois-run'"), std::string::npos);

  std::filesystem::copy(folder / "run.h5", folder / "old.h5");
  {
    const Hdf5Id file = open_hdf5(folder / "old.h5", Hdf5Access::write);
    H5Adelete(file, "version");
    write_text(file, "/", "version", "2");
  }
  EXPECT_NE(wrong("old.h5").find("/@version: is 2, this program reads version 3"), std::string::npos);

  std::filesystem::copy(folder / "run.h5", folder / "lacking.h5");
  {
    const Hdf5Id file = open_hdf5(folder / "lacking.h5", Hdf5Access::write);
    H5Ldelete(file, "/contact/gap", H5P_DEFAULT);
  }
  EXPECT_NE(wrong("lacking.h5").find("lacking.h5: /contact/gap: is missing"), std::string::npos);

  std::filesystem::copy(folder / "run.h5", folder / "wide.h5");
  {
    const Hdf5Id file = open_hdf5(folder / "wide.h5", Hdf5Access::write);
    H5Ldelete(file, "/contact/normal", H5P_DEFAULT);
    const hsize_t shape[] = {250, 3}, most[] = {H5S_UNLIMITED, H5S_UNLIMITED}, chunk[] = {1024, 16643};
    const Hdf5Id space(H5Screate_simple(2, shape, most), H5Sclose);
    const Hdf5Id layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(layout, 2, chunk);
    const Hdf5Id data(
        H5Dcreate2(file, "/contact/normal", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, layout, H5P_DEFAULT),
        H5Dclose);
    ASSERT_GE(data, 0);
  }
  EXPECT_NE(wrong("wide.h5").find("/contact/normal: has chunks that are wider than its rows"),
            std::string::npos);

  std::filesystem::copy(folder / "run.h5", folder / "uneven.h5");
  {
    const Hdf5Id file = open_hdf5(folder / "uneven.h5", Hdf5Access::write);
    Hdf5Column::open(file, "/solver/residual", H5T_NATIVE_DOUBLE, {}).truncate(99);
  }
  EXPECT_NE(wrong("uneven.h5").find("/solver/residual: has 99 rows instead of 100"), std::string::npos);
}

// Forty kilobytes of zeros that announce four million steps, three gigabytes of rows that nothing fills.
TEST(RunFile, AsksForNoMemoryThatItsBytesDoNotFill) {
  const auto path = fresh_folder() / "run.h5";
  write_run(path, peg_run(5));
  {
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    H5Ldelete(file, "/contact/offset", H5P_DEFAULT);
    std::vector<std::uint64_t> offset(4000001, 0);
    offset.back() = 10;  // contacts, as there are
    write_rows(file, "/contact/offset", offset);
  }
  const std::string message = message_with_little_memory([&] { read_run(path); });
  EXPECT_NE(message.find("/state/time: has 5 rows instead of 4000000"), std::string::npos) << message;
}

// Damage in the layout of columns: chunks of 2^28 rows, two gigabytes, of which HDF5 would make one to read
// it.
TEST(RunFile, AsksForNoChunkThatItsBytesDoNotFill) {
  const auto path = fresh_folder() / "run.h5";
  write_run(path, peg_run(5));
  std::string bytes = content_of(path);
  const std::string rows_and_size("\100\0\0\0\10\0\0\0", 8);  // 64 rows of 8 bytes
  int layouts = 0;
  for (std::size_t at = bytes.find(rows_and_size); at != std::string::npos;
       at = bytes.find(rows_and_size, at + 1))
    if (at > 11 && bytes.substr(at - 11, 3) == "\3\2\2") {  // version, chunked, rank + 1; then an address
      bytes.replace(at, 4, std::string("\0\0\0\20", 4));
      ++layouts;
    }
  EXPECT_GT(layouts, 10);
  write_bytes(path, bytes);
  const std::string message = message_with_little_memory([&] { read_run(path); });
  EXPECT_NE(message.find("has chunks of 2147483648 bytes, more than its bytes can hold"), std::string::npos)
      << message;
}

// Offsets that leave the contacts and come back: no step may take what is behind them.
TEST(RunFile, RefusesOffsetsThatDescendBeforeItReadsThem) {
  const auto path = fresh_folder() / "run.h5";
  write_run(path, peg_run(5));
  {
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    H5Ldelete(file, "/contact/offset", H5P_DEFAULT);
    write_rows(file, "/contact/offset", std::vector<std::uint64_t>{0, 1u << 30, 2, 3, 4, 10});
  }
  EXPECT_EQ(message_with_little_memory([&] { read_run(path); }),
            path.string() + ": /contact/offset: does not ascend at row 1");
}

// An attribute of many texts is longer than one of them.
TEST(RunFile, RefusesATitleOfManyTexts) {
  const auto path = fresh_folder() / "run.h5";
  write_run(path, peg_run(5));
  {
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    H5Adelete(file, "title");
    const hsize_t texts = 1000;
    const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate_simple(1, &texts, nullptr), H5Sclose);
    H5Tset_size(type, 32);
    const Hdf5Id title(H5Acreate2(file, "title", type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    ASSERT_GE(H5Awrite(title, type, std::string(32000, 'x').data()), 0);
  }
  EXPECT_NE(
      message_of<std::runtime_error>([&] { read_run(path); }).find("/@title: is not one text of 32 bytes"),
      std::string::npos);
}

// Any single wrong byte may be harmless or an error, but never a crash (run under the sanitizers). HDF5 1.10
// itself loses a few kilobytes over some damaged files and then says "infinite loop closing library" as the
// process ends.
TEST(RunFile, NeverCrashesOnADamagedFile) {
  const LeaksOfHdf5 leaks_of_hdf5;
  const auto folder = fresh_folder();
  write_run(folder / "run.h5", peg_run(20));
  const std::string whole = content_of(folder / "run.h5");
  int refused = 0;
  const std::size_t tries = 300;
  for (std::size_t i = 0; i < tries; ++i) {
    std::string damaged = whole;
    damaged[i * whole.size() / tries] ^= char(0x41);
    write_bytes(folder / "damaged.h5", damaged);
    refused += !message_of<std::runtime_error>([&] { read_run(folder / "damaged.h5"); }).empty();
  }
  EXPECT_GT(refused, 10);
}

// The reader of doc/run_file.md, cut out of the page and run as it stands.
TEST(RunFile, IsReadByThePythonExampleOfItsPage) {
  std::string python;
  for (const char* candidate : {"python3", "/usr/bin/python3"})
    if (python.empty() &&
        std::system((std::string(candidate) + " -c 'import h5py' 2>/dev/null").c_str()) == 0)
      python = candidate;
  if (python.empty()) GTEST_SKIP() << "no python3 with h5py";
  const std::string page = content_of(std::string(AUSSOIS_SOURCE_DIR) + "/doc/run_file.md");
  const std::size_t begin = page.find("```python\n"), end = page.find("```", begin + 10);
  ASSERT_NE(begin, std::string::npos);
  const auto folder = fresh_folder();
  write_bytes(folder / "example.py", page.substr(begin + 10, end - begin - 10));
  write_run(folder / "run.h5", peg_run(100));
  const std::string output = (folder / "output.txt").string();
  ASSERT_EQ(std::system((python + " " + (folder / "example.py").string() + " " +
                         (folder / "run.h5").string() + " > " + output + " 2>&1")
                            .c_str()),
            0)
      << content_of(output);
  // peg_run by hand: 100 rows, k % 6 contacts each; the deepest contact of any row has gap -1e-6 (i = 0).
  EXPECT_EQ(content_of(output),
            "100 steps, 2 bodies (bush, peg), 246 contacts, smallest gap -1.00e-06 m\n"
            "step 98: 2 contacts, largest normal force 6.84 N between bush and peg\n");
}

}  // namespace aussois
