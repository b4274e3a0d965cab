# Run by V2vouchEmbed.cmake: writes OUT from FILES.
set(arrays "")
set(table "")
set(index 0)
foreach(file ${FILES})
  get_filename_component(name "${file}" NAME)
  get_filename_component(ending "${file}" LAST_EXT)
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(REGEX REPLACE "(................................................................................)" "\\1\n" bytes "${bytes}")
  set(path "/${name}")
  set(type "text/javascript; charset=utf-8")
  if(ending STREQUAL ".html")
    set(path "/")
    set(type "text/html; charset=utf-8")
  elseif(ending STREQUAL ".css")
    set(type "text/css; charset=utf-8")
  endif()
  string(APPEND arrays "constexpr unsigned char kFile${index}[] = {\n${bytes}};\n")
  string(APPEND table "    {\"${path}\", \"${type}\", {reinterpret_cast<const char*>(kFile${index}), sizeof kFile${index}}},\n")
  math(EXPR index "${index} + 1")
endforeach()
file(WRITE "${OUT}" "// Written by scripts/cmake/V2vouchEmbedWrite.cmake.
#include \"daemon/rim/page/page_files.h\"

namespace v2vouch {
namespace {
${arrays}}  // namespace

std::span<const PageFile> PageFiles() {
  static const PageFile kFiles[] = {
${table}  };
  return kFiles;
}

}  // namespace v2vouch
")
