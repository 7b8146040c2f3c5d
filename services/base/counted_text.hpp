// A text that a reader of JSON goes through from its beginning to its end, counted meanwhile, for
// such readers tell nobody how far they are: whole parts of 64 KB. One thread.
#pragma once

#include <cstddef>
#include <iterator>
#include <string_view>

#include "services/base/byte_count.hpp"

namespace dyncal::services {

class CountedText {
public:
  class Iterator {
  public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    Iterator(const char* at, ByteCount* count) : at_(at), count_(count) {}
    reference operator*() const { return *at_; }
    Iterator& operator++() {
      constexpr std::size_t part = 1U << 16U;
      ++at_;
      if (++read_ == part) {
        count_->add_done(read_);
        read_ = 0;
      }
      return *this;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

  private:
    const char* at_;
    ByteCount* count_;
    std::size_t read_ = 0;
  };

  // Both outlive the object; several texts add up in `count`.
  CountedText(std::string_view text, ByteCount& count) : text_(text), count_(&count) {}

  [[nodiscard]] Iterator begin() const { return {text_.data(), count_}; }
  [[nodiscard]] Iterator end() const { return {text_.data() + text_.size(), count_}; }

private:
  std::string_view text_;
  ByteCount* count_;
};

} // namespace dyncal::services
