#include "services/evaluation/result/run_pause.hpp"

namespace dyncal::inline evaluation {
namespace {

bool is_open(const std::vector<RunPause>& pauses) {
  return !pauses.empty() && pauses.back().ended_utc_ns == 0;
}

std::string without_digits(std::string sentence) {
  std::erase_if(sentence, [](char character) { return character >= '0' && character <= '9'; });
  return sentence;
}

} // namespace

bool is_same_reason(const std::string& one, const std::string& other) {
  return without_digits(one) == without_digits(other);
}

void note_pause(std::vector<RunPause>& pauses, std::int64_t now_utc_ns, const std::string& reason) {
  if (is_open(pauses) && is_same_reason(pauses.back().reason, reason)) {
    return;
  }
  end_pause(pauses, now_utc_ns);
  pauses.push_back({now_utc_ns, 0, reason});
}

void end_pause(std::vector<RunPause>& pauses, std::int64_t now_utc_ns) {
  if (is_open(pauses)) {
    pauses.back().ended_utc_ns = now_utc_ns;
  }
}

} // namespace dyncal::inline evaluation
