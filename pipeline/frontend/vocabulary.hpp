// Words for looks: a tree of 256-bit descriptors whose leaves are the words (Nister and Stewenius, CVPR 2006; for
// binary descriptors Galvez-Lopez and Tardos, T-RO 2012). Two looks at one point often are the same word.
// What ships is built into the program; how it was made: docs/place_recognition.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/base/result.hpp"
#include "pipeline/frontend/orb.hpp"

namespace povslam {

// A view of bytes that somebody else keeps. Constant: may be shared between threads.
//
// The bytes, little-endian, 8-byte aligned:
//   header       VocabularyHeader
//   nodes        Descriptor, level by level below the root, each node's children together; every node has `branching`
//                of them (where training found fewer, the rest repeat the first, which wins)
//   surprise     uint8 a word: ln(images / images that hold the word) in steps of kVocabularyStep, in training
struct VocabularyHeader {
  std::uint64_t magic = 0;
  std::uint32_t branching = 0, levels = 0;  // branching ^ levels words
  std::uint64_t fingerprint = 0;            // of all that follows, see vocabulary_fingerprint()
};
inline constexpr std::uint64_t kVocabularyMagic = 0x31434F5653564F50;  // "POVSVOC1"
inline constexpr float kVocabularyStep = 1.0F / 24.0F;
std::uint64_t vocabulary_fingerprint(std::uint32_t branching, std::uint32_t levels, std::span<const std::byte> content);

class Vocabulary {
 public:
  static const Vocabulary& shipped();
  // Refuses what is none, or damaged.
  static Result<Vocabulary> view(std::span<const std::byte> bytes);

  std::uint32_t word(const Descriptor& descriptor) const;
  void words(std::span<const Descriptor> descriptors, std::span<std::uint32_t> words) const;  // of one length
  float idf(std::uint32_t word) const { return kVocabularyStep * static_cast<float>(surprise_[word]); }
  std::uint32_t num_words() const { return num_words_; }
  std::uint64_t fingerprint() const { return fingerprint_; }  // words of two vocabularies do not compare

 private:
  Vocabulary() = default;

  std::uint32_t branching_ = 0, levels_ = 0, num_words_ = 0;
  std::uint64_t fingerprint_ = 0;
  std::span<const Descriptor> nodes_;
  std::span<const std::uint8_t> surprise_;
};

}  // namespace povslam
