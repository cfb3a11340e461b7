#include "drivers/replay/text_file.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <system_error>

namespace povslam {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTextBytes = std::size_t{256} << 20;
constexpr int kNsDigits = 9;

std::vector<std::string_view> split_words(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\f\v";
  std::vector<std::string_view> words;
  for (std::size_t begin = text.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kBlanks, end);
  }
  return words;
}

// The digits of a decimal number without its point, and how many of them stand before the point.
struct Decimal {
  bool negative = false;
  std::string digits;
  int before_point = 0;
};

std::optional<Decimal> parse_decimal(std::string_view word) {
  Decimal decimal;
  std::size_t i = 0;
  if (i < word.size() && (word[i] == '-' || word[i] == '+')) decimal.negative = word[i++] == '-';
  bool point = false;
  for (; i < word.size() && word[i] != 'e' && word[i] != 'E'; ++i) {
    if (word[i] == '.' && !point) {
      point = true;
    } else if (word[i] >= '0' && word[i] <= '9') {
      decimal.digits += word[i];
      if (!point) ++decimal.before_point;
    } else {
      return std::nullopt;
    }
  }
  if (decimal.digits.empty()) return std::nullopt;
  if (i == word.size()) return decimal;
  std::string_view exponent_word = word.substr(i + 1);
  if (exponent_word.starts_with('+')) exponent_word.remove_prefix(1);
  int exponent = 0;
  const auto [end, fault] = std::from_chars(exponent_word.begin(), exponent_word.end(), exponent);
  if (fault != std::errc{} || end != exponent_word.end() || std::abs(exponent) > 400) return std::nullopt;
  decimal.before_point += exponent;
  return decimal;
}

}  // namespace

bool is_file(const fs::path& path) {
  std::error_code fault;
  return fs::is_regular_file(path, fault);
}

Status read_bytes(const fs::path& path, std::size_t max_bytes, std::vector<char>& content) {
  content.clear();
  std::error_code fault;
  const fs::file_status status = fs::status(path, fault);
  if (status.type() == fs::file_type::not_found) return Error{path.string() + ": no such file"};
  if (fault) return Error{path.string() + ": " + fault.message()};
  if (status.type() != fs::file_type::regular) return Error{path.string() + ": not a regular file"};
  const std::uintmax_t size = fs::file_size(path, fault);
  if (fault) return Error{path.string() + ": " + fault.message()};
  if (size > max_bytes) {
    return Error{path.string() + ": " + std::to_string(size) + " bytes, at most " + std::to_string(max_bytes) +
                 " are read"};
  }
  std::ifstream stream(path, std::ios::binary);
  content.resize(static_cast<std::size_t>(size));
  if (!stream || !stream.read(content.data(), static_cast<std::streamsize>(size))) {
    content.clear();
    return Error{path.string() + ": cannot be read"};
  }
  return Done{};
}

Result<TextFile> TextFile::read(const fs::path& path) {
  TextFile file;
  file.path_ = path;
  if (const Status status = read_bytes(path, kMaxTextBytes, file.content_); !status) return status.error();
  std::string_view rest(file.content_.data(), file.content_.size());
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest.starts_with(kByteOrderMark)) rest.remove_prefix(kByteOrderMark.size());
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::vector<std::string_view> words = split_words(rest.substr(0, end));
    if (!words.empty() && !words.front().starts_with('#')) file.lines_.push_back({number, std::move(words)});
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return file;
}

std::string TextFile::at(const TextLine& line) const {
  return path_.string() + ":" + std::to_string(line.number) + ": ";
}

std::optional<TimeNs> parse_seconds(std::string_view word) {
  const std::optional<Decimal> decimal = parse_decimal(word);
  if (!decimal) return std::nullopt;
  constexpr TimeNs kMax = std::numeric_limits<TimeNs>::max() / 2;
  TimeNs time = 0;
  const int num_digits = decimal->before_point + kNsDigits;  // of the whole number of nanoseconds
  for (int i = 0; i < num_digits; ++i) {
    const std::size_t index = static_cast<std::size_t>(i);
    const int digit = index < decimal->digits.size() ? decimal->digits[index] - '0' : 0;
    if (time > (kMax - digit) / 10) return std::nullopt;
    time = time * 10 + digit;
  }
  return decimal->negative ? -time : time;
}

std::string format_seconds(TimeNs time) {
  const std::uint64_t magnitude = time < 0 ? 0 - static_cast<std::uint64_t>(time) : static_cast<std::uint64_t>(time);
  const std::uint64_t seconds = magnitude / kNsPerSecond;
  const std::uint64_t fraction = magnitude % kNsPerSecond;
  const bool six_digits = fraction % kNsPerUs == 0;
  char text[40];
  std::snprintf(text, sizeof text, "%s%llu.%0*llu", time < 0 ? "-" : "", static_cast<unsigned long long>(seconds),
                six_digits ? 6 : kNsDigits,
                static_cast<unsigned long long>(six_digits ? fraction / kNsPerUs : fraction));
  return text;
}

std::optional<double> parse_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double number = 0.0;
  const auto [end, fault] = std::from_chars(word.begin(), word.end(), number);
  if (fault != std::errc{} || end != word.end() || !std::isfinite(number)) return std::nullopt;
  return number;
}

}  // namespace povslam
