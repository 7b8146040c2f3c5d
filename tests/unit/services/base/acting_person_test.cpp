#include "services/base/acting_person.hpp"

#include <cstdlib>

#include <gmock/gmock.h>

namespace dyncal::inline base {
namespace {

using testing::IsEmpty;
using testing::Not;

TEST(ActingPerson, IsOfTheProcessAndOfThisHost) {
  unsetenv("DYNCAL_OPERATOR");
  setenv("LOGNAME", "somebody-else", 1); // an environment proves nothing
  const ActingPerson person = acting_person();
  EXPECT_THAT(person.user, Not(IsEmpty()));
  EXPECT_NE(person.user, "somebody-else");
  EXPECT_THAT(person.host, Not(IsEmpty()));
  EXPECT_EQ(name_of(person), person.user);
  EXPECT_EQ(text_of(person), person.user + " on " + person.host);
}

TEST(ActingPerson, HasTheNameThatIsStated) {
  setenv("DYNCAL_OPERATOR", "B. Meter", 1);
  EXPECT_EQ(acting_person().name, "B. Meter");
  const ActingPerson person = acting_person("A. Meter\nroot");
  EXPECT_EQ(person.name.find('\n'), std::string::npos); // forges no line
  EXPECT_EQ(name_of({"A. Meter", "meter", "lab3"}), "A. Meter");
  EXPECT_EQ(text_of({"A. Meter", "meter", "lab3"}), "A. Meter (meter on lab3)");
  unsetenv("DYNCAL_OPERATOR");
}

} // namespace
} // namespace dyncal::inline base
