#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "tools/povslam/canvas.hpp"

namespace povslam::drawing {
namespace {

// Drawn larger and averaged down: OpenCV's stroke font has no smoothing worth the name at reading size.
constexpr int kOversampling = 3;
constexpr int kFractionBits = 4;

cv::Scalar bgr(Color color) {
  return {double(color.blue), double(color.green), double(color.red)};
}

cv::Point fixed_point(const Eigen::Vector2d& p_px) {
  constexpr double kUnits = kOversampling * (1 << kFractionBits);
  return {cvRound(p_px.x() * kUnits), cvRound(p_px.y() * kUnits)};
}

cv::Point whole(const Eigen::Vector2d& p_px) {
  return {cvRound(p_px.x() * kOversampling), cvRound(p_px.y() * kOversampling)};
}

class PngCanvas : public Canvas {
 public:
  PngCanvas(int width_px, int height_px)
      : sheet_(height_px * kOversampling, width_px * kOversampling, CV_8UC3, cv::Scalar(255, 255, 255)) {}

  void polyline(std::span<const Eigen::Vector2d> points_px, const Stroke& stroke) override {
    std::vector<cv::Point> points;
    for (const Eigen::Vector2d& p_px : points_px) points.push_back(fixed_point(p_px));
    const int width = std::max(1, cvRound(stroke.width_px * kOversampling));
    cv::polylines(sheet_, points, false, bgr(stroke.color), width, cv::LINE_AA, kFractionBits);
  }

  void rectangle(const Eigen::Vector2d& corner_px, const Eigen::Vector2d& size_px, Color fill) override {
    cv::rectangle(sheet_, cv::Rect(whole(corner_px), whole(corner_px + size_px)), bgr(fill), cv::FILLED);
  }

  void dot(const Eigen::Vector2d& centre_px, double radius_px, Color fill) override {
    const int radius = cvRound(radius_px * kOversampling * (1 << kFractionBits));
    cv::circle(sheet_, fixed_point(centre_px), radius, bgr(fill), cv::FILLED, cv::LINE_AA, kFractionBits);
  }

  void text(const Eigen::Vector2d& baseline_px, const std::string& text, const TextStyle& style) override {
    constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
    constexpr double kFontHeight = 30.0;  // line height of this font at scale 1 [px]
    const double scale = style.size_px * kOversampling / kFontHeight;
    const int weight = std::max(1, cvRound(style.size_px * kOversampling * (style.bold ? 0.12 : 0.075)));
    const int width = cv::getTextSize(text, kFont, scale, weight, nullptr).width;
    cv::Point origin = whole(baseline_px);
    if (style.anchor == Anchor::middle) origin.x -= width / 2;
    if (style.anchor == Anchor::right) origin.x -= width;
    cv::putText(sheet_, text, origin, kFont, scale, bgr(style.color), weight, cv::LINE_AA);
  }

  Status save(const std::string& file) const override {
    const cv::Size size(sheet_.cols / kOversampling, sheet_.rows / kOversampling);
    cv::Mat small;
    cv::resize(sheet_, small, size, 0.0, 0.0, cv::INTER_AREA);
    try {
      if (cv::imwrite(file, small)) return Done{};
    } catch (const cv::Exception&) {  // the message below says all there is to say
    }
    return Error{file + ": cannot write the picture; does its folder exist and may it be written to?"};
  }

 private:
  cv::Mat sheet_;
};

}  // namespace

std::unique_ptr<Canvas> make_png_canvas(int width_px, int height_px) {
  return std::make_unique<PngCanvas>(width_px, height_px);
}

}  // namespace povslam::drawing
