// SPDX-License-Identifier: Apache-2.0
#include "io/html_page.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string_view>
#include <zlib.h>

#include "io/atomic_file.hpp"

namespace aussois {

extern const std::string_view kReplayTemplate[];  // made from viewer/dist/template.html by viewer/embed.cmake
extern const int kReplayTemplatePieces;

namespace {

static_assert(std::endian::native == std::endian::little, "the page reads little-endian arrays");

std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  constexpr int kGzip =
      15 + 16;  // largest window, gzip instead of zlib framing: what DecompressionStream reads
  if (deflateInit2(&stream, 6, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib: deflateInit2 failed");
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = uInt(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = uInt(packed.size());
  const int status = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib: deflate failed");
  return packed;
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string packed(Summary header, const PageArrays& arrays) {
  header.set("arrays", arrays.names());
  std::string json = to_json(header);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::uint32_t length = std::uint32_t(json.size());
  return std::string(reinterpret_cast<const char*>(&length), 4) + json + arrays.bytes();
}

}  // namespace

void write_page(const std::filesystem::path& html, Summary header, const PageArrays& arrays) {
  std::string page;
  for (int i = 0; i < kReplayTemplatePieces; ++i) page += kReplayTemplate[i];
  constexpr std::string_view kMark = "<!--RUN-->";
  const std::size_t mark = page.find(kMark);
  if (mark == std::string::npos) throw std::logic_error("viewer/dist/template.html has no <!--RUN--> mark");
  page.replace(mark, kMark.size(), base64(gzipped(packed(std::move(header), arrays))));
  write_whole_file(html, page);
}

}  // namespace aussois
