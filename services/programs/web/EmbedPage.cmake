# Writes the files of a folder into a C++ source, as arrays of bytes:
#   cmake -D FOLDER=page -D FILE=page_files.cpp -P EmbedPage.cmake
file(GLOB names RELATIVE ${FOLDER} ${FOLDER}/*)
list(SORT names)
set(arrays "")
set(rows "")
set(number 0)
foreach(name ${names})
  if(IS_DIRECTORY ${FOLDER}/${name})
    continue()
  endif()
  file(READ ${FOLDER}/${name} bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "constexpr unsigned char file_${number}[] = {${bytes}0};\n")
  string(APPEND rows "    {\"${name}\", reinterpret_cast<const char*>(file_${number}), "
    "sizeof(file_${number}) - 1},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${FILE}.new "// Made by EmbedPage.cmake.
#include \"services/programs/web/page_files.hpp\"

namespace dyncal::inline programs::web {
namespace {

${arrays}
} // namespace

std::vector<PageFile> page_files() {
  return {
${rows}  };
}

} // namespace dyncal::inline programs::web
")
file(COPY_FILE ${FILE}.new ${FILE} ONLY_IF_DIFFERENT)
