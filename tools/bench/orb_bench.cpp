// Our ORB extractor beside cv::ORB, and its parts, on one image: orb_bench [IMAGE.png] [google benchmark flags].
// Without an image, a generated one of 640x480. cv::ORB runs on one thread, with Harris score as by default.
#include <benchmark/benchmark.h>

#include <memory>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "pipeline/frontend/kernels/dispatch.hpp"
#include "pipeline/frontend/orb.hpp"

namespace {

cv::Mat image;

cv::Mat generated_image() {
  cv::RNG random(1);
  cv::Mat grey(480, 640, CV_8U, cv::Scalar(120));
  for (int k = 0; k < 1500; ++k) {
    const cv::Rect box(random.uniform(0, 640), random.uniform(0, 480), random.uniform(3, 43), random.uniform(3, 43));
    cv::rectangle(grey, box, cv::Scalar(random.uniform(0, 256)), cv::FILLED);
  }
  cv::Mat noise(grey.size(), CV_8U);
  random.fill(noise, cv::RNG::NORMAL, 8, 2);
  cv::GaussianBlur(grey, grey, {}, 0.7);
  return grey * 0.9 + noise;
}

void own_orb(benchmark::State& state, const povslam::FrontendKernels* kernels) {
  const int wanted = static_cast<int>(state.range(0));
  povslam::OrbExtractor extractor(image.cols, image.rows, {.num_features = wanted}, *kernels);
  povslam::OrbFeatures features(wanted);
  for (auto _ : state) extractor.extract(image.data, static_cast<std::int64_t>(image.step), features);
  state.counters["features"] = features.size;
}

void opencv_orb(benchmark::State& state) {
  const auto orb = cv::ORB::create(static_cast<int>(state.range(0)), 1.2F, 8);
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
  for (auto _ : state) orb->detectAndCompute(image, cv::noArray(), points, descriptors);
  state.counters["features"] = static_cast<double>(points.size());
}

void own_grey(benchmark::State& state) {
  cv::Mat colour;
  cv::cvtColor(image, colour, cv::COLOR_GRAY2RGB);
  cv::Mat grey(image.size(), CV_8U);
  for (auto _ : state) povslam::rgb_to_grey(colour.data, grey.data, static_cast<std::int64_t>(grey.total()));
}

void own_nearest(benchmark::State& state) {
  const int wanted = static_cast<int>(state.range(0));
  povslam::OrbExtractor extractor(image.cols, image.rows, {.num_features = wanted});
  povslam::OrbFeatures features(wanted);
  extractor.extract(image.data, static_cast<std::int64_t>(image.step), features);
  for (auto _ : state) {
    for (int k = 0; k < features.size; ++k) {
      benchmark::DoNotOptimize(
          povslam::nearest_descriptor(features.descriptor[k], features.descriptor.data(), features.size));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  image = argc > 1 ? cv::imread(argv[1], cv::IMREAD_GRAYSCALE) : generated_image();
  if (image.empty()) {
    std::fprintf(stderr, "orb_bench: cannot read the image %s\n", argv[1]);
    return 1;
  }
  cv::setNumThreads(1);
  const povslam::AvailableKernels available = povslam::available_kernels();
  for (int k = 0; available.kernels[k] != nullptr; ++k) {
    const std::string name = std::string("own_orb/") + available.kernels[k]->isa;
    benchmark::RegisterBenchmark(name.c_str(), own_orb, available.kernels[k])
        ->Arg(1000)
        ->Arg(4000)
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::RegisterBenchmark("opencv_orb", opencv_orb)->Arg(1000)->Arg(4000)->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("own_grey", own_grey)->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("own_nearest_all_pairs", own_nearest)->Arg(1000)->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
}
