// SPDX-License-Identifier: Apache-2.0
// One input, one file, one reader: the one that the environment variable AUSSOIS_FUZZ names.
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "tests/fuzz/readers.hpp"

namespace aussois {
namespace {

namespace fs = std::filesystem;

/// In memory where the system has it: a thousand files a second.
class Folder {
 public:
  Folder() {
    std::string name = fs::is_directory("/dev/shm")
                           ? "/dev/shm/aussois-fuzz-XXXXXX"
                           : (fs::temp_directory_path() / "aussois-fuzz-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be created");
    path = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path path{};
};

FuzzedReader chosen() {
  const char* name = std::getenv("AUSSOIS_FUZZ");
  std::string known;
  for (const auto& list : {text_readers(), hdf5_readers(), driver_readers()})
    for (const FuzzedReader& reader : list) {
      if (name != nullptr && reader.name == name) return reader;
      known += " " + reader.name;
    }
  std::fprintf(stderr, "set AUSSOIS_FUZZ to one of%s\n", known.c_str());
  std::exit(2);
}

}  // namespace

bool is_accepted(Bytes input) {
  static const FuzzedReader reader = chosen();
  static const Folder folder;
  const fs::path file = folder.path / ("input" + reader.extension);
  reader.make(file, input);
  try {
    reader.read(file);
  } catch (const std::runtime_error&) {
    return false;
  }
  return true;
}

}  // namespace aussois

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it so
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  aussois::is_accepted({data, size});
  return 0;
}
