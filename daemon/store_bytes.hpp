// Numbers to bytes and back, little-endian whatever the machine. Reading trusts no length: what does not fit gives
// zeros and ok() = false from then on.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace povslam {

using Bytes = std::vector<std::uint8_t>;

template <class T>
concept PlainNumber = std::integral<T> || std::floating_point<T>;

class ByteWriter {
 public:
  explicit ByteWriter(Bytes& out) : out_(out) { out_.clear(); }

  template <PlainNumber T>
  void number(T value) {
    numbers(std::span<const T>(&value, 1));
  }
  template <PlainNumber T>
  void numbers(std::span<const T> values) {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t at = out_.size();
    out_.resize(at + values.size_bytes());
    if (!values.empty()) std::memcpy(out_.data() + at, values.data(), values.size_bytes());
  }
  // LEB128: seven bits a byte, the top bit says that more follow.
  void varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7U) out_.push_back(static_cast<std::uint8_t>(value | 0x80U));
    out_.push_back(static_cast<std::uint8_t>(value));
  }

 private:
  Bytes& out_;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <PlainNumber T>
  T number() {
    T value{};
    numbers(std::span<T>(&value, 1));
    return value;
  }
  template <PlainNumber T>
  void numbers(std::span<T> values) {
    static_assert(std::endian::native == std::endian::little);
    if (!take(values.size_bytes())) return;
    if (!values.empty()) std::memcpy(values.data(), bytes_.data() + at_ - values.size_bytes(), values.size_bytes());
  }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = number<std::uint8_t>();
      if (shift == 63 && byte > 1) break;
      value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if (byte < 0x80) return value;
    }
    ok_ = false;
    return 0;
  }

  void fail() { ok_ = false; }  // what was read cannot be
  std::size_t left() const { return ok_ ? bytes_.size() - at_ : 0; }
  bool ok() const { return ok_; }
  bool at_end() const { return ok_ && at_ == bytes_.size(); }

 private:
  bool take(std::size_t count) {
    ok_ = ok_ && count <= bytes_.size() - at_;
    if (ok_) at_ += count;
    return ok_;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace povslam
