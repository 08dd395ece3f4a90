// SPDX-License-Identifier: Apache-2.0
#include "io/checkpoint.hpp"

#include <cstring>
#include <limits>
#include <stdexcept>

#include "io/build_info.hpp"
#include "io/hdf5_file.hpp"
#include "tests/unit/io/io_samples.hpp"

namespace aussois {
namespace {

bool same_bits(const double* a, const double* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof *a) == 0;
}

/// Numbers that a careless format loses: -0.0, subnormal, largest, one unit in the last place.
Checkpoint nasty_checkpoint() {
  Checkpoint checkpoint;
  checkpoint.fingerprint = 0xfedcba9876543210u;
  checkpoint.step = std::int64_t{1} << 40;
  State& state = checkpoint.state;
  state.t = 0.1 + 0.2;
  state.h = 5e-324;
  state.h_next = -0.0;
  state.g = {{Quat(0.5, -0.5, 0.5, -0.5), Vec3(-0.0, 1e-310, 1.7976931348623157e308)},
             {Quat(1, -0.0, 0, 1e-17), Vec3(1.0 / 3, -2.0 / 3, 1 + 2.220446049250313e-16)}};
  state.v = VecX::LinSpaced(12, -1.0 / 7, 1.0 / 3);
  state.v[3] = -0.0;
  state.q = Vec3(-0.0, 1.0 / 3, 1e-310);
  state.turns = {-3, 0, 1 << 20};
  state.r = Vec2(0.1, -5e-324);
  state.a = Vec3(-0.0, 0.1 + 0.2, -1e300);
  state.u = Vec3(1 / 3.0, -0.0, 1e-300);
  for (int i = 0; i < 3; ++i)
    state.memory.contacts.push_back({.key = {BodyId::at(i), 1, 0xfedcba9876543210u + unsigned(i)},
                                     .normal = Vec3(0.6, -0.0, 0.8),
                                     .point_a = Vec3(i, 1e-320, 0.1),
                                     .point_b = Vec3(0.1 + 0.2, -0.0, i),
                                     .impulse = Vec3(-0.0, 1.0 / 3, i),
                                     .drilling = 0.1 * i,
                                     .anchor_b = Vec3(-1e-310, i, 1.0 / 7),
                                     .held = i == 1,
                                     .solved = i != 1});
  checkpoint.numbers = {
      {"peak_force", 12.345}, {"least", -std::numeric_limits<double>::denorm_min()}, {"none", kInf}};
  checkpoint.counts = {{"rows", 12345678901}, {"refused", 0}};
  return checkpoint;
}

}  // namespace

TEST(Checkpoint, GivesTheStateBackBitForBit) {
  const auto path = fresh_folder() / "checkpoint.h5";
  const Checkpoint written = nasty_checkpoint();
  write_checkpoint(path, written);
  EXPECT_EQ(names_in(path.parent_path()), std::set<std::string>{"checkpoint.h5"});
  const Checkpoint back = read_checkpoint(path, written.fingerprint);

  EXPECT_EQ(back.fingerprint, written.fingerprint);
  EXPECT_EQ(back.step, written.step);
  EXPECT_EQ(back.counts, written.counts);
  ASSERT_EQ(back.numbers.size(), written.numbers.size());
  for (const auto& [name, value] : written.numbers)
    EXPECT_TRUE(same_bits(&back.numbers.at(name), &value, 1)) << name;

  const State &a = back.state, &b = written.state;
  EXPECT_TRUE(same_bits(&a.t, &b.t, 1) && same_bits(&a.h, &b.h, 1) && same_bits(&a.h_next, &b.h_next, 1));
  ASSERT_EQ(a.g.size(), b.g.size());
  for (std::size_t i = 0; i < b.g.size(); ++i)
    EXPECT_TRUE(same_bits(a.g[BodyId::at(i)].p.data(), b.g[BodyId::at(i)].p.data(), 3) &&
                same_bits(a.g[BodyId::at(i)].R.coeffs().data(), b.g[BodyId::at(i)].R.coeffs().data(), 4));
  ASSERT_EQ(a.v.size(), b.v.size());
  EXPECT_TRUE(same_bits(a.v.data(), b.v.data(), 12));
  ASSERT_TRUE(a.q.size() == 3 && a.r.size() == 2);
  EXPECT_TRUE(same_bits(a.q.data(), b.q.data(), 3) && same_bits(a.r.data(), b.r.data(), 2));
  ASSERT_EQ(a.a.size(), 3);
  EXPECT_TRUE(same_bits(a.a.data(), b.a.data(), 3));
  ASSERT_EQ(b.u.size(), 3);
  EXPECT_TRUE(same_bits(a.u.data(), b.u.data(), 3));
  EXPECT_EQ(a.turns, b.turns);
  ASSERT_EQ(a.memory.contacts.size(), b.memory.contacts.size());
  for (std::size_t i = 0; i < b.memory.contacts.size(); ++i) {
    const RememberedContact &x = a.memory.contacts[i], &y = b.memory.contacts[i];
    EXPECT_TRUE(x.key == y.key);
    EXPECT_TRUE(same_bits(x.normal.data(), y.normal.data(), 3) &&
                same_bits(x.point_a.data(), y.point_a.data(), 3) &&
                same_bits(x.impulse.data(), y.impulse.data(), 3) && same_bits(&x.drilling, &y.drilling, 1));
    EXPECT_TRUE(same_bits(x.point_b.data(), y.point_b.data(), 3) &&
                same_bits(x.anchor_b.data(), y.anchor_b.data(), 3) && x.held == y.held &&
                x.solved == y.solved);
  }
}

