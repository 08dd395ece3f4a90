// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_file.hpp"

#include <stdexcept>

#include "tests/unit/io/io_samples.hpp"

namespace aussois {

TEST(AtomicFile, ReplacesTheOldFileAndLeavesNoTemporary) {
  const auto path = fresh_folder() / "file.bin";
  const std::string bytes("a\0\r\n\xff", 5);
  write_whole_file(path, "old and longer than the new one");
  write_whole_file(path, bytes);
  EXPECT_EQ(content_of(path), bytes);
  EXPECT_FALSE(std::filesystem::exists(temporary_name(path)));
}

TEST(AtomicFile, NamesThePathWhenItsFolderIsMissing) {
  const auto path = fresh_folder() / "missing" / "file.txt";
  const std::string message = message_of<std::runtime_error>([&] { write_whole_file(path, "x"); });
  EXPECT_NE(message.find(path.string()), std::string::npos) << message;
  EXPECT_NE(message.find("No such file"), std::string::npos) << message;
}

TEST(AtomicFile, LeavesNoTemporaryWhenThePlaceIsTakenByAFolder) {
  const auto path = fresh_folder() / "taken";
  std::filesystem::create_directories(path / "inside");
  EXPECT_THROW(write_whole_file(path, "x"), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(temporary_name(path)));
}

TEST(AtomicFile, KeepsTheOldFileWhenTheNewOneCannotBeWritten) {
  const auto path = fresh_folder() / "file.txt";
  write_whole_file(path, "old");
  std::filesystem::create_directories(temporary_name(path));  // the temporary name is taken by a folder
  EXPECT_THROW(write_whole_file(path, "new"), std::runtime_error);
  EXPECT_EQ(content_of(path), "old");
}

}  // namespace aussois
