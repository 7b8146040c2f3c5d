// A text that a reader of JSON goes through from its beginning to its end, counted meanwhile, for
// such readers tell nobody how far they are: parts of 64 KB. One thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>

#include "services/base/byte_count.hpp"

namespace dyncal::inline base {

class CountedText {
public:
  class Iterator {
  public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    Iterator(const char* at, const char* end, ByteCount* count)
        : at_(at), part_end_(at), end_(end), count_(count) {
      begin_part();
    }
    reference operator*() const { return *at_; }
    Iterator& operator++() {
      if (++at_ == part_end_) {
        count_->add_done(static_cast<std::uint64_t>(part_end_ - part_));
        begin_part();
      }
      return *this;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

  private:
    void begin_part() {
      constexpr std::ptrdiff_t whole = 1U << 16U;
      part_ = part_end_;
      part_end_ += std::min(whole, end_ - part_end_);
    }

    const char* at_;
    const char* part_ = nullptr;
    const char* part_end_;
    const char* end_;
    ByteCount* count_;
  };

  // Both outlive the object; several texts add up in `count`.
  CountedText(std::string_view text, ByteCount& count) : text_(text), count_(&count) {}

  [[nodiscard]] Iterator begin() const { return {text_.data(), text_end(), count_}; }
  [[nodiscard]] Iterator end() const { return {text_end(), text_end(), count_}; }

private:
  [[nodiscard]] const char* text_end() const { return text_.data() + text_.size(); }

  std::string_view text_;
  ByteCount* count_;
};

} // namespace dyncal::inline base
