// The numbers of a DCC as text, list by list: read from a certificate, and compared with those that
// the stored run gives. Plain functions, any thread.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/views/certificate/xml_document.hpp"

namespace dyncal::inline views {

// One si:realListXMLList: its lists by the names of their elements ("valueXMLList"), each in items.
using StatedList = std::map<std::string, std::vector<std::string>>;

struct StatedQuantity {
  std::string type; // refType
  std::vector<StatedList> lists;
};

// Quantities by the name of their result ("Transfer function of dau/acceleration_z").
using StatedResults = std::map<std::string, std::vector<StatedQuantity>>;

// `results` is dcc:results. Nothing if a result of dyncal is there twice or has no name.
[[nodiscard]] std::optional<StatedResults> stated_results(const XmlElement& results);

// The first difference as a sentence; nothing: all is the same.
[[nodiscard]] std::optional<std::string> difference_between(const StatedResults& certificate,
                                                            const StatedResults& run);

[[nodiscard]] std::size_t count_of_values(const StatedResults& results);

} // namespace dyncal::inline views
