// SPDX-License-Identifier: Apache-2.0
#include "io/pose_file.hpp"

#include <random>

#include <gtest/gtest.h>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

PoseFile read_text(const std::string& content, double scale = 1) {
  const auto folder = fresh_folder();
  return read_poses(write_bytes(folder / "a.csv", content), scale);
}

TEST(ReadPoses, FindsColumnsByNameInAnyOrder) {
  const PoseFile poses = read_text(
      "# own path\nqz, qy,qx,qw ,remark,z,y,x,t\r\n0,0,0,1,start,3,2,1,0.5\n\n0,1,0,0,end,6,5,4,0.75\n",
      1e-3);
  ASSERT_EQ(poses.pose.size(), 2u);
  EXPECT_EQ(poses.t, (std::vector{0.5, 0.75}));
  EXPECT_EQ(poses.pose[0].p, Vec3(1e-3, 2e-3, 3e-3));
  EXPECT_EQ(poses.pose[0].R.coeffs(), Quat(1, 0, 0, 0).coeffs());
  EXPECT_EQ(poses.pose[1].R.coeffs(), Quat(0, 0, 1, 0).coeffs()) << "qy";
}

TEST(ReadPoses, GivesNoTimesWhereThereAreNone) {
  EXPECT_TRUE(read_text("index,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n").t.empty());
}

TEST(ReadPoses, NormalisesWhatIsUnitToSixDigits) {
  const PoseFile poses =
      read_text("x,y,z,qw,qx,qy,qz\n0,0,0,0.7071068,0.7071068,0,0\n0,0,0,1.0000009,0,0,0\n");
  EXPECT_NEAR(poses.pose[0].R.norm(), 1, 1e-15);
  EXPECT_NEAR(poses.pose[0].R.x(), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(poses.pose[1].R.w(), 1);
}

TEST(ReadPoses, StayOnOneHemisphere) {
  std::string text = "x,y,z,qw,qx,qy,qz\n";
  for (int i = 0; i < 40; ++i) {  // one and a half turns about z, every third row with the other sign
    const double half = 1.5 * kPi * i / 39, sign = i % 3 ? 1 : -1;
    char row[128];
    std::snprintf(row, sizeof row, "0,0,0,%.17g,0,0,%.17g\n", sign * std::cos(half), sign * std::sin(half));
    text += row;
  }
  const PoseFile poses = read_text(text);
  for (std::size_t i = 1; i < poses.pose.size(); ++i) {
    const Quat &a = poses.pose[i - 1].R, &b = poses.pose[i].R;
    EXPECT_NEAR(a.dot(b), std::cos(1.5 * kPi / 39), 1e-14) << i;
  }
}

TEST(WritePoses, ReadBackAsTheSameRotationsAndBits) {
  Random random(3);
  PoseFile poses;
  for (int i = 0; i < 100; ++i) {
    SE3 g;
    for (int k = 0; k < 3; ++k) g.p[k] = random.uniform(-1, 1);
    for (int k = 0; k < 4; ++k) g.R.coeffs()[k] = random.uniform(-1, 1);
    g.R.normalize();
    if (i > 0 && g.R.dot(poses.pose.back().R) < 0) g.R.coeffs() *= -1;
    poses.pose.push_back(g);
    poses.t.push_back(0.1 * i);
  }
  const auto folder = fresh_folder();
  write_poses(folder / "a.csv", poses, 1);
  const PoseFile back = read_poses(folder / "a.csv", 1);
  ASSERT_EQ(back.pose.size(), poses.pose.size());
  EXPECT_EQ(back.t, poses.t);
  for (std::size_t i = 0; i < back.pose.size(); ++i) {
    EXPECT_EQ(back.pose[i].p, poses.pose[i].p);
    // Normalising once more may move the last digit.
    EXPECT_LT((back.pose[i].R.coeffs() - poses.pose[i].R.coeffs()).norm(), 4e-16);
  }
  poses.t.pop_back();
  EXPECT_THROW(write_poses(folder / "b.csv", poses, 1), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.csv"));
}

TEST(ReadPoses, RefusesAScaleThatIsNone) {
  for (const double scale : {0.0, -1.0, std::nan(""), kInf})
    EXPECT_THROW(read_text("x,y,z,qw,qx,qy,qz\n", scale), std::invalid_argument);
}

struct Broken {
  const char* file = "";
  const char* message = "";
};

std::ostream& operator<<(std::ostream& out, const Broken& broken) {
  return out << broken.file;
}

class BrokenPoses : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenPoses, EndWithOneClearMessage) {
  const auto path = std::filesystem::path(AUSSOIS_SOURCE_DIR) / "tests/data/broken" / GetParam().file;
  EXPECT_EQ(message_of<std::runtime_error>([&] { read_poses(path, 1); }), path.string() + GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Files, BrokenPoses,
    ::testing::Values(
        Broken{"double_column.csv", ":1: column 'x' must occur once in the header, occurs 2 times"},
        Broken{"empty.csv", ": is empty"}, Broken{"empty_field.csv", ":3: y = '' must be a number"},
        Broken{"header_only.csv", ":1: rows = 0 must be at least 2 for a path"},
        Broken{"missing_column.csv", ":1: column 'qw' must occur once in the header, occurs 0 times"},
        Broken{"nan.csv", ":3: y = nan must be finite"},
        Broken{"non_unit_quaternion.csv",
               ":3: |(qw, qx, qy, qz)| = 1.004987562112089 must lie within 1e-6 of 1"},
        Broken{"one_row.csv", ":2: rows = 1 must be at least 2 for a path"},
        Broken{"times_not_ascending.csv", ":4: t = 0.5 must be > the time of the row before"},
        Broken{"too_few_columns.csv", ":3: fields = 7 must be 8, as in the header"},
        Broken{"too_many_columns.csv", ":3: fields = 9 must be 8, as in the header"},
        Broken{"word.csv", ":3: y = 'up' must be a number"},
        Broken{"zero_quaternion.csv", ":3: |(qw, qx, qy, qz)| = 0 must lie within 1e-6 of 1"},
        Broken{"does_not_exist.csv", ": no such file"}),
    [](const auto& broken) {
      std::string name = broken.param.file;
      return name.substr(0, name.find('.'));
    });

std::string npy(const std::string& header, const std::vector<double>& values) {
  std::string text = header;
  text.resize(117, ' ');
  text += '\n';
  std::string out = std::string("\x93NUMPY\1\0", 8) + char(118) + '\0' + text;
  return out.append(reinterpret_cast<const char*>(values.data()), 8 * values.size());
}
const std::vector<double> kTwo{1, 2, 3, 1, 0, 0, 0, 4, 5, 6, 0, 1, 0, 0};
const std::string kHeader = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 7), }";

