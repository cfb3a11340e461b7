// Makes a recording in the layout of TUM RGB-D harder than it is: roughen FOLDER --out DIR [OPTION…].
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Line {
  double stamp = 0.0;  // s
  std::string rest;    // file, or a pose
};

struct Roughness {
  int every = 1;                // keep each n-th frame
  double gap_s = 0.0;           // leave out so much in the middle
  double holes = 0.0;           // share of the depth that is taken away, in blobs that change over a second
  double scale = 1.0;           // of the depth
  int blur_px = 0;              // along the rows
  int jpeg = 0;                 // quality; 0: PNG
  bool gain = false;            // the exposure changes by up to 30 % each 20 frames
  bool there_and_back = false;  // forwards, backwards, forwards
};

std::vector<Line> read_list(const fs::path& file) {
  std::ifstream in(file);
  std::vector<Line> lines;
  for (std::string text; std::getline(in, text);) {
    if (text.empty() || text[0] == '#') continue;
    std::istringstream words(text);
    Line line;
    words >> line.stamp >> std::ws;
    std::getline(words, line.rest);
    lines.push_back(line);
  }
  return lines;
}

void write_list(const fs::path& file, std::vector<Line> lines) {
  std::ranges::stable_sort(lines, {}, &Line::stamp);
  std::ofstream out(file);
  for (const Line& line : lines) {
    char stamp[32];
    std::snprintf(stamp, sizeof stamp, "%.6f ", line.stamp);
    out << stamp << line.rest << '\n';
  }
}

// Where the depth is missing: low where a smooth field that moves over the frames is.
cv::Mat hole_field(cv::Size size, int frame) {
  constexpr int kFramesAField = 30;
  const auto field = [](int index) {
    cv::RNG random(static_cast<std::uint64_t>(index) + 1);
    cv::Mat coarse(12, 16, CV_32F);
    random.fill(coarse, cv::RNG::NORMAL, 0.0, 1.0);
    return coarse;
  };
  const double share = static_cast<double>(frame % kFramesAField) / kFramesAField;
  const cv::Mat mixed = field(frame / kFramesAField) * (1.0 - share) + field(frame / kFramesAField + 1) * share;
  cv::Mat smooth;
  cv::resize(mixed, smooth, size, 0, 0, cv::INTER_CUBIC);
  return smooth;
}

cv::Mat rough_depth(cv::Mat depth, const Roughness& rough, int frame) {
  depth.convertTo(depth, CV_16U, rough.scale);
  if (rough.holes <= 0.0) return depth;
  const cv::Mat field = hole_field(depth.size(), frame);
  std::vector<float> values(field.begin<float>(), field.end<float>());
  const auto limit = values.begin() + static_cast<std::ptrdiff_t>(rough.holes * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), limit, values.end());
  depth.setTo(0, field < *limit);
  return depth;
}

cv::Mat rough_colour(cv::Mat colour, const Roughness& rough, int frame) {
  if (rough.blur_px > 1) cv::blur(colour, colour, {rough.blur_px, 1});
  if (rough.gain) {
    cv::RNG random(static_cast<std::uint64_t>(frame / 20) + 1);
    colour *= random.uniform(0.7, 1.3);
  }
  return colour;
}

// File names stay, but for the ending of colour images as JPEG.
bool write_images(const fs::path& from, const fs::path& to, std::vector<Line>& lines, bool colour,
                  const Roughness& rough) {
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const int frame = static_cast<int>(k);
    const cv::Mat image = cv::imread((from / lines[k].rest).string(), cv::IMREAD_UNCHANGED);
    if (image.empty()) {
      std::fprintf(stderr, "roughen: cannot read %s\n", (from / lines[k].rest).c_str());
      return false;
    }
    fs::path name = lines[k].rest;
    if (colour) name.replace_extension(rough.jpeg > 0 ? ".jpg" : ".png");
    fs::create_directories((to / name).parent_path());
    const cv::Mat rougher = colour ? rough_colour(image, rough, frame) : rough_depth(image, rough, frame);
    const std::vector<int> quality = rough.jpeg > 0 && colour ? std::vector<int>{cv::IMWRITE_JPEG_QUALITY, rough.jpeg}
                                                              : std::vector<int>{cv::IMWRITE_PNG_COMPRESSION, 1};
    if (!cv::imwrite((to / name).string(), rougher, quality)) return false;
    lines[k].rest = name.string();
  }
  return true;
}

// What of a list remains in time.
std::vector<Line> rough_times(std::vector<Line> lines, double begin, double end, const Roughness& rough) {
  const double middle = 0.5 * (begin + end);
  std::erase_if(lines, [&](const Line& line) {
    const bool outside = rough.there_and_back && (line.stamp < begin - 0.02 || line.stamp > end + 0.02);
    return outside || (rough.gap_s > 0.0 && line.stamp > middle && line.stamp < middle + rough.gap_s);
  });
  if (!rough.there_and_back) return lines;
  const double lap = end - begin + 0.033;
  const std::size_t once = lines.size();
  for (std::size_t k = 0; k < once; ++k) lines.push_back({begin + lap + (end - lines[k].stamp), lines[k].rest});
  for (std::size_t k = 0; k < once; ++k) lines.push_back({lines[k].stamp + 2.0 * lap, lines[k].rest});
  return lines;
}

bool roughen(const fs::path& from, const fs::path& to, const Roughness& rough) {
  std::vector<Line> colour = read_list(from / "rgb.txt"), depth = read_list(from / "depth.txt");
  if (colour.empty() || depth.empty()) {
    std::fprintf(stderr, "roughen: %s has no rgb.txt or depth.txt with images\n", from.c_str());
    return false;
  }
  const double begin = colour.front().stamp, end = colour.back().stamp;
  std::vector<Line> kept;
  for (std::size_t k = 0; k < colour.size(); k += static_cast<std::size_t>(rough.every)) kept.push_back(colour[k]);
  if (!write_images(from, to, kept, true, rough) || !write_images(from, to, depth, false, rough)) return false;
  write_list(to / "rgb.txt", rough_times(kept, begin, end, rough));
  write_list(to / "depth.txt", rough_times(depth, begin, end, rough));
  Roughness truth = rough;
  truth.gap_s = 0.0;
  write_list(to / "groundtruth.txt", rough_times(read_list(from / "groundtruth.txt"), begin, end, truth));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Makes a recording harder than it is.", "roughen");
  std::string from, to;
  Roughness rough;
  app.add_option("folder", from, "Recording in the layout of TUM RGB-D")->required()->check(CLI::ExistingDirectory);
  app.add_option("--out", to, "Folder to write")->required();
  app.add_option("--every", rough.every, "Keep each n-th frame")->check(CLI::Range(1, 100));
  app.add_option("--gap", rough.gap_s, "Leave out so many seconds in the middle")->check(CLI::Range(0.0, 3600.0));
  app.add_option("--holes", rough.holes, "Share of the depth to take away, in blobs")->check(CLI::Range(0.0, 1.0));
  app.add_option("--scale", rough.scale, "Of the depth")->check(CLI::Range(0.5, 2.0));
  app.add_option("--blur", rough.blur_px, "Pixels along the rows")->check(CLI::Range(0, 100));
  app.add_option("--jpeg", rough.jpeg, "Colour as JPEG of this quality")->check(CLI::Range(1, 100));
  app.add_flag("--gain", rough.gain, "Exposure jumps by up to 30 % each 20 frames");
  app.add_flag("--there-and-back", rough.there_and_back, "Forwards, backwards, forwards again");
  CLI11_PARSE(app, argc, argv);
  return roughen(from, to, rough) ? 0 : 1;
}
