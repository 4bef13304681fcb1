# What a program in C needs (docs/c.md), as component `c`: tactus.h, libtactus_c,
# TactusC::tactus_c for find_package(TactusC), and tactus_c for pkg-config.
#
#   cmake --install build/embedded --component c --prefix /usr/local
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/TactusC)
install(TARGETS tactus_c EXPORT TactusC
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT c
  NAMELINK_COMPONENT c)
install(EXPORT TactusC NAMESPACE TactusC:: FILE TactusCConfig.cmake
  DESTINATION ${package} COMPONENT c)
install(FILES ${PROJECT_SOURCE_DIR}/client/c/include/tactus.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT c)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/TactusCConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
file(RELATIVE_PATH TACTUS_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/tactus_c.pc.in ${PROJECT_BINARY_DIR}/tactus_c.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/TactusCConfigVersion.cmake
  DESTINATION ${package} COMPONENT c)
install(FILES ${PROJECT_BINARY_DIR}/tactus_c.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT c)
