#include "tools/povslam/scores/ply_file.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

namespace povslam::scores {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PLY is read as it lies in memory");

struct Property {
  std::string name, type;
  std::string count_type;  // of a list; empty: a single value
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
struct Header {
  bool ascii = false;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes
};

struct Failure {  // thrown and caught in this file only
  std::string message;
};

std::size_t size_of(const std::string& type) {
  static const std::map<std::string, std::size_t> kSizes{{"char", 1},  {"int8", 1},    {"uchar", 1},  {"uint8", 1},
                                                         {"short", 2}, {"int16", 2},   {"ushort", 2}, {"uint16", 2},
                                                         {"int", 4},   {"int32", 4},   {"uint", 4},   {"uint32", 4},
                                                         {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

template <class T>
double as(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double decode(const std::string& type, const char* bytes) {
  if (type == "float" || type == "float32") return as<float>(bytes);
  if (type == "double" || type == "float64") return as<double>(bytes);
  if (type == "int" || type == "int32") return as<std::int32_t>(bytes);
  if (type == "uint" || type == "uint32") return as<std::uint32_t>(bytes);
  if (type == "short" || type == "int16") return as<std::int16_t>(bytes);
  if (type == "ushort" || type == "uint16") return as<std::uint16_t>(bytes);
  return type == "char" || type == "int8" ? as<std::int8_t>(bytes) : as<std::uint8_t>(bytes);
}

Header parse_header(const std::string& content) {
  Header header;
  bool has_format = false;
  for (int number = 1; header.size < content.size(); ++number) {
    const std::size_t end = content.find('\n', header.size);
    if (end == std::string::npos) break;
    std::istringstream words(content.substr(header.size, end - header.size));
    header.size = end + 1;
    std::string key;
    words >> key;
    const auto fail = [number](const std::string& what) { throw Failure{":" + std::to_string(number) + ": " + what}; };
    if (number == 1) {
      if (key != "ply") fail("a PLY file begins with 'ply'");
    } else if (key == "end_header") {
      if (!has_format) fail("no format line");
      return header;
    } else if (key == "format") {
      std::string format;
      words >> format;
      if (format != "ascii" && format != "binary_little_endian")
        fail("format '" + format + "' is not read; write binary_little_endian");
      header.ascii = format == "ascii";
      has_format = true;
    } else if (key == "element") {
      Element element;
      if (!(words >> element.name >> element.count)) fail("expected 'element NAME COUNT'");
      header.elements.push_back(element);
    } else if (key == "property") {
      Property property;
      words >> property.type;
      if (property.type == "list") words >> property.count_type >> property.type;
      words >> property.name;
      const bool known =
          size_of(property.type) > 0 && (property.count_type.empty() || size_of(property.count_type) > 0);
      if (!words || !known || header.elements.empty()) fail("property of unknown type or outside an element");
      header.elements.back().properties.push_back(property);
    } else if (key != "comment" && key != "obj_info") {
      fail("unknown word '" + key + "'");
    }
    if (number > 1000) fail("header too long");
  }
  throw Failure{": no end_header; the file is cut off"};
}

class Body {
 public:
  Body(const std::string& content, const Header& header) : content_(content), at_(header.size), ascii_(header.ascii) {}

  double next(const std::string& type) {
    if (!ascii_) {
      const std::size_t size = size_of(type);
      if (content_.size() - at_ < size) fail("the file is cut off");
      at_ += size;
      return decode(type, content_.data() + at_ - size);
    }
    char* end = nullptr;
    const double value = std::strtod(content_.c_str() + at_, &end);
    if (end == content_.c_str() + at_) fail("expected a number");
    at_ = static_cast<std::size_t>(end - content_.c_str());
    return value;
  }
  std::size_t left() const { return content_.size() - at_; }
  [[noreturn]] void fail(const std::string& what) const {
    throw Failure{": byte " + std::to_string(at_) + ": " + what};
  }

 private:
  const std::string& content_;
  std::size_t at_ = 0;
  bool ascii_ = false;
};

void read_vertex(const Element& element, Body& body, PlyMesh& mesh) {
  constexpr double kFarthest_m = 1e4;
  Eigen::Vector3d p = Eigen::Vector3d::Constant(std::nan("")), normal = p;
  for (const Property& property : element.properties) {
    if (!property.count_type.empty()) body.fail("a list among a vertex's properties");
    const double value = body.next(property.type);
    if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
      p[property.name[0] - 'x'] = value;
    if (property.name.size() == 2 && property.name[0] == 'n' && property.name[1] >= 'x' && property.name[1] <= 'z')
      normal[property.name[1] - 'x'] = value;
  }
  if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest_m) body.fail("vertex without finite x, y, z within 10 km");
  mesh.vertices.push_back(p);
  if (normal.allFinite()) mesh.normals.push_back(normal);
}

std::uint32_t vertex_index(double value, const Body& body, const PlyMesh& mesh) {
  if (!(value >= 0.0 && value < static_cast<double>(mesh.vertices.size())))
    body.fail("face with a vertex that is not there");
  return static_cast<std::uint32_t>(value);
}

void read_face(const Element& element, Body& body, PlyMesh& mesh) {
  for (const Property& property : element.properties) {
    const double count = property.count_type.empty() ? 1.0 : body.next(property.count_type);
    if (!(count >= 0.0 && count <= static_cast<double>(body.left()))) body.fail("list of impossible length");
    const bool corners = property.name == "vertex_indices" || property.name == "vertex_index";
    std::array<std::uint32_t, 3> fan{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const double value = body.next(property.type);
      if (!corners) continue;
      fan[i == 0 ? 0 : 2] = vertex_index(value, body, mesh);
      if (i >= 2) mesh.triangles.push_back(fan);
      fan[1] = fan[2];
    }
  }
}

void skip(const Element& element, Body& body) {
  for (const Property& property : element.properties) {
    const double count = property.count_type.empty() ? 1.0 : body.next(property.count_type);
    if (!(count >= 0.0 && count <= static_cast<double>(body.left()))) body.fail("list of impossible length");
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) body.next(property.type);
  }
}

PlyMesh parse(const std::string& content) {
  const Header header = parse_header(content);
  Body body(content, header);
  PlyMesh mesh;
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (element.name == "vertex") {
        read_vertex(element, body, mesh);
      } else if (element.name == "face") {
        read_face(element, body, mesh);
      } else {
        skip(element, body);
      }
    }
  }
  if (mesh.normals.size() != mesh.vertices.size()) mesh.normals.clear();
  return mesh;
}

}  // namespace

Result<PlyMesh> parse_ply(const std::string& content, const std::string& name) {
  try {
    return parse(content);
  } catch (const Failure& failure) {
    return Error{name + failure.message};
  }
}

Result<PlyMesh> read_ply(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream content;
  if (in && std::filesystem::is_regular_file(path)) content << in.rdbuf();
  if (!in || !std::filesystem::is_regular_file(path)) return Error{path.string() + ": cannot read"};
  return parse_ply(content.str(), path.string());
}

}  // namespace povslam::scores
