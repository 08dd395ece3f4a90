// SPDX-License-Identifier: Apache-2.0
#include "io/csv_table.hpp"

#include <bit>
#include <charconv>
#include <limits>
#include <random>
#include <stdexcept>

#include "io/atomic_file.hpp"
#include "tests/support/random.hpp"
#include "tests/unit/io/io_samples.hpp"

namespace aussois {

TEST(CsvTable, IsThePlainTextOneExpects) {
  const auto path = fresh_folder() / "table.csv";
  CsvTable table(path, {"step", "t [s]", "gap"});
  table.add({0, 0.1, -1e-6});
  table.add({1, 0.30000000000000004, std::numeric_limits<double>::infinity()});
  EXPECT_FALSE(std::filesystem::exists(path)) << "the table must not appear before it is complete";
  table.close();
  EXPECT_EQ(content_of(path), "step,t [s],gap\n0,0.1,-1e-06\n1,0.30000000000000004,inf\n");
  EXPECT_FALSE(std::filesystem::exists(growing_name(path)));
}

TEST(CsvTable, ReadsBackAsTheSameBits) {
  const std::uint64_t seed = 20250101;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random random(seed);
  std::vector<double> values = {-0.0, 5e-324, 1.7976931348623157e308, 0.1};
  while (values.size() < 2000) {
    const std::uint64_t bits = random.bits();
    const auto value = std::bit_cast<double>(bits);
    if (std::isfinite(value)) values.push_back(value);
  }
  const auto path = fresh_folder() / "table.csv";
  CsvTable table(path, {"x"});
  for (const double value : values) table.add({value});
  table.close();
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  for (const double value : values) {
    ASSERT_TRUE(std::getline(file, line));
    double back = 0;
    std::from_chars(line.data(), line.data() + line.size(), back);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(value)) << line;
  }
}

TEST(CsvTable, ResumedIsTheSameAsNeverInterrupted) {
  const auto folder = fresh_folder();
  {
    CsvTable table(folder / "whole.csv", {"k", "k2"});
    for (int k = 0; k < 10; ++k) table.add({double(k), double(k * k)});
    table.close();
  }
  {
    CsvTable table(folder / "parts.csv", {"k", "k2"});
    for (int k = 0; k < 7; ++k) table.add({double(k), double(k * k)});
  }                                                                           // interrupted: no close
  std::ofstream(growing_name(folder / "parts.csv"), std::ios::app) << "7,4";  // and half a line
  CsvTable table = CsvTable::resume(folder / "parts.csv", {"k", "k2"}, 5);
  EXPECT_EQ(table.rows(), 5u);
  for (int k = 5; k < 10; ++k) table.add({double(k), double(k * k)});
  table.close();
  EXPECT_EQ(content_of(folder / "parts.csv"), content_of(folder / "whole.csv"));
}

TEST(CsvTable, RefusesToResumeWhatDoesNotFit) {
  const auto path = fresh_folder() / "table.csv";
  EXPECT_THROW(CsvTable::resume(path, {"a"}, 0), std::runtime_error);
  { CsvTable(path, {"a", "b"}).add({1, 2}); }
  std::ofstream(growing_name(path), std::ios::app) << "3,4";  // a row without its line end is not whole
  EXPECT_NE(message_of<std::runtime_error>([&] {
              CsvTable::resume(path, {"a", "b"}, 2);
            }).find("has 1 whole rows, 2"),
            std::string::npos);
  EXPECT_NE(message_of<std::runtime_error>([&] {
              CsvTable::resume(path, {"a", "c"}, 1);
            }).find("'a,b', not 'a,c'"),
            std::string::npos);
}

TEST(CsvTable, NamesWhatIsWrongAtTheDoor) {
  const auto folder = fresh_folder();
  EXPECT_THROW(CsvTable(folder / "t.csv", {}), std::invalid_argument);
  EXPECT_THROW(CsvTable(folder / "t.csv", {"a,b"}), std::invalid_argument);
  EXPECT_THROW(CsvTable(folder / "no" / "t.csv", {"a"}), std::runtime_error);
  CsvTable table(folder / "t.csv", {"a", "b"});
  EXPECT_THROW(table.add({1}), std::invalid_argument);
  table.close();
  EXPECT_THROW(table.add({1, 2}), std::runtime_error);
}

}  // namespace aussois
