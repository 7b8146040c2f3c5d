# A step of the build: from what fastddsgen makes of the contract to C++ types that name no DDS
# library, so that whoever includes them needs none.
#
# - fixed strings of a library become dyncal::wire::BoundedString
# - functions that encode become templates over the encoder, which are made for Fast CDR in the
#   source alone
# - marks for other systems go
#
#   cmake -Dfrom=DIR -Dto=DIR -P plain_types.cmake
#
# Reads from/dyncal.h and from/dyncal.cxx, writes files of the same names. What it does not find as
# it expects it (another version of fastddsgen) is an error, and not a header with a name left in.
# The notice of copyright in these files stands in idl/COPYRIGHT, which is installed with the IDL.
cmake_minimum_required(VERSION 3.25)

set(made "// The contract in C++, made from dyncal.idl when dyncal was built.
// Copyright and licence of what made it: COPYRIGHT beside dyncal.idl.\n")
set(encoder "eprosima::fastcdr::Cdr")
set(encoding "serialize|deserialize|serializeKey")

# Replaces and counts: nothing to replace is an error.
function(rewrite text pattern by)
  if(NOT "${${text}}" MATCHES "${pattern}")
    message(FATAL_ERROR "fastddsgen has made other C++ than idl/plain_types.cmake knows: nothing "
      "matches ${pattern}")
  endif()
  string(REGEX REPLACE "${pattern}" "${by}" replaced "${${text}}")
  set(${text} "${replaced}" PARENT_SCOPE)
endfunction()

file(READ ${from}/dyncal.h header)
rewrite(header "^.*#ifndef _FAST_DDS_GENERATED_[A-Z_]+\n#define _FAST_DDS_GENERATED_[A-Z_]+\n"
  "${made}#pragma once\n")
rewrite(header "\n#if defined\\(_WIN32\\).*} // namespace eprosima\n" "")
rewrite(header "#endif // _FAST_DDS_GENERATED_[A-Z_]+" "")
rewrite(header "#include <fastrtps/utils/fixed_size_string.hpp>"
  "#include \"idl/bounded_string.hpp\"")
rewrite(header "eprosima::fastrtps::fixed_string<" "dyncal::wire::BoundedString<")
rewrite(header "eProsima_user_DllExport " "")
rewrite(header "void (${encoding})\\(\n *${encoder}& cdr\\)"
  "template <class Cdr>\n            void \\1(Cdr& cdr)")
string(TOLOWER "${header}" lower)
if(lower MATCHES "(eprosima|fast_?dds|fast_?rtps|fastcdr)")
  message(FATAL_ERROR "idl/plain_types.cmake leaves '${CMAKE_MATCH_1}' in dyncal.h")
endif()

file(READ ${from}/dyncal.cxx source)
rewrite(source "^.*#include \"dyncal.h\"" "${made}#include \"dyncal.h\"")
rewrite(source "eprosima::fastrtps::fixed_string<" "dyncal::wire::BoundedString<")
# Names of Java objects, other ones every time.
rewrite(source " *// m_[a-z0-9_]+ com\\.eprosima[^\n]*\n" "")
set(encoders "void dyncal::wire::[A-Za-z]+::(${encoding})\\(\n *${encoder}& [sd]cdr\\)( const)?")
string(REGEX MATCHALL "${encoders}" functions "${source}")
rewrite(source "void (dyncal::wire::[A-Za-z]+::(${encoding}))\\(\n *${encoder}& ([sd]cdr)\\)"
  "template <class Cdr>\nvoid \\1(Cdr& \\3)")
foreach(function IN LISTS functions)
  string(APPEND source "template ${function};\n")
endforeach()

file(WRITE ${from}/plain/dyncal.h "${header}")
file(WRITE ${from}/plain/dyncal.cxx "${source}")
foreach(file dyncal.h dyncal.cxx) # keep their time where nothing has changed
  file(COPY_FILE ${from}/plain/${file} ${to}/${file} ONLY_IF_DIFFERENT)
endforeach()
