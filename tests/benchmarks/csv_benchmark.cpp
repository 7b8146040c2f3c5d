// How fast a CSV file of stamps and four columns of 17 digits becomes numbers. The argument is the number of threads.
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

#include <benchmark/benchmark.h>

#include "services/csv/csv_table.hpp"

namespace {

std::string make_text(std::size_t rows) {
  std::string text = "t_ns,a,b,c,d\n";
  std::mt19937_64 random(1);
  std::normal_distribution<double> value;
  for (std::size_t i = 0; i < rows; ++i) {
    text += std::to_string(1'700'000'000'123'456'789 + static_cast<std::int64_t>(i) * 996'960);
    for (int column = 0; column < 4; ++column) {
      char number[32];
      const auto end = std::to_chars(number, number + sizeof number, value(random)).ptr;
      text += ',';
      text.append(number, end);
    }
    text += '\n';
  }
  return text;
}

void parse(benchmark::State& state) {
  const std::string text = make_text(1'000'000);
  for (auto unused : state) {
    (void)unused;
    const auto table = dyncal::services::parse_csv(text, "text", static_cast<unsigned>(state.range(0)));
    if (!table) std::abort();
    benchmark::DoNotOptimize(table->rows());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}
BENCHMARK(parse)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
