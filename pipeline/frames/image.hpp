// A dense image whose buffer is kept and reused: resize() to a size once seen allocates nothing.
// Row-major, channels interleaved, rows without padding, 64-byte aligned start.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

#include "pipeline/base/expects.hpp"

namespace povslam {

template <class Pixel>
class Image {
  static_assert(std::is_trivially_copyable_v<Pixel>);

 public:
  Image() = default;
  Image(int width, int height, int channels = 1) { resize(width, height, channels); }
  Image(const Image& other) { *this = other; }
  Image(Image&& other) noexcept { *this = std::move(other); }
  Image& operator=(Image&& other) noexcept {  // leaves `other` empty, ready for resize()
    if (this == &other) return *this;
    buffer_ = std::move(other.buffer_);
    capacity_ = std::exchange(other.capacity_, 0);
    width_ = std::exchange(other.width_, 0);
    height_ = std::exchange(other.height_, 0);
    channels_ = std::exchange(other.channels_, 1);
    return *this;
  }
  Image& operator=(const Image& other) {
    if (this == &other) return *this;
    resize(other.width_, other.height_, other.channels_);
    if (other.size() > 0) std::memcpy(data(), other.data(), other.size() * sizeof(Pixel));
    return *this;
  }

  // Content is undefined after a change of size.
  void resize(int width, int height, int channels = 1) {
    EXPECTS(width >= 0 && height >= 0 && channels >= 1);
    const std::size_t needed = static_cast<std::size_t>(width) * height * channels;
    if (needed > capacity_) {
      buffer_.reset(static_cast<Pixel*>(::operator new(needed * sizeof(Pixel), kAlignment)));
      capacity_ = needed;
    }
    width_ = width;
    height_ = height;
    channels_ = channels;
  }
  void fill(Pixel value) {
    for (Pixel& pixel : pixels()) pixel = value;
  }

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  bool empty() const { return size() == 0; }
  std::size_t size() const { return static_cast<std::size_t>(width_) * height_ * channels_; }
  std::size_t stride() const { return static_cast<std::size_t>(width_) * channels_; }  // pixel values a row

  Pixel* data() { return buffer_.get(); }
  const Pixel* data() const { return buffer_.get(); }
  Pixel* row(int y) { return data() + y * stride(); }
  const Pixel* row(int y) const { return data() + y * stride(); }
  Pixel& at(int x, int y, int channel = 0) { return row(y)[static_cast<std::size_t>(x) * channels_ + channel]; }
  const Pixel& at(int x, int y, int channel = 0) const {
    return row(y)[static_cast<std::size_t>(x) * channels_ + channel];
  }
  std::span<Pixel> pixels() { return {data(), size()}; }
  std::span<const Pixel> pixels() const { return {data(), size()}; }

 private:
  static constexpr std::align_val_t kAlignment{64};
  struct Free {
    void operator()(Pixel* memory) const { ::operator delete(memory, kAlignment); }
  };
  std::unique_ptr<Pixel, Free> buffer_;
  std::size_t capacity_ = 0;
  int width_ = 0, height_ = 0, channels_ = 1;
};

using ImageU8 = Image<std::uint8_t>;
using ImageU16 = Image<std::uint16_t>;

}  // namespace povslam
