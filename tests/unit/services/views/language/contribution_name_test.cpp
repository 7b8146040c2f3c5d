#include "services/views/language/contribution_name.hpp"

#include <set>

#include <gtest/gtest.h>

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline views {
namespace {

using analysis::Contribution;
using analysis::ContributionKind;

TEST(ContributionName, IsInTheWordsOfTheField) {
  EXPECT_EQ(contribution_name({.kind = ContributionKind::fit_noise, .subject = "the DAU sync"},
                              Language::english),
            "voltage, sync ADC of the acquisition unit, noise");
  EXPECT_EQ(contribution_name({.kind = ContributionKind::mains_hum, .subject = "the reference"},
                              Language::german),
            "Bezugsnormal, Netzbrummen");
  EXPECT_EQ(contribution_name({.kind = ContributionKind::reference}, Language::english),
            "reference transducer, sensitivity");
}

TEST(ContributionName, KeepsWhatAReferenceFileSays) {
  EXPECT_EQ(contribution_name({.kind = ContributionKind::reference, .subject = "base strain"},
                              Language::german),
            "Bezugsnormal, base strain");
  EXPECT_EQ(contribution_name({.kind = ContributionKind::other, .subject = "of a later version"},
                              Language::english),
            "of a later version");
}

TEST(ContributionName, DiffersFromKindToKind) {
  constexpr auto count = number_of_enumerators<ContributionKind>();
  for (const Language language : all_languages) {
    std::set<std::string> names;
    for (std::size_t place = 0; place < count; ++place) {
      names.insert(contribution_name(
          {.kind = static_cast<ContributionKind>(place), .subject = "the sensor"}, language));
    }
    EXPECT_EQ(names.size(), count);
  }
}

} // namespace
} // namespace dyncal::inline views
