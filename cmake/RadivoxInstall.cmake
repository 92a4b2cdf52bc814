# `cmake --install` gives a relocatable package: find_package(radivox COMPONENTS …). Whoever makes a target says one line:
#
#   radivox_component(NAME TARGET t [HEADERS folder…] [NEEDS component…] [PACKAGES "embree 3"…])   radivox::NAME; packages are found for it
#   radivox_missing_component(NAME "why, and the mend")                                            an optional one that this build lacks
#
# and the top CMakeLists ends with radivox_install(), which writes the package. Headers that say "Private to" or "Internal to" in their
# first lines stay at home.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(RADIVOX_PACKAGE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/radivox)

function(radivox_component name)
  cmake_parse_arguments(PARSE_ARGV 1 component "" "TARGET" "HEADERS;NEEDS;PACKAGES")
  set_target_properties(${component_TARGET} PROPERTIES EXPORT_NAME ${name})
  get_target_property(type ${component_TARGET} TYPE)
  if(type STREQUAL STATIC_LIBRARY)
    target_compile_features(${component_TARGET} INTERFACE cxx_std_20)
  endif()
  if(RADIVOX_INSTALL)
    install(TARGETS ${component_TARGET} EXPORT radivox_${name}
      ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
      PUBLIC_HEADER DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/radivox)
    install(EXPORT radivox_${name} NAMESPACE radivox:: FILE radivox_${name}.cmake DESTINATION ${RADIVOX_PACKAGE_FOLDER})
    foreach(folder ${component_HEADERS})
      radivox_install_headers(${folder})
    endforeach()
  endif()
  list(JOIN component_NEEDS " " needs)
  list(TRANSFORM component_PACKAGES REPLACE "(.+)" "\"\\1\"")
  list(JOIN component_PACKAGES " " packages)
  set_property(GLOBAL APPEND PROPERTY radivox_components ${name})
  set_property(GLOBAL APPEND_STRING PROPERTY radivox_component_lines
    "set(_radivox_needs_${name} ${needs})\nset(_radivox_packages_${name} ${packages})\n")
endfunction()

function(radivox_missing_component name why)
  set_property(GLOBAL APPEND PROPERTY radivox_missing_components ${name})
  set_property(GLOBAL APPEND_STRING PROPERTY radivox_component_lines "set(_radivox_why_${name} \"${why}\")\n")
endfunction()

# radivox_install_headers(FOLDER): every public header under FOLDER (relative to the project), as #include "FOLDER/…" finds it.
function(radivox_install_headers folder)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/${folder}/*.h)
  foreach(header ${headers})
    file(READ ${PROJECT_SOURCE_DIR}/${header} text LIMIT 500)
    if(text MATCHES "(Private|Internal) to")
      continue()
    endif()
    get_filename_component(to ${header} DIRECTORY)
    install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/radivox/${to})
  endforeach()
endfunction()

function(radivox_install)
  if(NOT RADIVOX_INSTALL)
    return()
  endif()
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/radivox
    FILES_MATCHING PATTERN "*.h" REGEX "/shared/.*\\.glsl$")
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/samples/graphs ${PROJECT_SOURCE_DIR}/samples/presets DESTINATION ${CMAKE_INSTALL_DATADIR}/radivox)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/radivox)
  get_property(RADIVOX_COMPONENTS GLOBAL PROPERTY radivox_components)
  get_property(RADIVOX_MISSING_COMPONENTS GLOBAL PROPERTY radivox_missing_components)
  get_property(RADIVOX_COMPONENT_LINES GLOBAL PROPERTY radivox_component_lines)
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/package)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/radivoxConfig.cmake.in ${generated}/radivoxConfig.cmake
    INSTALL_DESTINATION ${RADIVOX_PACKAGE_FOLDER} PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_DATADIR)
  write_basic_package_version_file(${generated}/radivoxConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${generated}/radivoxConfig.cmake ${generated}/radivoxConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/cmake/RadivoxModule.cmake ${PROJECT_SOURCE_DIR}/cmake/radivox_module.map DESTINATION ${RADIVOX_PACKAGE_FOLDER})
endfunction()
