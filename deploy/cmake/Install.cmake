# What `cmake --install` brings to a machine:
#
#   programs     the programs, the units that start them, the limits that the host should have, the
#                guide and the files of the example laboratory, manual pages, completion for shells
#   development  headers, static libraries, CMake package and pkg-config files, the contract (IDL)
#
# `cmake --install build --prefix DIR [--component development]`: paths inside installed files are
# those of DIR. What was installed stands in build/install_manifest.txt.
include(CMakePackageConfigHelpers)

set(data ${CMAKE_INSTALL_DATADIR}/dyncal)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/dyncal)
set(made ${CMAKE_BINARY_DIR}/installed)

# Programs.
install(TARGETS
    dyncal
    dyncal-acs
    dyncal-analysis
    dyncal-can
    dyncal-dau
    dyncal-dso
    dyncal-guard
    dyncal-recorder
    dyncal-virtual-bench
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
if(TARGET dyncal-web)
  install(TARGETS dyncal-web RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
endif()
install(FILES deploy/sysctl/60-dyncal.conf DESTINATION lib/sysctl.d COMPONENT programs)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs)
install(DIRECTORY deploy/example-lab DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs)
if(DYNCAL_GUIDE_FOLDER)
  install(DIRECTORY ${DYNCAL_GUIDE_FOLDER} DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs)
endif()
install(FILES services/views/model/model.schema.json services/views/report/result.schema.json
  DESTINATION ${data} COMPONENT programs)
# The schema of certificates, under licences of its own.
install(DIRECTORY deploy/third-party/dcc DESTINATION ${data} COMPONENT programs)
install(CODE "
  set(root \"${PROJECT_SOURCE_DIR}\")
  set(made \"${made}\")
  set(bindir \"${CMAKE_INSTALL_BINDIR}\")"
  COMPONENT programs)
install(SCRIPT deploy/cmake/InstallUnits.cmake COMPONENT programs)
include(InstallDescriptions)

# Libraries: one export set for each component of find_package(dyncal).
set(exported analysis bus)
install(TARGETS dyncal_analysis EXPORT dyncal-analysis
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(TARGETS dyncal_idl dyncal_contract dyncal_bus EXPORT dyncal-bus
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
if(DYNCAL_MODELS)
  list(APPEND exported models)
  install(TARGETS dyncal_analysis_models EXPORT dyncal-models
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
endif()
foreach(component IN LISTS exported)
  install(EXPORT dyncal-${component}
    NAMESPACE dyncal::
    FILE dyncal-${component}-targets.cmake
    DESTINATION ${package}
    COMPONENT development)
endforeach()

set(bus_packages fmt OpenSSL tl-expected ZLIB)
set(bus_modules fmt libcrypto zlib)
set(bus_libs)
if(DYNCAL_FAST_DDS)
  list(APPEND bus_packages ${DYNCAL_FAST_DDS_LIBRARY})
  list(APPEND bus_libs -l${DYNCAL_FAST_DDS_LIBRARY})
endif()
if(DYNCAL_CYCLONE_DDS)
  list(APPEND bus_packages CycloneDDS)
  list(APPEND bus_modules CycloneDDS)
endif()
list(JOIN bus_modules " " bus_modules)
list(JOIN bus_libs " " bus_libs)
configure_package_config_file(deploy/cmake/dyncalConfig.cmake.in ${made}/dyncalConfig.cmake
  INSTALL_DESTINATION ${package}
  NO_SET_AND_CHECK_MACRO)
# Until 1.0 a minor version may break what was.
write_basic_package_version_file(${made}/dyncalConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${made}/dyncalConfig.cmake ${made}/dyncalConfigVersion.cmake
  DESTINATION ${package} COMPONENT development)

# The prefix is found from where the file is, so that the whole may be moved.
file(RELATIVE_PATH prefix_from_pc /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
string(REGEX REPLACE "/$" "" prefix_from_pc ${prefix_from_pc})
foreach(component analysis bus)
  configure_file(deploy/cmake/dyncal-${component}.pc.in ${made}/dyncal-${component}.pc @ONLY)
  install(FILES ${made}/dyncal-${component}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endforeach()

# Headers, the contract, and how another DDS tool reads it.
install(CODE "
  set(root \"${PROJECT_SOURCE_DIR}\")
  set(generated \"${CMAKE_BINARY_DIR}/generated\")
  set(made \"${made}\")
  set(includedir \"${CMAKE_INSTALL_INCLUDEDIR}\")"
  COMPONENT development)
install(SCRIPT deploy/cmake/InstallHeaders.cmake COMPONENT development)
install(FILES idl/dyncal.idl DESTINATION ${data}/idl COMPONENT development)
install(DIRECTORY idl/profiles DESTINATION ${data}/idl COMPONENT development)
