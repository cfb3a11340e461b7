#include "daemon/config_file_classes.hpp"

#include <toml++/toml.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "daemon/class_presets.hpp"
#include "daemon/config_class_keys.hpp"
#include "daemon/config_file_assign.hpp"

namespace povslam {

namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxTableName = 64;

std::optional<ClassKind> kind_of(const std::string& name) {
  static const std::map<std::string, ClassKind> kKinds = {{"ignore", ClassKind::ignore},
                                                          {"structure", ClassKind::structure},
                                                          {"static_object", ClassKind::static_object},
                                                          {"semi_static", ClassKind::semi_static},
                                                          {"dynamic", ClassKind::dynamic}};
  const auto it = kKinds.find(name);
  return it == kKinds.end() ? std::nullopt : std::optional(it->second);
}

ClassEntry entry_of(const ObjectClass& row, const ClassEntry& read) {
  ClassEntry entry = read;
  entry.prior_alpha = row.prior_alpha;
  entry.prior_beta = row.prior_beta;
  entry.k_inlier = row.k_inlier;
  entry.k_outlier = row.k_outlier;
  entry.min_extent_m = row.min_extent_m;
  entry.max_extent_m = row.max_extent_m;
  entry.one_piece = row.one_piece;
  for (std::size_t i = 0; i < 3; ++i) entry.rgb[i] = row.rgb[i];
  return entry;
}

ObjectClass class_of(const ClassEntry& entry, ObjectClass row) {
  row.prior_alpha = entry.prior_alpha;
  row.prior_beta = entry.prior_beta;
  row.k_inlier = entry.k_inlier;
  row.k_outlier = entry.k_outlier;
  row.min_extent_m = entry.min_extent_m;
  row.max_extent_m = entry.max_extent_m;
  row.one_piece = entry.one_piece;
  for (std::size_t i = 0; i < 3; ++i) row.rgb[i] = static_cast<std::uint8_t>(std::lround(entry.rgb[i]));
  return row;
}

// Collects rows and refuses what contradicts the rows before.
class TableMaker {
 public:
  explicit TableMaker(std::string name) { table_.name = std::move(name); }

  Status add(ObjectClass row, const std::string& place) {
    if (const auto [it, fresh] = ids_.try_emplace(row.id, place); !fresh) {
      return Error{place + ": id: " + std::to_string(row.id) + " is taken already, see " + it->second};
    }
    if (const auto [it, fresh] = names_.try_emplace(row.name, place); !fresh) {
      return Error{place + ": name: \"" + row.name + "\" is taken already, see " + it->second};
    }
    if (row.id == 0 && row.kind != ClassKind::ignore) {
      return Error{place + ": kind: id 0 means unlabelled in every label image; its kind must be \"ignore\""};
    }
    table_.classes.push_back(std::move(row));
    return Done{};
  }
  ClassTable finish() { return std::move(table_); }