TEST(Checkpoint, OfAnEmptyStateIsFine) {
  const auto path = fresh_folder() / "checkpoint.h5";
  write_checkpoint(path, {});
  const Checkpoint back = read_checkpoint(path, 0);
  EXPECT_TRUE(back.state.g.empty() && back.state.memory.contacts.empty() && back.numbers.empty() &&
              back.counts.empty());
  EXPECT_EQ(back.state.v.size(), 0);
}

TEST(Checkpoint, OfAnotherModelIsRefusedNamingBothFingerprints) {
  const auto path = fresh_folder() / "checkpoint.h5";
  write_checkpoint(path, nasty_checkpoint());
  const std::string message = message_of<std::runtime_error>([&] { read_checkpoint(path, 1); });
  EXPECT_NE(message.find("0xfedcba9876543210"), std::string::npos) << message;
  EXPECT_NE(message.find("0x0000000000000001"), std::string::npos) << message;
}

TEST(Checkpoint, TruncatedAnywhereIsAnErrorThatNamesTheFile) {
  const auto folder = fresh_folder();
  write_checkpoint(folder / "whole.h5", nasty_checkpoint());
  const std::string whole = content_of(folder / "whole.h5");
  for (int part = 0; part < 20; ++part) {
    write_bytes(folder / "cut.h5", whole.substr(0, whole.size() * std::size_t(part) / 20));
    const std::string message =
        message_of<std::runtime_error>([&] { read_checkpoint(folder / "cut.h5", 0xfedcba9876543210u); });
    EXPECT_NE(message.find("cut.h5: not an HDF5 file, truncated or damaged"), std::string::npos)
        << part << message;
  }
  EXPECT_NE(message_of<std::runtime_error>([&] {
              read_checkpoint(folder / "none.h5", 0);
            }).find("none.h5: no such file"),
            std::string::npos);
}

TEST(Checkpoint, WithAnotherNumberInsideIsDamaged) {
  const auto path = fresh_folder() / "checkpoint.h5";
  const Checkpoint checkpoint = nasty_checkpoint();
  write_checkpoint(path, checkpoint);
  {
    const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
    Hdf5Column t = Hdf5Column::open(file, "/state/t", H5T_NATIVE_DOUBLE, {});
    t.truncate(0);
    const double other = std::nextafter(checkpoint.state.t, 1);
    t.append(&other, 1);
  }
  const std::string message =
      message_of<std::runtime_error>([&] { read_checkpoint(path, checkpoint.fingerprint); });
  EXPECT_NE(message.find("/state/hash: is not the hash of the state"), std::string::npos) << message;
}

TEST(Checkpoint, OfAnotherProgramIsRefusedNamingBothAndTheWayOn) {
  const auto path = fresh_folder() / "checkpoint.h5";
  Checkpoint checkpoint = nasty_checkpoint();
  write_checkpoint(path, checkpoint);
  EXPECT_EQ(read_checkpoint(path, checkpoint.fingerprint).program, program_version());
  checkpoint.program = "aussois 0.0.9, program 0123456789abcdef";
  write_checkpoint(path, checkpoint);
  const std::string message =
      message_of<std::runtime_error>([&] { read_checkpoint(path, checkpoint.fingerprint); });
  EXPECT_NE(message.find("checkpoint.h5: /@program: "), std::string::npos) << message;
  for (const std::string& part : {checkpoint.program, program_version(), std::string("--resume-anyway")})
    EXPECT_NE(message.find(part), std::string::npos) << part << " / " << message;
  const Checkpoint back = read_checkpoint(path, checkpoint.fingerprint, OtherProgram::accept);
  EXPECT_EQ(back.program, checkpoint.program);
  EXPECT_EQ(back.step, checkpoint.step);
  EXPECT_THROW(read_checkpoint(path, 1, OtherProgram::accept),
               std::runtime_error);  // other options stay refused
}

TEST(Checkpoint, NamesTheEntryThatItsProgramLeftOut) {
  Checkpoint checkpoint = nasty_checkpoint();
  checkpoint.program = "aussois 0.0.9";
  EXPECT_EQ(checkpoint_number(checkpoint, "peak_force"), 12.345);
  EXPECT_EQ(checkpoint_count(checkpoint, "rows"), 12345678901);
  for (const auto& message : {message_of<std::runtime_error>([&] { checkpoint_number(checkpoint, "rows"); }),
                              message_of<std::runtime_error>([&] { checkpoint_count(checkpoint, "rows "); })})
    EXPECT_NE(message.find("is missing; it was written by aussois 0.0.9"), std::string::npos) << message;
}

TEST(ProgramVersion, IsTheVersionAndTheBytesOfThisProgram) {
  const std::string version = program_version();
  EXPECT_EQ(version.rfind("aussois ", 0), 0U) << version;
  EXPECT_EQ(build_info().rfind(version.substr(0, version.find(',')), 0), 0U) << version;
  EXPECT_NE(program_digest(), 0U);
  char digest[24];
  std::snprintf(digest, sizeof digest, "%016llx", static_cast<unsigned long long>(program_digest()));
  EXPECT_NE(version.find(digest), std::string::npos) << version;
}

TEST(Checkpoint, FingerprintsDifferByOneCharacter) {
  EXPECT_EQ(fingerprint_of(""), 0xcbf29ce484222325u);   // the offset basis of FNV-1a
  EXPECT_EQ(fingerprint_of("a"), 0xaf63dc4c8601ec8cu);  // its published test vector
  EXPECT_NE(fingerprint_of("--mu 0.3\n"), fingerprint_of("--mu 0.4\n"));
}

}  // namespace aussois
