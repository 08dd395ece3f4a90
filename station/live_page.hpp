// SPDX-License-Identifier: Apache-2.0
// What a station sends to browsers, compiled in. Private to station.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace aussois {

struct LiveAsset {
  std::string_view path{}, type{};
  std::string content{};
};
/// Built from station/page.
const std::vector<LiveAsset>& live_assets();

}  // namespace aussois
