// SPDX-License-Identifier: Apache-2.0
#include "station/live_page.hpp"

namespace aussois {

// Each a list of pieces, by station/CMakeLists.txt.
extern const std::string_view kLiveHtml[], kLiveCss[], kLiveJs[], kLiveWorker[];
extern const int kLiveHtmlPieces, kLiveCssPieces, kLiveJsPieces, kLiveWorkerPieces;

namespace {

std::string whole(const std::string_view* pieces, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += pieces[i];
  return out;
}

}  // namespace

const std::vector<LiveAsset>& live_assets() {
  static const std::vector<LiveAsset> all{
      {"/", "text/html; charset=utf-8", whole(kLiveHtml, kLiveHtmlPieces)},
      {"/live.css", "text/css; charset=utf-8", whole(kLiveCss, kLiveCssPieces)},
      {"/live.js", "text/javascript; charset=utf-8", whole(kLiveJs, kLiveJsPieces)},
      {"/live_worker.js", "text/javascript; charset=utf-8", whole(kLiveWorker, kLiveWorkerPieces)}};
  return all;
}

}  // namespace aussois
