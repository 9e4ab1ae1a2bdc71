#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/bytes_of.h"

namespace palpate {

/// Marks on ids, three bits each (values 1, 2 and 4), for sets that a frame finds in any order and then wants
/// by ascending id: marking an id twice costs nothing more, and ids need no sorting. All of it is so small
/// that what is asked again and again stays in the caches. Only resize() allocates.
class IdMarks {
 public:
  /// From now on for ids below `ids`, none marked.
  void resize(std::size_t ids) {
    words_.assign((ids + 63) / 64, Word{});
    any_.assign((words_.size() + 63) / 64, 0);
  }
  /// Costs little where nothing is marked.
  void clear() {
    take_all([](std::uint32_t, std::uint32_t) {});
  }
  /// `mark`: 1, 2 or 4.
  void add(std::uint32_t id, std::uint32_t mark) {
    Word& word = words_[id >> 6];
    if (word.all() == 0) any_[id >> 12] |= std::uint64_t{1} << (id >> 6 & 63);
    word.marks[mark >> 1] |= std::uint64_t{1} << (id & 63);
  }
  std::uint64_t bytes() const { return bytes_of(words_) + bytes_of(any_); }
  /// All of an id's, 0: none.
  std::uint32_t marks(std::uint32_t id) const { return words_[id >> 6].of(id & 63); }

  /// Calls take(id, marks) for all that have a mark, ascending, and unmarks them, as long as they are in the
  /// caches.
  template <class Take>
  void take_all(Take&& take) {
    for (std::size_t w = next_word(0); w != words_.size(); w = next_word(w + 1)) {
      Word& word = words_[w];
      for (std::uint64_t left = word.all(); left != 0; left &= left - 1) {
        const auto bit = static_cast<std::uint32_t>(std::countr_zero(left));
        take(static_cast<std::uint32_t>(64 * w) + bit, word.of(bit));
      }
      word = Word{};
      any_[w >> 6] &= ~(std::uint64_t{1} << (w & 63));
    }
  }

 private:
  struct Word {                            // of 64 ids
    std::array<std::uint64_t, 3> marks{};  ///< of value 1, 2 and 4
    std::uint64_t all() const { return marks[0] | marks[1] | marks[2]; }
    std::uint32_t of(std::uint32_t bit) const {
      const auto mark = [&](std::size_t i) { return static_cast<std::uint32_t>(marks[i] >> bit & 1) << i; };
      return mark(0) | mark(1) | mark(2);
    }
  };
  /// The first word from `w` on with a mark, or their number.
  std::size_t next_word(std::size_t w) const {
    if (w >= words_.size()) return words_.size();
    std::uint64_t left = any_[w >> 6] >> (w & 63) << (w & 63);
    for (w >>= 6; left == 0; left = any_[w])
      if (++w == any_.size()) return words_.size();
    return 64 * w + static_cast<std::size_t>(std::countr_zero(left));
  }

  std::vector<Word> words_;
  std::vector<std::uint64_t> any_;  ///< a bit a word: it has a mark
};

}  // namespace palpate
