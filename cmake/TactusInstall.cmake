# What a robot's program needs from an installed Tactus: the library
# Tactus::client, its headers and the protos. With a real skin also
# Tactus::client_skins, and for USB adapters Tactus::client_gs_usb (libusb).
#
#   cmake --install build/release --component client --prefix /usr/local
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(headers ${CMAKE_INSTALL_INCLUDEDIR}/tactus)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Tactus)

set(libraries tactus_proto tactus_proto_grpc tactus_core_base tactus_core_skin
    tactus_client tactus_client_can tactus_client_gs_usb tactus_client_serial
    tactus_client_skins)
foreach(library ${libraries})
  string(REPLACE "tactus_" "" name ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${library} SYSTEM
    PUBLIC $<INSTALL_INTERFACE:${headers}>)
endforeach()
target_compile_features(tactus_client PUBLIC cxx_std_20)

install(TARGETS ${libraries} EXPORT TactusTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT client)
install(EXPORT TactusTargets NAMESPACE Tactus::
  DESTINATION ${package} COMPONENT client)
configure_package_config_file(cmake/TactusConfig.cmake.in
  ${PROJECT_BINARY_DIR}/TactusConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/TactusConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/TactusConfig.cmake
              ${PROJECT_BINARY_DIR}/TactusConfigVersion.cmake
  DESTINATION ${package} COMPONENT client)

foreach(folder client/stream client/drivers client/drivers/can
    client/drivers/icub_skin client/drivers/serial client/drivers/xela core/base
    core/features core/skin)
  file(GLOB public RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
    ${PROJECT_SOURCE_DIR}/${folder}/*.h)
  # The other drivers need trial files and the simulator.
  list(FILTER public EXCLUDE REGEX "(replay|sim|trial)_driver.h")
  install(FILES ${public} DESTINATION ${headers}/${folder} COMPONENT client)
endforeach()
install(DIRECTORY ${PROJECT_BINARY_DIR}/generated/tactus
  DESTINATION ${headers} COMPONENT client FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/proto/tactus
  DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus/proto COMPONENT client
  FILES_MATCHING PATTERN "*.proto")
