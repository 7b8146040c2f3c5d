# Writes the commit of the checkout at SOURCE into the header FILE, only if it has changed: so that
# a build in which HEAD has not moved compiles nothing. Outside a checkout the commit is empty.
#
#   cmake -D SOURCE=... -D FILE=... [-D GIT=...] -P WriteCommit.cmake
cmake_minimum_required(VERSION 3.25)

set(commit "")
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(
    COMMAND ${GIT} --no-optional-locks describe --always --dirty --exclude *
    WORKING_DIRECTORY ${SOURCE}
    OUTPUT_VARIABLE commit
    OUTPUT_STRIP_TRAILING_WHITESPACE
    ERROR_QUIET)
endif()
file(CONFIGURE OUTPUT ${FILE} @ONLY CONTENT [[
#pragma once

#include <string_view>

namespace dyncal::inline base {

inline constexpr std::string_view commit = "@commit@";

} // namespace dyncal::inline base
]])
