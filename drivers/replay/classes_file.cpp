#include "drivers/replay/classes_file.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "drivers/replay/text_file.hpp"

namespace povslam {

namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxName = 64;
constexpr const char* kKinds[] = {"ignore", "structure", "static_object", "semi_static", "dynamic"};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\"";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

struct Columns {
  std::optional<std::size_t> id, name, kind, movable;

  std::size_t last() const { return std::max({id.value_or(0), name.value_or(0), kind.value_or(movable.value_or(0))}); }
};

Result<Columns> read_header(const std::vector<std::string_view>& cells, const std::string& at) {
  Columns columns;
  const auto find = [&cells](std::string_view name) -> std::optional<std::size_t> {
    const auto it = std::find(cells.begin(), cells.end(), name);
    if (it == cells.end()) return std::nullopt;
    return static_cast<std::size_t>(it - cells.begin());
  };
  columns = {find("id"), find("name"), find("kind"), find("movable")};
  if (columns.id && columns.name && (columns.kind || columns.movable)) return columns;
  return Error{at + "expected the header line 'id,name,kind'"};
}

std::optional<std::string> kind_in(const std::vector<std::string_view>& cells, const Columns& columns) {
  const std::string_view text = cells[columns.kind ? *columns.kind : *columns.movable];
  if (!columns.kind) {
    if (text == "0") return "structure";
    if (text == "1") return "semi_static";
    return std::nullopt;
  }
  if (std::find(std::begin(kKinds), std::end(kKinds), text) == std::end(kKinds)) return std::nullopt;
  return std::string(text);
}

Result<LabelClass> read_row(const std::vector<std::string_view>& cells, const Columns& columns, const std::string& at) {
  if (cells.size() <= columns.last()) return Error{at + "fewer columns than the header has"};
  LabelClass row;
  const std::string_view id = cells[*columns.id];
  std::uint8_t value = 0;
  const auto [end, fault] = std::from_chars(id.data(), id.data() + id.size(), value);
  if (fault != std::errc{} || end != id.data() + id.size()) {
    return Error{at + "id: expected an integer from 0 to 255, got '" + std::string(id) + "'"};
  }
  row.id = value;
  row.name = cells[*columns.name];
  if (row.name.empty() || row.name.size() > kMaxName) return Error{at + "name: expected text of 1 to 64 letters"};
  const std::optional<std::string> kind = kind_in(cells, columns);
  if (!kind && !columns.kind) return Error{at + "movable: expected 0 or 1"};
  if (!kind) {
    return Error{at + "kind: expected one of ignore, structure, static_object, semi_static, dynamic, got '" +
                 std::string(cells[*columns.kind]) + "'"};
  }
  row.kind = *kind;
  return row;
}

}  // namespace

Result<LabelTable> read_classes_file(const std::filesystem::path& path) {
  std::vector<char> content;
  if (const Status status = read_bytes(path, kMaxBytes, content); !status) return status.error();
  std::string_view rest(content.data(), content.size());
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest.starts_with(kByteOrderMark)) rest.remove_prefix(kByteOrderMark.size());
  LabelTable table{path.string(), {}};
  std::optional<Columns> columns;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty() || line.starts_with('#')) continue;
    const std::string where = path.string() + ":" + std::to_string(number);
    if (!columns) {
      const Result<Columns> header = read_header(split(line), where + ": ");
      if (!header) return header.error();
      columns = *header;
      continue;
    }
    Result<LabelClass> row = read_row(split(line), *columns, where + ": ");
    if (!row) return row.error();
    row->where = where;
    table.classes.push_back(std::move(*row));
  }
  if (table.classes.empty()) return Error{path.string() + ": no class; expected lines 'id,name,kind'"};
  return table;
}

}  // namespace povslam