 private:
  ClassTable table_;
  std::map<std::uint16_t, std::string> ids_;
  std::map<std::string, std::string> names_;
};

// One pass over the keys of a class: all of them, or only the three that decide on the others' defaults.
Status read_keys(const toml::table& table, bool all, ClassEntry& entry, const std::string& place) {
  for (const Key<ClassEntry>& key : class_keys()) {
    const bool needed = key.path == "id" || key.path == "name" || key.path == "kind";
    const toml::node* node = table.get(key.path);
    if (node == nullptr && needed) return Error{place + ": " + key.path + ": missing; expected " + wanted(key)};
    if (node == nullptr || (!all && !needed)) continue;
    if (const Status status = assign(key, entry, *node, place); !status) return status;
  }
  return Done{};
}

Result<ObjectClass> read_class(const toml::table& table, const std::string& place) {
  std::vector<std::string> known;
  for (const auto& key : class_keys()) known.push_back(key.path);
  for (const auto& [name, node] : table) {
    if (std::find(known.begin(), known.end(), name.str()) != known.end()) continue;
    const std::string meant = nearest_name(name.str(), known);
    return Error{place + ": " + std::string(name.str()) + ": unknown key of a class" +
                 (meant.empty() ? "; docs/labels.md lists all" : ", did you mean " + meant + "?")};
  }
  ClassEntry entry;
  if (const Status status = read_keys(table, false, entry, place); !status) return status.error();
  const ObjectClass row = make_class(static_cast<std::uint16_t>(entry.id), entry.name, *kind_of(entry.kind));
  entry = entry_of(row, entry);
  if (const Status status = read_keys(table, true, entry, place); !status) return status.error();
  if (entry.min_extent_m > entry.max_extent_m) {
    return Error{place + ": min_extent_m: must not exceed max_extent_m"};
  }
  return class_of(entry, row);
}

Result<ClassTable> read_table(const toml::table& document, const std::string& file) {
  const auto place = [&file](const toml::node& node) { return file + ":" + std::to_string(node.source().begin.line); };
  for (const auto& [name, node] : document) {
    if (name.str() == "name" || name.str() == "class") continue;
    return Error{place(node) + ": " + std::string(name.str()) + ": unknown key; a class table has name and class"};
  }
  const std::optional<std::string> name = document["name"].value_exact<std::string>();
  if (!name || name->empty() || name->size() > kMaxTableName) {
    return Error{file + ": name: expected text of 1 to 64 letters, the name label sources call this table by"};
  }
  const toml::array* classes = document["class"].as_array();
  if (classes == nullptr || classes->empty()) {
    return Error{file + ": class: expected a list of classes, each {id = …, name = …, kind = …}"};
  }
  TableMaker maker(*name);
  for (const toml::node& node : *classes) {
    const toml::table* table = node.as_table();
    if (table == nullptr)
      return Error{place(node) + ": class: expected {id = …, name = …, kind = …}, got " + shown(node)};
    const Result<ObjectClass> row = read_class(*table, place(node));
    if (!row) return row.error();
    if (const Status status = maker.add(*row, place(node)); !status) return status.error();
  }
  return maker.finish();
}

const ClassPreset* find_preset(const std::string& name) {
  for (const ClassPreset& preset : class_presets()) {
    if (name == preset.name) return &preset;
  }
  return nullptr;
}

std::string preset_names() {
  std::string names;
  for (const ClassPreset& preset : class_presets()) names += (names.empty() ? "" : ", ") + std::string(preset.name);
  return names;
}

}  // namespace

Result<ClassTable> parse_class_table(std::string_view text, const std::string& file) {
  try {
    return read_table(toml::parse(text, file), file);
  } catch (const toml::parse_error& error) {
    return Error{file + ":" + std::to_string(error.source().begin.line) + ": " + std::string(error.description())};
  }
}

Result<ClassTable> load_class_table(const std::string& name_or_file) {
  if (const ClassPreset* preset = find_preset(name_or_file)) {
    return parse_class_table(preset->toml, "(built in) " + name_or_file + ".toml");
  }
  std::ifstream stream(name_or_file, std::ios::binary);
  std::string text(kMaxFileBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad() || stream.gcount() == 0) {
    return Error{name_or_file + ": cannot be read; a class table is a TOML file or one of " + preset_names()};
  }
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMaxFileBytes) return Error{name_or_file + ": more than 1 MB; a class table is a short TOML file"};
  return parse_class_table(text, name_or_file);
}

Result<ClassTable> class_table_of(const LabelTable& table) {
  if (table.classes.empty()) return load_class_table(table.name);
  TableMaker maker(table.name);
  for (const LabelClass& row : table.classes) {
    const std::optional<ClassKind> kind = kind_of(row.kind);
    if (!kind) return Error{row.where + ": kind: \"" + row.kind + "\" is none"};
    if (const Status status = maker.add(make_class(row.id, row.name, *kind), row.where); !status) return status.error();
  }
  return maker.finish();
}

Result<ClassTable> choose_class_table(const LabelConfig& config, const std::optional<LabelTable>& told) {
  if (config.classes != "auto") {
    Result<ClassTable> table = load_class_table(config.classes);
    return table ? table : Result<ClassTable>(Error{"labels.classes: " + table.error().message});
  }
  if (told) return class_table_of(*told);
  if (config.socket.empty() && config.lcm_channel.empty()) return geometric_classes();
  return Error{
      "labels.classes: labels come from outside and the sensor names no classes; set it to a TOML file or one of " +
      preset_names()};
}

}  // namespace povslam
