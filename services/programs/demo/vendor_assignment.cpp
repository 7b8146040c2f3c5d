#include "services/programs/demo/vendor_assignment.hpp"

#include <sstream>

#include <fmt/core.h>

#include "services/bus/bus.hpp"

namespace dyncal::inline programs {

Expected<std::map<std::string, std::string>> parse_vendor_assignment(const std::string& text) {
  const auto vendors = bus::vendors_in_this_build();
  const std::string usual = vendors.empty() ? "" : bus::to_string(vendors.front());
  std::map<std::string, std::string> words{
      {"dau", usual}, {"acs", usual}, {"analysis", usual}, {"run", usual}};
  std::istringstream parts(text);
  std::string part;
  while (std::getline(parts, part, ',')) {
    const std::size_t equals = part.find('=');
    const std::string service = equals == std::string::npos ? "" : part.substr(0, equals);
    const std::string word = equals == std::string::npos ? part : part.substr(equals + 1);
    DYNCAL_TRY(bus::parse_vendor(word));
    if (service.empty()) {
      for (auto& entry : words) {
        entry.second = word;
      }
    } else if (words.contains(service)) {
      words[service] = word;
    } else {
      return fail(
          ErrorCode::bad_argument,
          fmt::format("--dds names the service '{}', but a demo has: acs, analysis, dau, run",
                      service));
    }
  }
  return words;
}

} // namespace dyncal::inline programs
