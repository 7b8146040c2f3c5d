// The names of toml++ alone, which are all that headers need: its whole header takes a second to
// compile.
#pragma once

#if __has_include(<toml++/impl/forward_declarations.hpp>)
#include <toml++/impl/forward_declarations.hpp> // 3.4
#else
#include <toml++/impl/forward_declarations.h>
#endif
