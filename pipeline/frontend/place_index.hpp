// Which keyframes look like this frame: an inverted index from words to keyframes, scored as in BM25 (Robertson and
// Zaragoza, 2009) with the words' rarity as learned from this map itself; where it is small, from the vocabulary.
// Capacity fixed at construction, no allocation afterwards. One thread. The same calls give the same answers.
//
//   index.query(words);
//   index.leave_out(slot);                          // of this query: what is known to be near anyway
//   while (const auto likely = index.next()) {      // best first
//     …look at it…;  index.leave_out(neighbour);    // its covisible keyframes are the same place
//   }
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/frontend/vocabulary.hpp"

namespace povslam {

class PlaceIndex {
 public:
  // The vocabulary must outlive it. Slots are those of the map: 0 … max_keyframes - 1.
  PlaceIndex(const Vocabulary& vocabulary, int max_keyframes, int max_features);

  void add(std::int32_t slot, std::span<const std::uint32_t> words);  // one word a feature; replaces what was there
  void remove(std::int32_t slot);                                     // nothing there: no effect
  bool contains(std::int32_t slot) const { return !entry(slot).empty; }
  int size() const { return size_; }
  const Vocabulary& vocabulary() const { return vocabulary_; }

  struct Candidate {
    std::int32_t keyframe = -1;  // slot
    float score = 0.0F;          // 1: has the same words, 0: none in common
  };
  void query(std::span<const std::uint32_t> words);  // may be more than max_features; the rest counts for nothing
  void leave_out(std::int32_t slot);
  std::optional<Candidate> next();  // each keyframe at most once a query
  float score(std::int32_t slot) const { return scores_[static_cast<std::size_t>(slot)]; }  // of the last query

 private:
  // Keyframes that hold a word: a list of blocks, each full but the first.
  static constexpr int kPerBlock = 15;
  struct Block {
    std::uint32_t next = 0;
    std::uint32_t posting[kPerBlock] = {};  // slot << 8 | how often, 255 at most
  };
  struct List {
    std::uint32_t head = 0;  // block; 0: none
    std::uint32_t used = 0;  // of the first block
    std::uint32_t size = 0;  // keyframes
  };
  struct Entry {
    bool empty = true;
    std::uint32_t num_words = 0;  // distinct ones
  };
  struct Counted {
    std::uint32_t word = 0, count = 0;
  };
  const Entry& entry(std::int32_t slot) const;
  std::span<const Counted> count_words(std::span<const std::uint32_t> words);
  void insert(std::uint32_t word, std::uint32_t posting);
  void erase(std::uint32_t word, std::int32_t slot);
  float rarity(std::uint32_t word) const;

  const Vocabulary& vocabulary_;
  std::size_t max_features_;
  std::vector<List> lists_;          // by word
  std::unique_ptr<Block[]> blocks_;  // 0 is none
  std::vector<std::uint32_t> free_blocks_;
  std::uint32_t blocks_touched_ = 1;
  std::vector<Entry> entries_;                 // by slot
  std::unique_ptr<std::uint32_t[]> words_of_;  // distinct words, max_features_ a slot
  std::vector<std::uint32_t> sorted_;          // scratch
  std::vector<Counted> counted_;               // scratch
  std::vector<float> scores_;                  // by slot, of the last query
  std::vector<std::uint8_t> open_;             // by slot: may still be an answer
  std::int64_t total_words_ = 0;               // distinct words of all entries
  int size_ = 0;
};

}  // namespace povslam
