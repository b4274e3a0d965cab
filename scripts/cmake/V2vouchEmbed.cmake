# v2vouch_embed_page(OUT file...): a source file that holds the files of a page, written at build
# time (V2vouchEmbedWrite.cmake); index.html is served as "/".
function(v2vouch_embed_page out)
  set(files "")
  foreach(file ${ARGN})
    list(APPEND files "${CMAKE_CURRENT_SOURCE_DIR}/${file}")
  endforeach()
  set(writer "${PROJECT_SOURCE_DIR}/scripts/cmake/V2vouchEmbedWrite.cmake")
  add_custom_command(
    OUTPUT "${out}"
    COMMAND "${CMAKE_COMMAND}" "-DOUT=${out}" "-DFILES=${files}" -P "${writer}"
    DEPENDS ${files} "${writer}"
    COMMENT "page into ${out}" VERBATIM)
endfunction()
