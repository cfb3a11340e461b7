// Lists as people keep them in text: one entry a line, '#' comments, blank lines, any line ending.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/base/time.hpp"

namespace povslam {

// Whole content of a regular file into `content` (its capacity is kept between calls). Anything else in its place
// (folder, pipe, dangling or circular link) and a file of more than max_bytes is an error that names the path.
Status read_bytes(const std::filesystem::path& path, std::size_t max_bytes, std::vector<char>& content);

// True for a regular file, links followed; false for everything else, never an exception.
bool is_file(const std::filesystem::path& path);

struct TextLine {
  int number = 0;                       // from 1
  std::vector<std::string_view> words;  // at least one; valid as long as the file
};

class TextFile {
 public:
  static Result<TextFile> read(const std::filesystem::path& path);

  TextFile(TextFile&&) = default;
  TextFile& operator=(TextFile&&) = default;
  TextFile(const TextFile&) = delete;  // the words point into content_
  TextFile& operator=(const TextFile&) = delete;
  ~TextFile() = default;

  const std::vector<TextLine>& lines() const { return lines_; }  // without comments and blank lines
  std::string at(const TextLine& line) const;                    // "path:line: ", to begin a message with

 private:
  TextFile() = default;
  std::filesystem::path path_;
  std::vector<char> content_;
  std::vector<TextLine> lines_;
};

// Decimal seconds -> ns, exact: digits are counted, never rounded through a double (beyond the ninth: cut off).
// Accepts a sign and an exponent ("1.305e+09"). Nothing for anything else, nor beyond 146 years either side of zero, so
// that the difference of any two fits.
std::optional<TimeNs> parse_seconds(std::string_view word);
// ns -> seconds with six digits, or nine where six would lose something. parse_seconds gives the same ns back.
std::string format_seconds(TimeNs time);

std::optional<double> parse_number(std::string_view word);  // finite, whole word

}  // namespace povslam
