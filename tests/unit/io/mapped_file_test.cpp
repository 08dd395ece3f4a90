// SPDX-License-Identifier: Apache-2.0
#include "io/mapped_file.hpp"

#include <algorithm>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

#include "io/atomic_file.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

std::string text_of(const FileBytes& file) {
  return {reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()};
}

std::filesystem::path read_only(const std::filesystem::path& path, const std::string& text) {
  write_bytes(path, text);
  forbid_writing(path);
  return path;
}

}  // namespace

TEST(BytesOfFile, AreMappedUnlessTheFileMayBeWrittenTo) {
  const auto folder = fresh_folder();
  const std::string text = "a file of some length" + std::string(10000, '.');
  const FileBytes fixed = bytes_of_file(read_only(folder / "fixed", text)),
                  open = bytes_of_file(write_bytes(folder / "open", text));
  EXPECT_TRUE(fixed.mapped);
  EXPECT_FALSE(open.mapped);
  EXPECT_EQ(text_of(fixed), text);
  EXPECT_EQ(text_of(open), text);
  for (const FileBytes* file : {&fixed, &open})
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(file->bytes.data()) % 64, 0U);
}

TEST(BytesOfFile, OutliveItsReplacementAndItsRemoval) {
  const auto path = read_only(fresh_folder() / "file", "old");
  const FileBytes old = bytes_of_file(path);
  write_whole_file(path, "new and longer");
  EXPECT_EQ(text_of(old), "old");
  EXPECT_EQ(text_of(bytes_of_file(path)), "new and longer");
  std::filesystem::remove(path);
  EXPECT_EQ(text_of(old), "old");
}

TEST(BytesOfFile, OfACopyDoNotFeelThatTheFileChanges) {
  const auto path = write_bytes(fresh_folder() / "file", "before");
  const FileBytes copy = bytes_of_file(path);
  std::filesystem::resize_file(path, 0);
  EXPECT_EQ(text_of(copy), "before");
}

TEST(BytesOfFile, ComeBackAfterTheirPagesWereDropped) {
  const std::string text(100000, 'x');
  const FileBytes file = bytes_of_file(read_only(fresh_folder() / "file", text));
  drop_pages(file);
  EXPECT_EQ(text_of(file), text);
}

TEST(BytesOfFile, KnowTheirFile) {
  const auto folder = fresh_folder();
  const auto path = read_only(folder / "one", "one"), other = read_only(folder / "two", "two");
  const FileBytes file = bytes_of_file(path);
  const auto is_that_of = [&](const std::filesystem::path& opened) {
    const int descriptor = open(opened.c_str(), O_RDONLY);
    const bool same = is_file(descriptor, file);
    close(descriptor);
    return same;
  };
  EXPECT_TRUE(is_that_of(path));
  EXPECT_FALSE(is_that_of(other));
}

TEST(BytesOfFile, TellWhichFileIsMappedWhere) {
  const auto folder = fresh_folder();
  const std::string text(5000, 'x');
  FileBytes one = bytes_of_file(read_only(folder / "one", text)),
            two = bytes_of_file(read_only(folder / "two", text));
  const std::byte* const place = one.bytes.data();
  EXPECT_EQ(mapped_path_at(place), folder / "one");
  EXPECT_EQ(mapped_path_at(&two.bytes.back()), folder / "two");
  EXPECT_EQ(mapped_path_at(&one), nullptr);
  one = {};
  EXPECT_EQ(mapped_path_at(place), nullptr);
}

TEST(BytesOfFile, TellThatTheirFileWasWritten) {
  using Names = std::vector<std::string>;
  const auto folder = fresh_folder();
  const auto written = read_only(folder / "written", "before"),
             replaced = read_only(folder / "replaced", "before");
  FileBytes first = bytes_of_file(written);
  const FileBytes second = bytes_of_file(replaced);
  write_whole_file(replaced, "after");
  EXPECT_EQ(take_files_changed_while_mapped(), Names());
  using std::filesystem::perms;
  std::filesystem::permissions(written, perms::owner_write, std::filesystem::perm_options::add);
  write_bytes(written, "after, longer");
  EXPECT_EQ(take_files_changed_while_mapped(), Names{written.string()});
  EXPECT_EQ(take_files_changed_while_mapped(), Names());
  write_bytes(written, "again");
  first = {};  // also when it is mapped no more
  EXPECT_EQ(take_files_changed_while_mapped(), Names{written.string()});
}

TEST(BytesOfFile, RefusesWhatIsNoFileByName) {
  const auto folder = fresh_folder();
  const auto message = [](const std::filesystem::path& path) {
    return message_of<std::runtime_error>([&] { bytes_of_file(path); });
  };
  EXPECT_NE(message(folder / "none").find("none: cannot be read: No such file"), std::string::npos);
  EXPECT_NE(message(folder).find("it is no regular file"), std::string::npos);
  EXPECT_TRUE(bytes_of_file(write_bytes(folder / "empty", "")).bytes.empty());
}

}  // namespace aussois
