// Prints a result with everything that one can hold.
#include <cstdio>

#include <nlohmann/json.hpp>

#include "services/views/report/result_json.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

int main() {
  std::puts(dyncal::views::result_json(dyncal::tests::example_outcome()).dump(1).c_str());
  return 0;
}
