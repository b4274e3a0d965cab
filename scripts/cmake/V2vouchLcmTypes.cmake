# v2vouch_add_lcm_types(TARGET file.lcm...): header-only C++ bindings made by lcm-gen.
function(v2vouch_add_lcm_types target)
  set(out "${CMAKE_CURRENT_BINARY_DIR}/include")
  set(headers "")
  set(files "")
  foreach(file ${ARGN})
    get_filename_component(type "${file}" NAME_WE)
    set(header "${out}/v2vouch/${type}.hpp")
    add_custom_command(
      OUTPUT "${header}"
      COMMAND "${LCM_GEN}" --cpp --cpp-std c++11 --cpp-hpath "${out}" "${file}"
      DEPENDS "${file}"
      WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
      COMMENT "lcm-gen ${file}" VERBATIM)
    list(APPEND headers "${header}")
    list(APPEND files "${CMAKE_CURRENT_SOURCE_DIR}/${file}")
  endforeach()
  add_custom_target(${target}_headers DEPENDS ${headers})
  set_target_properties(${target}_headers PROPERTIES V2VOUCH_LCM_FILES "${files}")
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}_headers)
  target_include_directories(${target} SYSTEM INTERFACE "${out}")
  target_link_libraries(${target} INTERFACE PkgConfig::LCM)
endfunction()
