// Whether a request is meant for this daemon: against pages of others that reach it through the
// browser of somebody who may (DNS rebinding, cross-site requests).
//
// Host may be an address, localhost, or a name of this computer: a foreign page comes with the name
// of its own server. Origin, where a browser sends one, must be the same as Host. Plain functions,
// any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline programs::web {

// `host`: the header Host, "lab-1:8080". `own_names`: without port, in any case.
[[nodiscard]] bool is_own_host(std::string_view host, const std::vector<std::string>& own_names);
// `origin`: the header Origin, "http://lab-1:8080"; empty: there is none.
[[nodiscard]] bool is_own_origin(std::string_view origin, std::string_view host);

} // namespace dyncal::inline programs::web
