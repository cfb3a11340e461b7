#include "drivers/replay/image_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "tests/support/temp_folder.hpp"

namespace povslam {

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr ImageSize kSize{37, 23};

// Smooth with some noise, so that files are neither trivial nor all noise.
template <class Pixel>
cv::Mat picture(int type) {
  cv::Mat image(kSize.height, kSize.width, type);
  std::mt19937 random(7);
  Pixel* pixel = image.ptr<Pixel>();
  for (std::size_t i = 0; i < image.total() * image.channels(); ++i)
    pixel[i] = static_cast<Pixel>(i * 31 + random() % 17);
  return image;
}

fs::path file(const std::string& name) {
  return temp_folder() / name;
}

fs::path write(const std::string& name, const cv::Mat& image) {
  EXPECT_TRUE(cv::imwrite(file(name).string(), image));
  return file(name);
}

fs::path write_bytes(const std::string& name, const std::vector<char>& bytes) {
  std::ofstream(file(name), std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file(name);
}

std::vector<char> bytes_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string color_error(const fs::path& path) {
  ImageU8 image;
  const Status status = ImageReader().read_color(path, kSize, image);
  return status ? "no error" : status.error().message;
}
std::string depth_error(const fs::path& path) {
  ImageU16 image;
  const Status status = ImageReader().read_u16(path, kSize, image);
  return status ? "no error" : status.error().message;
}

void expect_same_color(const ImageU8& image, const cv::Mat& bgr) {
  ASSERT_EQ(image.channels(), bgr.channels());
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      for (int c = 0; c < bgr.channels(); ++c) {
        const int opposite = bgr.channels() == 3 ? 2 - c : c;
        ASSERT_EQ(image.at(x, y, c), bgr.ptr<std::uint8_t>(y)[x * bgr.channels() + opposite]) << x << ' ' << y;
      }
    }
  }
}

// A PNG of any colour type, as libpng writes it; pixels of value 0.
fs::path write_png(const std::string& name, int color_type, int bits, int interlace) {
  FILE* stream = std::fopen(file(name).c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, stream);
  png_set_IHDR(png, info, kSize.width, kSize.height, bits, color_type, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const png_color red{200, 10, 20};
  if (color_type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, &red, 1);
  png_write_info(png, info);
  std::vector<png_byte> row(static_cast<std::size_t>(kSize.width) * 8, 0);
  const int passes = png_set_interlace_handling(png);
  for (int i = 0; i < passes * kSize.height; ++i) png_write_row(png, row.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(stream);
  return file(name);
}

}  // namespace

TEST(ImageReader, ReadsColorAsRedGreenBlue) {
  const cv::Mat bgr = picture<std::uint8_t>(CV_8UC3);
  ImageReader reader;
  ImageU8 image;
  ASSERT_TRUE(reader.read_color(write("color.png", bgr), kSize, image));
  expect_same_color(image, bgr);
  ASSERT_TRUE(reader.read_color(write("color.jpg", bgr), kSize, image));
  expect_same_color(image, cv::imread(file("color.jpg").string(), cv::IMREAD_COLOR));
}

TEST(ImageReader, ReadsGreyAsOneChannel) {
  const cv::Mat grey = picture<std::uint8_t>(CV_8UC1);
  ImageReader reader;
  ImageU8 image;
  for (const char* name : {"grey.png", "grey.pgm"}) {
    ASSERT_TRUE(reader.read_color(write(name, grey), kSize, image)) << name;
    expect_same_color(image, grey);
    ASSERT_TRUE(reader.read_u8(file(name), kSize, image)) << name;
    expect_same_color(image, grey);
  }
  ASSERT_TRUE(reader.read_color(write("grey.jpg", grey), kSize, image));
  EXPECT_EQ(image.channels(), 1);
}

TEST(ImageReader, ReadsSixteenBitDepth) {
  const cv::Mat depth = picture<std::uint16_t>(CV_16UC1);
  for (const char* name : {"depth.png", "depth.pgm"}) {
    ImageU16 image;
    ASSERT_TRUE(ImageReader().read_u16(write(name, depth), kSize, image)) << name;
    for (int y = 0; y < depth.rows; ++y) {
      for (int x = 0; x < depth.cols; ++x) ASSERT_EQ(image.at(x, y), depth.at<std::uint16_t>(y, x)) << name;
    }
  }
}

TEST(ImageReader, ReadsEveryKindOfPng) {
  for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
    for (const int bits : {1, 2, 4, 8, 16}) {
      for (const int type : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_PALETTE, PNG_COLOR_TYPE_GRAY_ALPHA,
                             PNG_COLOR_TYPE_RGB_ALPHA}) {
        const bool small_ok = type == PNG_COLOR_TYPE_GRAY || type == PNG_COLOR_TYPE_PALETTE;
        if ((bits < 8 && !small_ok) || (bits == 16 && type == PNG_COLOR_TYPE_PALETTE)) continue;
        const fs::path path = write_png("kind.png", type, bits, interlace);
        ImageU8 image;
        const Status status = ImageReader().read_color(path, kSize, image);
        ASSERT_TRUE(status) << type << ' ' << bits << ' ' << status.error().message;
        const bool grey = type == PNG_COLOR_TYPE_GRAY || type == PNG_COLOR_TYPE_GRAY_ALPHA;
        EXPECT_EQ(image.channels(), grey ? 1 : 3);
        EXPECT_EQ(image.at(36, 22, 0), type == PNG_COLOR_TYPE_PALETTE ? 200 : 0);
        EXPECT_EQ(depth_error(path) == "no error", grey && bits == 16);
      }
    }
  }
}

