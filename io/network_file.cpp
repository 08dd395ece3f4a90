// SPDX-License-Identifier: Apache-2.0
#include "io/network_file.hpp"

#include <charconv>
#include <cmath>
#include <string>

#include "io/atomic_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

constexpr const char* kNetworkFormat = "aussois_network";
constexpr int kNetworkVersion = 1;
constexpr std::int64_t kMostUnits = 10000;  // of a layer

void append_hexadecimal(std::string& text, double value) {
  char digits[40];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::hex);
  text.append(" ").append(digits, end);
}

// One line per row.
void append(std::string& text, const char* name, const MatX& rows) {
  text += name;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    for (Eigen::Index j = 0; j < rows.cols(); ++j) append_hexadecimal(text, rows(i, j));
    text += "\n";
  }
}

std::string text_of(const Network& n) {
  std::string text = std::string(kNetworkFormat) + " " + std::to_string(kNetworkVersion) + "\ninputs " +
                     std::to_string(n.inputs()) + "\nhidden " + std::to_string(n.hidden()) + "\noutputs " +
                     std::to_string(n.outputs()) + "\n";
  append(text, "mean", n.mean.transpose());
  append(text, "scale", n.scale.transpose());
  append(text, "W1", n.W1);
  append(text, "b1", n.b1.transpose());
  append(text, "W2", n.W2);
  append(text, "b2", n.b2.transpose());
  return text;
}

class NetworkReader {
 public:
  explicit NetworkReader(const std::filesystem::path& path) : text_(read_file(path)), reader_(path, text_) {}

  void word(const char* wanted) {
    const std::string_view token = reader_.token();
    if (token != wanted) reader_.fail(quoted(token) + " must be " + wanted);
  }
  Eigen::Index size(const char* name) {
    word(name);
    const std::int64_t value = reader_.integer(reader_.token(), name);
    if (value < 1 || value > kMostUnits)
      reader_.fail(std::string(name) + " = " + std::to_string(value) + " must lie in [1, " +
                   std::to_string(kMostUnits) + "]");
    return Eigen::Index(value);
  }
  MatX rows(const char* name, Eigen::Index rows, Eigen::Index columns) {
    word(name);
    const std::size_t numbers = std::size_t(rows * columns), bytes = text_.size() - reader_.position();
    if (numbers > bytes / 2)  // a blank and a digit each: no memory is asked for what cannot follow
      reader_.fail(std::string(name) + " needs " + std::to_string(numbers) + " numbers, " +
                   std::to_string(bytes) + " bytes follow");
    MatX out(rows, columns);
    for (Eigen::Index i = 0; i < rows; ++i)
      for (Eigen::Index j = 0; j < columns; ++j) out(i, j) = hexadecimal(name);
    return out;
  }
  /// Nothing but blanks is left.
  bool at_end() const { return text_.find_first_not_of(" \t\r\n", reader_.position()) == std::string::npos; }
  const TextReader& reader() const { return reader_; }

 private:
  double hexadecimal(const char* name) {
    const std::string_view token = reader_.token();
    double value = 0;
    const auto [end, error] =
        std::from_chars(token.data(), token.data() + token.size(), value, std::chars_format::hex);
    if (error != std::errc() || end != token.data() + token.size() || !std::isfinite(value))
      reader_.fail(std::string(name) + " = " + quoted(token) + " must be a finite hexadecimal number");
    return value;
  }

  std::string text_;
  TextReader reader_;
};

// Without places if the file ends before them.
LearnedSelector read(NetworkReader& in) {
  in.word(kNetworkFormat);
  in.word(std::to_string(kNetworkVersion).c_str());
  const Eigen::Index inputs = in.size("inputs"), hidden = in.size("hidden"), outputs = in.size("outputs");
  LearnedSelector out;
  Network& n = out.network;
  n.mean = in.rows("mean", 1, inputs).transpose();
  n.scale = in.rows("scale", 1, inputs).transpose();
  if (!(n.scale.minCoeff() > 0)) in.reader().fail("scale must be positive");
  n.W1 = in.rows("W1", hidden, inputs);
  n.b1 = in.rows("b1", 1, hidden).transpose();
  n.W2 = in.rows("W2", outputs, hidden);
  n.b2 = in.rows("b2", 1, outputs).transpose();
  if (in.at_end()) return out;
  out.keep = int(in.size("keep"));
  const MatX places = in.rows("places", outputs, 3);
  for (Eigen::Index i = 0; i < outputs; ++i) out.places.push_back(places.row(i).transpose());
  if (!in.at_end()) in.reader().fail("data follows the last place");
  return out;
}

}  // namespace

void write_network(const std::filesystem::path& path, const Network& network) {
  validate(network);
  write_whole_file(path, text_of(network));
}

void write_selector(const std::filesystem::path& path, const LearnedSelector& selector) {
  validate(selector);
  std::string text = text_of(selector.network) + "keep " + std::to_string(selector.keep) + "\n";
  MatX places(selector.places.size(), 3);
  for (std::size_t i = 0; i < selector.places.size(); ++i)
    places.row(Eigen::Index(i)) = selector.places[i].transpose();
  append(text, "places", places);
  write_whole_file(path, text);
}

Network read_network(const std::filesystem::path& path) {
  NetworkReader in(path);
  return read(in).network;
}

LearnedSelector read_selector(const std::filesystem::path& path) {
  NetworkReader in(path);
  LearnedSelector selector = read(in);
  if (selector.places.empty()) in.reader().fail("the file ends before keep and places");
  return selector;
}

}  // namespace aussois
