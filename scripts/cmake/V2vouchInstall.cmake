# What `cmake --install` puts where, in components that become packages: `programs` (daemon and tools),
# `viewer`, `dev` (message types and wire library for other people's programs).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Source folder of each folder below share/v2vouch (daemon/rim/program/shipped_folder.h).
set(V2VOUCH_SHIPPED scenarios sim/scenarios attacks sim/attacks/catalogue config daemon/vehicles
                    lcmtypes lcmtypes)

function(v2vouch_install_program name)
  if(NOT name MATCHES "^v2vouch")
    return()  # Studies and benchmarks stay in the build tree.
  endif()
  set(component programs)
  if(name STREQUAL v2vouch-view)
    set(component viewer)
  endif()
  install(TARGETS ${name} RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT ${component})
  set_property(GLOBAL APPEND PROPERTY V2VOUCH_PROGRAMS_${component} ${name})
endfunction()

# Man pages and completions, made from what each program answers to --help.
function(v2vouch_install_manuals)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  foreach(component programs viewer)
    get_property(programs GLOBAL PROPERTY V2VOUCH_PROGRAMS_${component})
    if(NOT programs)
      continue()
    endif()
    set(out "${PROJECT_BINARY_DIR}/packaging/manuals_${component}")
    set(files "")
    foreach(program ${programs})
      list(APPEND files $<TARGET_FILE:${program}>)
    endforeach()
    add_custom_command(OUTPUT "${out}/stamp"
      COMMAND ${CMAKE_COMMAND} -E rm -rf "${out}"
      COMMAND ${Python3_EXECUTABLE} "${PROJECT_SOURCE_DIR}/scripts/manual_pages" "${out}" ${files}
      COMMAND ${CMAKE_COMMAND} -E touch "${out}/stamp"
      DEPENDS ${programs} "${PROJECT_SOURCE_DIR}/scripts/manual_pages"
      COMMENT "man pages and completions of ${component}" VERBATIM)
    add_custom_target(v2vouch_manuals_${component} ALL DEPENDS "${out}/stamp")
    install(DIRECTORY "${out}/man/" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT ${component})
    install(DIRECTORY "${out}/bash/"
      DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT ${component})
    install(DIRECTORY "${out}/zsh/"
      DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions" COMPONENT ${component})
  endforeach()
endfunction()

# The service with its settings. Under the prefix /usr the system's own places are meant (/etc).
function(v2vouch_install_service)
  set(V2VOUCH_SYSCONFDIR "${CMAKE_INSTALL_FULL_SYSCONFDIR}")
  set(etc "${CMAKE_INSTALL_SYSCONFDIR}")
  if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
    set(etc /etc)
  endif()
  set(templates "${PROJECT_SOURCE_DIR}/scripts/packaging")
  set(generated "${PROJECT_BINARY_DIR}/packaging")
  configure_file("${templates}/v2vouchd.service.in" "${generated}/v2vouchd.service" @ONLY)
  install(FILES "${generated}/v2vouchd.service" DESTINATION lib/systemd/system COMPONENT programs)
  install(FILES "${templates}/60-v2vouch.conf" DESTINATION lib/sysctl.d COMPONENT programs)
  install(FILES "${templates}/v2vouchd.default" DESTINATION "${etc}/default" RENAME v2vouchd
    COMPONENT programs)
  install(FILES daemon/vehicles/vehicle.yaml DESTINATION "${etc}/v2vouch" COMPONENT programs)
  install(FILES "${templates}/v2vouch.nft"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/v2vouch/examples" COMPONENT programs)
endfunction()

# The files that programs look for, installed, and as links for the programs of the build tree.
function(v2vouch_install_shared_files)
  set(left ${V2VOUCH_SHIPPED})
  file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/share/v2vouch")
  while(left)
    list(POP_FRONT left name folder)
    file(CREATE_LINK "${PROJECT_SOURCE_DIR}/${folder}"
      "${PROJECT_BINARY_DIR}/share/v2vouch/${name}" SYMBOLIC)
    set(component programs)
    if(name STREQUAL lcmtypes)
      set(component dev)
    endif()
    install(DIRECTORY "${folder}/" DESTINATION "${CMAKE_INSTALL_DATADIR}/v2vouch/${name}"
      COMPONENT ${component} FILES_MATCHING PATTERN "*.yaml" PATTERN "*.lcm")
  endwhile()
endfunction()

# Examples, and the message classes that those in Python use: ready-made, so that Python alone suffices.
function(v2vouch_install_examples)
  get_target_property(files v2vouch_lcmtypes_headers V2VOUCH_LCM_FILES)
  set(out "${PROJECT_BINARY_DIR}/packaging/python")
  add_custom_command(OUTPUT "${out}/stamp"
    COMMAND ${CMAKE_COMMAND} -E rm -rf "${out}"
    COMMAND ${CMAKE_COMMAND} -E make_directory "${out}"
    COMMAND "${LCM_GEN}" --python --ppath "${out}" ${files}
    COMMAND ${CMAKE_COMMAND} -E touch "${out}/stamp"
    DEPENDS ${files} COMMENT "lcm-gen --python" VERBATIM)
  add_custom_target(v2vouch_python_types ALL DEPENDS "${out}/stamp")
  install(DIRECTORY "${out}/v2vouch" DESTINATION "${CMAKE_INSTALL_DATADIR}/v2vouch/python"
    COMPONENT programs FILES_MATCHING PATTERN "*.py")
  install(DIRECTORY examples/ DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/v2vouch/examples"
    COMPONENT programs
    FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ
    PATTERN "__pycache__" EXCLUDE)
endfunction()

# Headers of the message types; the wire library (bytes to plain structs in SI units, hostile bytes
# refused) with the rooms it stands on, as one archive; CMake package and pkg-config files.
function(v2vouch_install_development_files)
  install(DIRECTORY "${PROJECT_BINARY_DIR}/lcmtypes/include/v2vouch"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT dev FILES_MATCHING PATTERN "*.hpp")
  set(objects "")
  foreach(room base geodesy data wire)
    list(APPEND objects $<TARGET_OBJECTS:v2vouch_${room}>)
  endforeach()
  add_library(v2vouch_wire_archive STATIC ${objects})
  set_target_properties(v2vouch_wire_archive PROPERTIES OUTPUT_NAME v2vouch-wire LINKER_LANGUAGE CXX)
  install(TARGETS v2vouch_wire_archive ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT dev)
  foreach(folder common/base common/frames common/geodesy common/data rim/wire)
    install(DIRECTORY "daemon/${folder}/"
      DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/v2vouch-wire/daemon/${folder}" COMPONENT dev
      FILES_MATCHING PATTERN "*.h")
  endforeach()
  set(generated "${PROJECT_BINARY_DIR}/packaging")
  set(packages "${CMAKE_INSTALL_LIBDIR}/cmake/v2vouch")
  set(templates "${PROJECT_SOURCE_DIR}/scripts/packaging")
  configure_package_config_file("${templates}/v2vouchConfig.cmake.in"
    "${generated}/v2vouchConfig.cmake" INSTALL_DESTINATION "${packages}"
    PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_DATADIR
    NO_CHECK_REQUIRED_COMPONENTS_MACRO)
  write_basic_package_version_file("${generated}/v2vouchConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
  install(FILES "${generated}/v2vouchConfig.cmake" "${generated}/v2vouchConfigVersion.cmake"
    DESTINATION "${packages}" COMPONENT dev)
  # Relative, so that --prefix and DESTDIR at install time are no lie.
  file(RELATIVE_PATH V2VOUCH_UP_TO_PREFIX "/p/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/p")
  foreach(name v2vouch v2vouch-wire)
    configure_file("${templates}/${name}.pc.in" "${generated}/${name}.pc" @ONLY)
    install(FILES "${generated}/${name}.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
      COMPONENT dev)
  endforeach()
endfunction()
