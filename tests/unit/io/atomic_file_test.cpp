// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_file.hpp"

#include <csignal>
#include <functional>
#include <stdexcept>
#include <unistd.h>

#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include "io/checkpoint.hpp"
#include "io/csv_table.hpp"
#include "io/fclib_file.hpp"
#include "io/mesh_file.hpp"
#include "io/shape_cache.hpp"
#include "tests/unit/io/io_samples.hpp"

namespace aussois {
namespace {

using Names = std::set<std::string>;
using Write = std::function<void(const std::filesystem::path&)>;

/// All that write a file at once; each makes more than 2000 bytes.
const std::vector<std::pair<const char*, Write>>& writers() {
  static const std::vector<std::pair<const char*, Write>> all = {
      {"text", [](const auto& path) { write_whole_file(path, std::string(5000, 'x')); }},
      {"checkpoint", [](const auto& path) { write_checkpoint(path, {}); }},
      {"problem", [](const auto& path) { write_fclib(path, {}); }},
      {"shape", [](const auto& path) { write_lmd_shape(path, {}, 1); }},
      {"mesh",
       [](const auto& path) { write_obj(path, {.vertices = std::vector<Vec3>(500, Vec3(0, 0, 0.1))}, 1); }}};
  return all;
}

/// What a child of this process exits with: 0 if `body` ends, 1 if it throws std::runtime_error.
int exit_of_child(const std::function<void()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      body();
    } catch (const std::runtime_error&) {
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// What this process brought to the disk: the name then, and how many bytes the file had.
std::vector<std::pair<std::string, std::uintmax_t>> synced;

}  // namespace
}  // namespace aussois

// The one of the C library, told.
extern "C" int fsync(int descriptor) {
  std::error_code ignored;
  const auto name = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor), ignored);
  aussois::synced.emplace_back(name.string(), std::filesystem::is_regular_file(name, ignored)
                                                  ? std::filesystem::file_size(name, ignored)
                                                  : 0);
  return int(syscall(SYS_fsync, descriptor));
}

namespace aussois {

// A power cut leaves the old file or the new one: the bytes first, then the name.
TEST(AtomicFile, IsOnTheDiskBeforeItTakesItsPlaceAndItsNameAfter) {
  for (const auto& [name, write] : writers()) {
    const auto folder = std::filesystem::absolute(fresh_folder()), path = folder / "file";
    synced.clear();
    write(path);
    ASSERT_EQ(synced.size(), 2U) << name;
    EXPECT_EQ(synced[0].first.rfind(path.string() + ".", 0), 0U) << name << " / " << synced[0].first;
    EXPECT_EQ(synced[0].second, std::filesystem::file_size(path)) << name;
    EXPECT_EQ(synced[1].first, folder.string()) << name;
  }
}

TEST(AtomicFile, ReplacesTheOldFileAndLeavesNoTemporary) {
  const auto path = fresh_folder() / "file.bin";
  const std::string bytes("a\0\r\n\xff", 5);
  write_whole_file(path, "old and longer than the new one");
  write_whole_file(path, bytes);
  EXPECT_EQ(content_of(path), bytes);
  EXPECT_EQ(names_in(path.parent_path()), Names{"file.bin"});
}

TEST(AtomicFile, NamesThePathWhenItsFolderIsMissing) {
  const auto path = fresh_folder() / "missing" / "file.txt";
  const std::string message = message_of<std::runtime_error>([&] { write_whole_file(path, "x"); });
  EXPECT_NE(message.find(path.string()), std::string::npos) << message;
  EXPECT_NE(message.find("No such file"), std::string::npos) << message;
}

TEST(AtomicFile, LeavesNoTemporaryWhenThePlaceIsTakenByAFolder) {
  for (const auto& [name, write] : writers()) {
    const auto folder = fresh_folder(), path = folder / "taken";
    std::filesystem::create_directories(path / "inside");
    EXPECT_THROW(write(path), std::runtime_error) << name;
    EXPECT_EQ(names_in(folder), Names{"taken"}) << name;
  }
}

// The disk is full after 1000 bytes, as far as this process can see.
TEST(AtomicFile, KeepsTheOldFileAndNoOtherWhenTheDiskIsFull) {
  for (const auto& [name, write] : writers()) {
    const auto folder = fresh_folder(), path = write_bytes(folder / "file", "old");
    EXPECT_EQ(exit_of_child([&, &write = write] {
                std::signal(SIGXFSZ, SIG_IGN);
                const rlimit full{1000, 1000};
                setrlimit(RLIMIT_FSIZE, &full);
                write(path);
              }),
              1)
        << name;
    EXPECT_EQ(content_of(path), "old") << name;
    EXPECT_EQ(names_in(folder), Names{"file"}) << name;
  }
}

// Two writers of one file never see each other's temporary file: while one is at work, the other comes and
// goes.
TEST(AtomicFile, TwoWritersOfOneFileDoNotMeet) {
  const auto folder = fresh_folder(), path = folder / "file.txt";
  write_atomically(path, [&](const std::filesystem::path& mine) {
    write_bytes(mine, "mine");
    write_atomically(path, [&](const std::filesystem::path& other) {
      EXPECT_NE(mine, other);
      write_bytes(other, "other");
    });
    EXPECT_EQ(content_of(mine), "mine");
    EXPECT_EQ(content_of(path), "other");
  });
  EXPECT_EQ(content_of(path), "mine");
  EXPECT_EQ(names_in(folder), Names{"file.txt"});
}

// Files that grow with a run: a second run is refused in the same folder, whichever of the two is a new one.
TEST(AtomicFile, AGrowingFileHasOneWriter) {
  const auto folder = fresh_folder();
  const auto begin = [&] { CsvTable(folder / "steps.csv", {"a"}); };
  const auto resume = [&] { CsvTable::resume(folder / "steps.csv", {"a"}, 0); };
  const auto begin_run = [&] { RunWriter(folder / "run.h5", peg_header()); };
  const auto resume_run = [&] { RunWriter::resume(folder / "run.h5", 0); };
  {
    CsvTable table(folder / "steps.csv", {"a"});
    RunWriter run(folder / "run.h5", peg_header());
    table.add({1});
    for (const std::function<void()>& other :
         {std::function<void()>(begin), {resume}, {begin_run}, {resume_run}}) {
      EXPECT_EQ(exit_of_child(other), 1);
      const std::string message = message_of<std::runtime_error>(other);
      EXPECT_NE(message.find(".tmp: another run is writing it"), std::string::npos) << message;
    }
    table.close();
    run.append(peg_step(0, 1));
    run.close();
  }
  EXPECT_EQ(content_of(folder / "steps.csv"), "a\n1\n");
  EXPECT_EQ(read_run(folder / "run.h5").steps.size(), 1U);
  begin();  // what a killed run left is taken away, or gone on with
  begin();
  EXPECT_EQ(exit_of_child(resume), 0);
  begin_run();
  begin_run();
  EXPECT_EQ(exit_of_child(resume_run), 0);
}

}  // namespace aussois
