// Whether two addresses of a generator, HOST:PORT as bench files give them, may lead to one
// instrument. They are compared as they are written; one of the loopback interface may be any
// host's own and is taken for the same. Plain function, any thread.
#pragma once

#include <string>

namespace dyncal::inline bench {

[[nodiscard]] bool may_be_one_generator(const std::string& first, const std::string& second);

} // namespace dyncal::inline bench
