// SPDX-License-Identifier: Apache-2.0
#include "bench/assembly_pairs.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "geometry/check.hpp"

namespace aussois {
namespace {

constexpr const char* kBuiltin = "bolt_nut";

}  // namespace

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> out;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, ',');) out.push_back(word);
  return out;
}

std::vector<std::string> pair_names(const std::filesystem::path& data, const std::string& list) {
  require(list.empty() || list == kBuiltin || !data.empty(),
          "--pair needs --data, the folder with meshes/ and assembly/");
  if (!list.empty()) return words_of(list);
  if (data.empty()) return {kBuiltin};
  const std::filesystem::path table = data / "assembly" / "pairs.csv";
  std::ifstream in(table);
  std::vector<std::string> names;
  std::string line;
  std::getline(in, line);  // the names of the columns
  while (std::getline(in, line)) names.push_back(line.substr(0, line.find(',')));
  if (names.empty()) throw std::runtime_error(table.string() + ": no pairs could be read");
  return names;
}

AssemblyInput read_pair(const std::filesystem::path& data, const std::string& name, double scale) {
  return data.empty() || name == kBuiltin ? builtin_assembly(name) : read_assembly_pair(data, name, scale);
}

}  // namespace aussois
