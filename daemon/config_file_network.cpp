#include "daemon/config_file_network.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "daemon/config_file_classes.hpp"
#include "pipeline/objects/segment_network.hpp"

namespace povslam {
namespace {

constexpr const char* kKey = "network.file: ";
constexpr const char* kDetectorsTable = "coco";
constexpr std::uintmax_t kLargestFile = 2'000'000'000;  // beyond it is no ONNX: its format ends there

Result<std::vector<std::uint8_t>> read_weights(const std::string& file) {
  if (file.empty()) {
    return Error{std::string(kKey) + "understanding.labels is \"dnn\", which needs the weights of a network; name " +
                 "its file, or set understanding.labels to geometric"};
  }
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) return Error{kKey + file + ": there is no such file"};
  if (std::filesystem::file_size(file, failed) > kLargestFile)
    return Error{kKey + file + ": too large to be a network"};
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(stream), {});
  if (!stream) return Error{kKey + file + ": cannot be read; check its permissions"};
  return bytes;
}

// Whether loading ends by a signal, seen where it costs nothing.
Status try_apart(const std::vector<std::uint8_t>& onnx, const NamingOptions& options) {
  const pid_t child = ::fork();
  if (child < 0) return Error{std::string("no process to try it in: ") + std::strerror(errno)};
  if (child == 0) {
    ::close(STDERR_FILENO);  // the library's complaints come once, from the parent
    static_cast<void>(SegmentNetwork::load(onnx, options.boxes, options.input_px));
    ::_exit(0);  // an error is told where it can be heard
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return Error{std::string("the process that tried it is lost: ") + std::strerror(errno)};
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return Done{};
  return Error{"OpenCV breaks down reading it; the file is damaged, get it anew"};
}

Result<ClassTable> detectors_table(const LabelConfig& config, int num_classes) {
  LabelConfig named = config;
  if (named.classes == "auto") named.classes = kDetectorsTable;
  Result<ClassTable> table = choose_class_table(named, std::nullopt);
  if (!table) return table;
  int largest = 0;
  for (const ObjectClass& row : table->classes) largest = std::max<int>(largest, row.id);
  const bool fits = config.classes == "auto" ? largest == num_classes : largest <= num_classes;
  if (fits) return table;
  return Error{"labels.classes: table \"" + table->name + "\" goes up to id " + std::to_string(largest) +
               ", the network of network.file tells " + std::to_string(num_classes) +
               " classes; name the table that belongs to it"};
}

}  // namespace

Result<std::unique_ptr<SegmentNamer>> load_namer(const AppConfig& config) {
  const NamingOptions& options = config.pipeline.understanding.naming;
  if (options.input_px % 32 != 0) {
    return Error{"network.input_px: " + std::to_string(options.input_px) + " is no multiple of 32"};
  }
  const Result<std::vector<std::uint8_t>> weights = read_weights(config.network.file);
  if (!weights) return weights.error();
  const auto about_file = [&](const Error& error) { return Error{kKey + config.network.file + ": " + error.message}; };
  SegmentNetwork::limit_threads(1);
  if (const Status survived = try_apart(*weights, options); !survived) return about_file(survived.error());
  Result<SegmentNetwork> loaded = SegmentNetwork::load(*weights, options.boxes, options.input_px);
  if (!loaded) return about_file(loaded.error());
  Result<ClassTable> table = detectors_table(config.labels, loaded->num_classes());
  if (!table) return table.error();
  auto network = std::make_shared<SegmentNetwork>(std::move(*loaded));
  return std::make_unique<SegmentNamer>([network](const ImageU8& color) { return network->detect(color); },
                                        std::move(*table), options);
}

}  // namespace povslam