TEST(ImageReader, SaysWhatIsWrongWithAFile) {
  const cv::Mat color = picture<std::uint8_t>(CV_8UC3);
  EXPECT_THAT(color_error(file("nothing.png")), HasSubstr("nothing.png: no such file"));
  EXPECT_THAT(color_error(write_bytes("empty.png", {})), HasSubstr("the file is empty"));
  EXPECT_THAT(color_error(temp_folder()), HasSubstr("not a regular file"));
  EXPECT_THAT(color_error(write("wide.png", cv::Mat(kSize.height, 100, CV_8UC3))),
              HasSubstr("100 x 23 px, the calibration says 37 x 23"));
  EXPECT_THAT(depth_error(write("flat.png", picture<std::uint8_t>(CV_8UC1))), HasSubstr("8-bit grey, 16-bit grey"));
  EXPECT_THAT(depth_error(write("flat.jpg", color)), HasSubstr("16-bit grey"));
  EXPECT_THAT(depth_error(write("flat.png", color)), HasSubstr("8-bit colour, 16-bit grey"));
  EXPECT_THAT(color_error(write_bytes("text.png", {'h', 'e', 'l', 'l', 'o'})), HasSubstr("neither PNG, JPEG nor"));
  fs::remove(file("loop"));
  fs::create_symlink(file("loop"), file("loop"));
  EXPECT_THAT(color_error(file("loop")), HasSubstr("loop: "));
}

TEST(ImageReader, RefusesAHugeDeclaredSizeBeforeDecoding) {
  std::vector<char> png = bytes_of(write("bomb.png", picture<std::uint8_t>(CV_8UC3)));
  png[16] = 0x7F;  // a width of 2 * 10^9
  EXPECT_THAT(color_error(write_bytes("bomb.png", png)), HasSubstr("header is damaged"));
  png[16] = 0x00, png[17] = 0x10;
  EXPECT_THAT(color_error(write_bytes("bomb.png", png)), HasSubstr("the calibration says"));
  const std::string pgm = "P5 999999999 999999999 65535\n";
  EXPECT_THAT(depth_error(write_bytes("bomb.pgm", {pgm.begin(), pgm.end()})), HasSubstr("bomb.pgm: "));
}

TEST(ImageReader, NoticesEveryTruncation) {
  const std::vector<fs::path> files = {
      write("cut.png", picture<std::uint8_t>(CV_8UC3)), write("cut.jpg", picture<std::uint8_t>(CV_8UC3)),
      write("cut16.png", picture<std::uint16_t>(CV_16UC1)), write("cut16.pgm", picture<std::uint16_t>(CV_16UC1))};
  for (const fs::path& path : files) {
    const std::vector<char> whole = bytes_of(path);
    const bool deep = path.string().find("cut16") != std::string::npos;
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 40) {
      const fs::path cut =
          write_bytes("truncated", {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
      EXPECT_NE(deep ? depth_error(cut) : color_error(cut), "no error") << path << " cut to " << length;
    }
  }
}

TEST(ImageReader, NoticesEveryFlippedByteOfAPng) {
  const std::vector<char> whole = bytes_of(write("flip.png", picture<std::uint16_t>(CV_16UC1)));
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    std::vector<char> flipped = whole;
    flipped[random() % flipped.size()] ^= static_cast<char>(1U << random() % 8);
    EXPECT_NE(depth_error(write_bytes("flipped", flipped)), "no error");
  }
}

TEST(ImageReader, SurvivesGarbageWithAnyStartAndPrintsNothing) {
  std::mt19937 random(5);
  const std::vector<std::vector<char>> starts = {{},
                                                 bytes_of(write("s.png", picture<std::uint8_t>(CV_8UC3))),
                                                 bytes_of(write("s.jpg", picture<std::uint8_t>(CV_8UC3)))};
  testing::internal::CaptureStderr();
  for (int i = 0; i < 600; ++i) {
    std::vector<char> bytes = starts[static_cast<std::size_t>(i % 3)];
    if (bytes.empty()) bytes.resize(random() % 500);
    const std::size_t from = i % 2 == 0 ? 0 : std::min<std::size_t>(bytes.size(), 40);
    for (std::size_t k = 0; from < bytes.size() && k < 1 + random() % 30; ++k) {
      bytes[from + random() % (bytes.size() - from)] = static_cast<char>(random());
    }
    const fs::path path = write_bytes("garbage", bytes);
    color_error(path);
    depth_error(path);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ImageReader, DoesNotDecodeMillionsOfTinyScans) {
  const std::vector<char> whole = bytes_of([] {
    cv::imwrite(file("scans.jpg").string(), picture<std::uint8_t>(CV_8UC3), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
    return file("scans.jpg");
  }());
  const std::vector<char> scan = {'\xFF', '\xDA'};
  const auto first = std::search(whole.begin(), whole.end(), scan.begin(), scan.end());
  const auto second = std::search(first + 2, whole.end(), scan.begin(), scan.end());
  ASSERT_NE(second, whole.end());
  std::vector<char> many(whole.begin(), second);
  for (int i = 0; i < 20000; ++i) many.insert(many.end(), first, second);
  many.insert(many.end(), {'\xFF', '\xD9'});
  EXPECT_THAT(color_error(write_bytes("scans.jpg", many)), HasSubstr("broken JPEG"));
}

}  // namespace povslam
