#include "pipeline/frontend/place_index.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/base/expects.hpp"

namespace povslam {

namespace {
constexpr float kSaturation = 1.2F;       // BM25's k1: a word seen often counts little more than once
constexpr float kLength = 0.75F;          // BM25's b: a keyframe with many words shares some with everything
constexpr float kBelievedImages = 30.0F;  // as so many keyframes of its own the map takes what training saw

// How much a word counts by how often it is there.
constexpr std::array<float, 256> kSaturated = [] {
  std::array<float, 256> table{};
  for (std::size_t count = 0; count < table.size(); ++count) {
    const float n = static_cast<float>(count);
    table[count] = n * (kSaturation + 1.0F) / (n + kSaturation);
  }
  return table;
}();
}  // namespace

PlaceIndex::PlaceIndex(const Vocabulary& vocabulary, int max_keyframes, int max_features)
    : vocabulary_(vocabulary), max_features_(static_cast<std::size_t>(max_features)) {
  EXPECTS(max_keyframes > 0 && max_keyframes < (1 << 24) && max_features > 0);
  const std::size_t slots = static_cast<std::size_t>(max_keyframes);
  // Each list has one block that is not full.
  const std::size_t blocks = 1 + vocabulary.num_words() + slots * max_features_ / kPerBlock;
  lists_.resize(vocabulary.num_words());
  blocks_ = std::make_unique_for_overwrite<Block[]>(blocks);
  free_blocks_.reserve(blocks);
  entries_.resize(slots);
  words_of_ = std::make_unique_for_overwrite<std::uint32_t[]>(slots * max_features_);
  sorted_.reserve(max_features_);
  counted_.reserve(max_features_);
  scores_.resize(slots);
  open_.resize(slots);
}

const PlaceIndex::Entry& PlaceIndex::entry(std::int32_t slot) const {
  EXPECTS(slot >= 0 && static_cast<std::size_t>(slot) < entries_.size());
  return entries_[static_cast<std::size_t>(slot)];
}

std::span<const PlaceIndex::Counted> PlaceIndex::count_words(std::span<const std::uint32_t> words) {
  sorted_.assign(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(std::min(words.size(), max_features_)));
  std::ranges::sort(sorted_);
  counted_.clear();
  for (const std::uint32_t word : sorted_) {
    EXPECTS(word < vocabulary_.num_words());
    if (counted_.empty() || counted_.back().word != word) counted_.push_back({word, 0});
    ++counted_.back().count;
  }
  return counted_;
}

void PlaceIndex::add(std::int32_t slot, std::span<const std::uint32_t> words) {
  remove(slot);
  std::uint32_t* const own = words_of_.get() + static_cast<std::size_t>(slot) * max_features_;
  Entry& made = entries_[static_cast<std::size_t>(slot)];
  made = {false, 0};
  for (const Counted& counted : count_words(words)) {
    insert(counted.word, static_cast<std::uint32_t>(slot) << 8 | std::min<std::uint32_t>(counted.count, 255));
    own[made.num_words++] = counted.word;
  }
  total_words_ += made.num_words;
  ++size_;
}

void PlaceIndex::remove(std::int32_t slot) {
  if (entry(slot).empty) return;
  Entry& gone = entries_[static_cast<std::size_t>(slot)];
  const std::uint32_t* const own = words_of_.get() + static_cast<std::size_t>(slot) * max_features_;
  for (std::uint32_t i = 0; i < gone.num_words; ++i) erase(own[i], slot);
  total_words_ -= gone.num_words;
  gone = {};
  open_[static_cast<std::size_t>(slot)] = 0;
  --size_;
}

void PlaceIndex::insert(std::uint32_t word, std::uint32_t posting) {
  List& list = lists_[word];
  if (list.head == 0 || list.used == kPerBlock) {
    std::uint32_t block = blocks_touched_;
    if (free_blocks_.empty()) {
      ++blocks_touched_;
    } else {
      block = free_blocks_.back();
      free_blocks_.pop_back();
    }
    blocks_[block].next = list.head;
    list.head = block;
    list.used = 0;
  }
  blocks_[list.head].posting[list.used++] = posting;
  ++list.size;
}

// The newest posting takes the place of the one that goes.
void PlaceIndex::erase(std::uint32_t word, std::int32_t slot) {
  List& list = lists_[word];
  std::uint32_t used = list.used;
  for (std::uint32_t block = list.head; block != 0; block = blocks_[block].next, used = kPerBlock) {
    for (std::uint32_t i = 0; i < used; ++i) {
      std::uint32_t& posting = blocks_[block].posting[i];
      if (posting >> 8 != static_cast<std::uint32_t>(slot)) continue;
      posting = blocks_[list.head].posting[--list.used];
      --list.size;
      if (list.used > 0) return;
      free_blocks_.push_back(list.head);
      list.head = blocks_[list.head].next;
      list.used = list.head == 0 ? 0 : kPerBlock;
      return;
    }
  }
  EXPECTS(false);
}

// ln(1 / share of the keyframes that hold the word).
float PlaceIndex::rarity(std::uint32_t word) const {
  const float in_training = std::exp(-vocabulary_.idf(word));
  const float holding = static_cast<float>(lists_[word].size) + kBelievedImages * in_training;
  return std::log((static_cast<float>(size_) + kBelievedImages + 1.0F) / (holding + 0.5F));
}

void PlaceIndex::query(std::span<const std::uint32_t> words) {
  const std::size_t slots = entries_.size();
  std::ranges::fill(scores_, 0.0F);
  const std::span<const Counted> asked = count_words(words);
  float itself = 0.0F;
  for (const Counted& counted : asked) {
    const float asked_for = kSaturated[std::min<std::uint32_t>(counted.count, 255)];
    const float once = std::max(0.0F, rarity(counted.word)) * asked_for;
    itself += once * asked_for;
    const List& list = lists_[counted.word];
    std::uint32_t used = list.used;
    for (std::uint32_t block = list.head; block != 0; block = blocks_[block].next, used = kPerBlock) {
      for (std::uint32_t i = 0; i < used; ++i) {
        const std::uint32_t posting = blocks_[block].posting[i];
        scores_[posting >> 8] += once * kSaturated[posting & 255U];
      }
    }
  }
  const float mean = size_ > 0 ? static_cast<float>(total_words_) / static_cast<float>(size_) : 1.0F;
  for (std::size_t slot = 0; slot < slots; ++slot) {
    open_[slot] = entries_[slot].empty ? 0 : 1;
    if (open_[slot] == 0 || scores_[slot] <= 0.0F) continue;
    const float longer = 1.0F + kLength * (static_cast<float>(entries_[slot].num_words) / std::max(mean, 1.0F) - 1.0F);
    scores_[slot] = std::min(1.0F, scores_[slot] / (itself * longer));
  }
}

void PlaceIndex::leave_out(std::int32_t slot) {
  open_[static_cast<std::size_t>(slot)] = 0;
}

std::optional<PlaceIndex::Candidate> PlaceIndex::next() {
  Candidate best;
  for (std::size_t slot = 0; slot < open_.size(); ++slot) {
    if (open_[slot] != 0 && scores_[slot] > best.score) best = {static_cast<std::int32_t>(slot), scores_[slot]};
  }
  if (best.keyframe < 0) return std::nullopt;
  leave_out(best.keyframe);
  return best;
}

}  // namespace povslam
