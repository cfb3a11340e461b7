#include "pipeline/objects/segment_network.hpp"

#include <algorithm>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "pipeline/base/expects.hpp"

namespace povslam {

namespace {

constexpr double kPad = 114.0;  // grey that the network was trained with around images

int num_cells(int input_px) {
  int cells = 0;
  for (const int stride : {8, 16, 32}) cells += (input_px / stride) * (input_px / stride);
  return cells;
}

}  // namespace

struct SegmentNetwork::Impl {
  Impl(const BoxOptions& its_options, int its_input_px)
      : options(its_options), input_px(its_input_px), input(input_px, input_px, CV_8UC3) {}

  cv::Mat run(const ImageU8& color, float& scale);

  cv::dnn::Net net;
  BoxOptions options;
  int input_px;
  int num_classes = 0;
  cv::Mat input;
};

SegmentNetwork::SegmentNetwork(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SegmentNetwork::SegmentNetwork(SegmentNetwork&&) noexcept = default;
SegmentNetwork& SegmentNetwork::operator=(SegmentNetwork&&) noexcept = default;
SegmentNetwork::~SegmentNetwork() = default;

// The image into the input's top left corner, blue first as the network was trained.
cv::Mat SegmentNetwork::Impl::run(const ImageU8& color, float& scale) {
  const int largest = std::max(color.width(), color.height());
  scale = static_cast<float>(input_px) / static_cast<float>(largest);
  const auto scaled = [&](int size) { return std::max(1, size * input_px / largest); };
  const cv::Mat image(color.height(), color.width(), color.channels() == 3 ? CV_8UC3 : CV_8UC1,
                      const_cast<std::uint8_t*>(color.data()));  // cv::Mat knows no constant pixels; it only reads
  cv::Mat bgr, small;
  cv::cvtColor(image, bgr, color.channels() == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_GRAY2BGR);
  cv::resize(bgr, small, {scaled(color.width()), scaled(color.height())});
  input.setTo(cv::Scalar::all(kPad));
  small.copyTo(input(cv::Rect(0, 0, small.cols, small.rows)));
  net.setInput(cv::dnn::blobFromImage(input));
  return net.forward();
}

Result<SegmentNetwork> SegmentNetwork::load(std::span<const std::uint8_t> onnx, const BoxOptions& options,
                                            int input_px) {
  EXPECTS(input_px >= 32 && input_px % 32 == 0);
  if (onnx.empty()) return Error{"the network's file is empty"};
  auto impl = std::make_unique<Impl>(options, input_px);
  try {
    impl->net = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(onnx.data()), onnx.size());
    ImageU8 grey(input_px, input_px);
    grey.fill(static_cast<std::uint8_t>(kPad));
    float scale = 1.0F;
    const cv::Mat output = impl->run(grey, scale);
    const bool boxes =
        output.dims == 3 && output.size[1] == num_cells(input_px) && output.size[2] > 5 && output.type() == CV_32F;
    if (!boxes) {
      const std::string edge = std::to_string(input_px), rows = std::to_string(num_cells(input_px));
      return Error{"the network is no YOLOX of " + edge + " x " + edge + ": its output is not " + rows +
                   " rows of boxes and scores"};
    }
    impl->num_classes = output.size[2] - 5;
  } catch (const std::exception& error) {
    return Error{std::string("OpenCV cannot run the network: ") + error.what() +
                 "; give a YOLOX in ONNX, opset 11, without decoding"};
  }
  return SegmentNetwork(std::move(impl));
}

Result<std::vector<DetectedBox>> SegmentNetwork::detect(const ImageU8& color) {
  if (color.empty()) return std::vector<DetectedBox>{};
  try {
    float scale = 1.0F;
    const cv::Mat output = impl_->run(color, scale);
    const std::span<const float> rows(output.ptr<float>(), output.total());
    return decode_yolox(rows, impl_->input_px, impl_->num_classes, scale, impl_->options);
  } catch (const std::exception& error) {
    return Error{std::string("OpenCV cannot run the network: ") + error.what()};
  }
}

int SegmentNetwork::num_classes() const {
  return impl_->num_classes;
}

void SegmentNetwork::limit_threads(int count) {
  cv::setNumThreads(count);
}

}  // namespace povslam