TEST(ReadPoses, ReadsWhatPlannersAndNumPyWrite) {
  const std::filesystem::path folder = fresh_folder();
  const PoseFile plain =
      read_poses(write_bytes(folder / "a.path", "1 2 3 0 0 0 1\n\n 4  5\t6 1 0 0 0 \n"), 0.5);
  const PoseFile numpy = read_poses(write_bytes(folder / "a.npy", npy(kHeader, kTwo)), 0.5);
  for (const PoseFile& read : {plain, numpy}) {
    ASSERT_EQ(read.pose.size(), 2u);
    EXPECT_TRUE(read.t.empty());
    EXPECT_EQ(read.pose[1].p, Vec3(2, 2.5, 3));
    EXPECT_EQ(read.pose[0].R.w(), 1);
    EXPECT_EQ(std::abs(read.pose[1].R.x()), 1);
  }
}

TEST(ReadPoses, RefusesBrokenFilesOfPlanners) {
  const std::filesystem::path folder = fresh_folder();
  const auto told = [&](const char* name, const std::string& bytes) {
    const std::filesystem::path path = write_bytes(folder / name, bytes);
    return message_of<std::runtime_error>([&] { (void)read_poses(path, 1); });
  };
  expect_names(told("short.path", "1 2 3 0 0 0 1\n1 2 3 0 0 0\n"), ":2: fields = 6 must be 7");
  expect_names(told("word.path", "1 2 3 0 0 0 1\n1 2 up 0 0 0 1\n"), ":2: z = 'up'");
  expect_names(told("none.npy", "x"), ":1: is no NPY file");
  const std::string good = npy(kHeader, kTwo);
  expect_names(told("cut.npy", good.substr(0, 60)), "header is cut off");
  expect_names(told("half.npy", good.substr(0, good.size() - 8)), "must have the shape (poses, 7)");
  expect_names(told("single.npy", npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 7), }", kTwo)),
               "'<f8'");
  expect_names(told("fortran.npy", npy("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 7), }", kTwo)),
               "row by row");
  expect_names(told("nan.npy", npy(kHeader, {1, 2, kInf, 1, 0, 0, 0, 4, 5, 6, 0, 1, 0, 0})),
               ":1: z = inf must be finite");
}

TEST(ReadPoses, ReadsEveryPathOfTheSharedData) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) GTEST_SKIP() << "set AUSSOIS_DATA_DIR to the folder with the shared data";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(data) / "assembly")) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".csv" || name == "pairs.csv" || name == "clearance.csv") continue;
    EXPECT_GE(read_poses(entry.path(), 1e-3).pose.size(), 40u) << name;
    ++files;
  }
  EXPECT_EQ(files, 18);
}

}  // namespace
}  // namespace aussois
