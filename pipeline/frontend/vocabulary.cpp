#include "pipeline/frontend/vocabulary.hpp"

#include <cstring>

#include "pipeline/base/expects.hpp"
#include "pipeline/frontend/vocabulary_data.hpp"

namespace povslam {

// FNV-1a over 64-bit words.
std::uint64_t vocabulary_fingerprint(std::uint32_t branching, std::uint32_t levels,
                                     std::span<const std::byte> content) {
  std::uint64_t hash = 0xCBF29CE484222325;
  const auto add = [&hash](std::uint64_t value) { hash = (hash ^ value) * 0x100000001B3; };
  add(static_cast<std::uint64_t>(branching) << 32 | levels);
  for (std::size_t i = 0; i < content.size(); i += 8) {
    std::uint64_t value = 0;
    std::memcpy(&value, content.data() + i, std::min<std::size_t>(8, content.size() - i));
    add(value);
  }
  return hash;
}

Result<Vocabulary> Vocabulary::view(std::span<const std::byte> bytes) {
  constexpr std::uint64_t kMaxWords = 1 << 24;
  const auto bad = [](const char* what) { return Error{std::string("vocabulary: ") + what}; };
  VocabularyHeader header;
  if (bytes.size() < sizeof header) return bad("shorter than its header");
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(Descriptor) != 0) return bad("not 8-byte aligned");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != kVocabularyMagic) return bad("no vocabulary, or one of another version");
  if (header.branching < 2 || header.branching > 256 || header.levels < 1) return bad("its tree has no words");
  std::uint64_t nodes = 0, words = 1;
  for (std::uint32_t level = 0; level < header.levels; ++level) {
    words *= header.branching;
    nodes += words;
    if (words > kMaxWords) return bad("its tree is too large");
  }
  const std::span<const std::byte> content = bytes.subspan(sizeof header);
  if (content.size() != nodes * sizeof(Descriptor) + words) return bad("its size is not that of its tree");
  if (vocabulary_fingerprint(header.branching, header.levels, content) != header.fingerprint) return bad("damaged");
  Vocabulary v;
  v.branching_ = header.branching;
  v.levels_ = header.levels;
  v.num_words_ = static_cast<std::uint32_t>(words);
  v.fingerprint_ = header.fingerprint;
  v.nodes_ = {reinterpret_cast<const Descriptor*>(content.data()), static_cast<std::size_t>(nodes)};
  v.surprise_ = {reinterpret_cast<const std::uint8_t*>(content.data() + nodes * sizeof(Descriptor)), words};
  return v;
}

const Vocabulary& Vocabulary::shipped() {
  static const Vocabulary vocabulary = [] {
    auto built_in = view(vocabulary_data());
    EXPECTS(built_in);
    return *built_in;
  }();
  return vocabulary;
}

std::uint32_t Vocabulary::word(const Descriptor& descriptor) const {
  std::size_t level_begin = 0, level_size = branching_, best = 0;
  for (std::uint32_t level = 0; level < levels_; ++level) {
    const std::size_t first_child = best * branching_;
    const Descriptor* children = nodes_.data() + level_begin + first_child;
    best = first_child +
           static_cast<std::size_t>(nearest_descriptor(descriptor, children, static_cast<int>(branching_)).index);
    level_begin += level_size;
    level_size *= branching_;
  }
  return static_cast<std::uint32_t>(best);
}

void Vocabulary::words(std::span<const Descriptor> descriptors, std::span<std::uint32_t> words) const {
  EXPECTS(words.size() == descriptors.size());
  for (std::size_t i = 0; i < descriptors.size(); ++i) words[i] = word(descriptors[i]);
}

}  // namespace povslam
