// The metadata of a SigMF recording (NAME.sigmf-meta, JSON; https://sigmf.org): what its data file
// holds, at which rate, and from when on.
//
// A capture begins at core:sample_start of the data. Where it follows a gap, core:global_index says
// which sample of the source it is, or, without that, its core:datetime: rounded to whole samples
// from the captures before. A capture without either follows at once. All samples so have one
// clock, that of the first core:datetime. core:header_bytes are passed over.
//
// Refused by name: data in another file (core:dataset, core:metadata_only), captures that go back.
// core:sha512 and annotations are not looked at. Plain data, any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "drivers/files/tdms/tdms_property.hpp"
#include "drivers/sample_rate.hpp"

namespace dyncal::drivers::files {

struct SigmfCapture {
  std::uint64_t start = 0;               // sample of the data file
  std::uint64_t header_bytes = 0;        // before it, in the data file
  std::optional<std::uint64_t> number{}; // core:global_index
  std::optional<std::int64_t> unix_ns{}; // core:datetime
};

struct SigmfMeta {
  std::string datatype;
  TdmsType type = TdmsType::i16; // of one number
  bool is_complex = false;
  bool big_endian = false;
  std::uint64_t channels = 1;
  std::uint64_t trailing_bytes = 0;
  std::optional<double> sample_rate_hz{};
  std::string hardware;
  std::vector<SigmfCapture> captures; // one at least

  // Fails with the problem in one sentence that names the place, for the caller to say in which
  // file.
  [[nodiscard]] static tl::expected<SigmfMeta, std::string> of(std::string_view text);
};

// "2024-01-01T00:00:00.123Z", as nanoseconds since 1970; digits beyond the ninth are cut off.
[[nodiscard]] std::optional<std::int64_t> sigmf_unix_ns(std::string_view text);

// The number of the first sample of every capture, counted from the first capture's on. Fails with
// the problem in one sentence.
[[nodiscard]] tl::expected<std::vector<std::uint64_t>, std::string>
sigmf_numbers(const SigmfMeta& meta, const SampleRate& rate);

} // namespace dyncal::drivers::files
