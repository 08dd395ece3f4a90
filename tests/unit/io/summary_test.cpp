// SPDX-License-Identifier: Apache-2.0
#include "io/summary.hpp"

#include <cstring>
#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "tests/unit/io/io_samples.hpp"

namespace aussois {

TEST(Summary, KeepsTheOrderAndReplacesInPlace) {
  Summary summary;
  summary.set("pair", "own_tslot");
  summary.set("steps", 12);
  summary.set("ok", false);
  summary.set("min_gap", -1.5e-7);
  summary.set("ok", true);
  EXPECT_EQ(to_json(summary),
            "{\n  \"pair\": \"own_tslot\",\n  \"steps\": 12,\n  \"ok\": true,\n  \"min_gap\": -1.5e-07\n}\n");
}

TEST(Summary, GivesDoublesBackBitForBit) {
  const std::vector<double> values = {
      0.1, 1.0 / 3, -0.0, 5e-324, 2.2250738585072011e-308, 1.7976931348623157e308};
  Summary summary;
  summary.set("values", values);
  const auto back = nlohmann::json::parse(to_json(summary))["values"].get<std::vector<double>>();
  ASSERT_EQ(back.size(), values.size());
  EXPECT_EQ(std::memcmp(back.data(), values.data(), values.size() * sizeof(double)), 0);
}

TEST(Summary, WritesNullWhereANumberIsNotFinite) {
  Summary summary;
  summary.set("min_gap", std::numeric_limits<double>::infinity());
  summary.set("list", std::vector<double>{1, std::nan("")});
  const auto json = nlohmann::json::parse(to_json(summary));
  EXPECT_TRUE(json["min_gap"].is_null());
  EXPECT_TRUE(json["list"][1].is_null());
  EXPECT_EQ(json["list"][0], 1.0);
}

TEST(Summary, SurvivesQuotesAndBytesThatAreNoText) {
  Summary summary;
  summary.set("a \"key\"", "tab\t and \xff");
  EXPECT_EQ(nlohmann::json::parse(to_json(summary))["a \"key\""], "tab\t and \xEF\xBF\xBD");
  EXPECT_THROW(summary.set("", 1), std::invalid_argument);
}

TEST(Summary, IsWrittenAsAFile) {
  const auto path = fresh_folder() / "summary.json";
  Summary summary;
  summary.set("names", std::vector<std::string>{"a", "b"});
  summary.set("counts", std::vector<std::int64_t>{1, 2});
  write_summary(path, summary);
  EXPECT_EQ(content_of(path), to_json(summary));
  EXPECT_THROW(write_summary(path / "below_a_file", summary), std::runtime_error);
}

}  // namespace aussois
