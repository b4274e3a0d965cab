# Debian packages by component: v2vouch (daemon and tools), v2vouch-view, v2vouch-dev. scripts/package
# makes them; cpack -G DEB in a build tree of the preset `package`.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME v2vouch)
set(CPACK_PACKAGE_VENDOR V2Vouch)
set(V2VOUCH_PACKAGE_CONTACT "V2Vouch <v2vouch@localhost.localdomain>" CACHE STRING
  "Maintainer named in the packages")
set(CPACK_PACKAGE_CONTACT "${V2VOUCH_PACKAGE_CONTACT}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

set(CPACK_COMPONENTS_ALL programs dev)
if(TARGET v2vouch-view)
  list(APPEND CPACK_COMPONENTS_ALL viewer)
endif()

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME v2vouch)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION misc)
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION "vehicle perception with V2V: daemon and tools
Tells a car which vehicles are around it, and which of those it may rely on
even when its own sensors lose sight of them. Radar and camera vouch for a
vehicle that talks by radio; only then may its messages keep it alive.
Messages travel over LCM.")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "v2vouch-view, liblcm-bin, nftables, python3")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_CONTROL_EXTRA
  "${PROJECT_SOURCE_DIR}/scripts/packaging/postinst"
  "${PROJECT_SOURCE_DIR}/scripts/packaging/prerm"
  "${PROJECT_SOURCE_DIR}/scripts/packaging/postrm"
  "${PROJECT_BINARY_DIR}/packaging/conffiles")
file(WRITE "${PROJECT_BINARY_DIR}/packaging/conffiles"
  "/etc/default/v2vouchd\n/etc/v2vouch/vehicle.yaml\n")

set(CPACK_DEBIAN_VIEWER_PACKAGE_NAME v2vouch-view)
set(CPACK_DEBIAN_VIEWER_PACKAGE_SECTION misc)
set(CPACK_COMPONENT_VIEWER_DESCRIPTION "live view of V2Vouch's track lists
A page on a loopback port with the vehicles round the car as V2Vouch's daemon
publishes them, live or from a log.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME v2vouch-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "liblcm-dev, liblcm-bin, libglib2.0-dev, libeigen3-dev, libssl-dev, pkg-config | pkgconf")
set(CPACK_COMPONENT_DEV_DESCRIPTION "message types and wire library of V2Vouch
LCM message types (.lcm files and C++ headers), and the library that turns
message bytes into plain structs and refuses hostile ones. With CMake package
and pkg-config files.")

# What every Debian package has to bring.
configure_file("${PROJECT_SOURCE_DIR}/scripts/packaging/changelog.Debian.in"
  "${PROJECT_BINARY_DIR}/packaging/changelog.Debian" @ONLY)
foreach(pair programs:v2vouch viewer:v2vouch-view dev:v2vouch-dev)
  string(REPLACE ":" ";" pair "${pair}")
  list(GET pair 0 component)
  list(GET pair 1 package)
  set(doc "${CMAKE_INSTALL_DATADIR}/doc/${package}")
  install(FILES scripts/packaging/copyright DESTINATION "${doc}" COMPONENT ${component})
  install(CODE "
    set(doc \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${doc}\")
    foreach(pair \"CHANGELOG.md:changelog.gz\" \"changelog.Debian:changelog.Debian.gz\")
      string(REGEX REPLACE \":.*\" \"\" from \"\${pair}\")
      string(REGEX REPLACE \".*:\" \"\" to \"\${pair}\")
      set(place \"${PROJECT_SOURCE_DIR}\")
      if(from STREQUAL \"changelog.Debian\")
        set(place \"${PROJECT_BINARY_DIR}/packaging\")
      endif()
      execute_process(COMMAND gzip -9nc \"\${place}/\${from}\" OUTPUT_FILE \"\${doc}/\${to}\"
        COMMAND_ERROR_IS_FATAL ANY)
      list(APPEND CMAKE_INSTALL_MANIFEST_FILES \"\${CMAKE_INSTALL_PREFIX}/${doc}/\${to}\")
    endforeach()" COMPONENT ${component})
  set(overrides "${PROJECT_SOURCE_DIR}/scripts/packaging/${package}.lintian-overrides")
  if(EXISTS "${overrides}")
    install(FILES "${overrides}" DESTINATION "${CMAKE_INSTALL_DATADIR}/lintian/overrides"
      RENAME ${package} COMPONENT ${component})
  endif()
endforeach()
include(CPack)
