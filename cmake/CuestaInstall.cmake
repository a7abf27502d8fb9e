# cmake --install: the module libraries with their headers, a package for find_package(cuesta).
# The program installs itself (apps/cuesta).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cuesta)

foreach(module ooc hierarchy runtime draw terrain)
  if(TARGET cuesta_${module})
    install(TARGETS cuesta_${module} EXPORT cuesta-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  endif()
endforeach()
foreach(folder ooc hierarchy runtime terrain)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/cuesta FILES_MATCHING PATTERN "*.h")
endforeach()

install(EXPORT cuesta-targets NAMESPACE cuesta:: DESTINATION ${package_dir})
configure_package_config_file(cmake/cuesta-config.cmake.in ${PROJECT_BINARY_DIR}/cuesta-config.cmake
  INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cuesta-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/CuestaOpenVDB.cmake ${PROJECT_BINARY_DIR}/cuesta-config.cmake ${PROJECT_BINARY_DIR}/cuesta-config-version.cmake
  DESTINATION ${package_dir})

# The page that `cuesta serve` shows, and the package that it is made of.
if(CUESTA_WEB)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/web/page/ DESTINATION ${CMAKE_INSTALL_DATADIR}/cuesta/web)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/web/client/ DESTINATION ${CMAKE_INSTALL_DATADIR}/cuesta/client)
endif()
