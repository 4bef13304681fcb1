# What a robot's program needs from an installed Tactus: the library
# Tactus::client, its headers and the protos. With a real skin also
# Tactus::client_skins, for USB adapters Tactus::client_gs_usb (libusb), and for
# a skin on a moving arm Tactus::client_kinematics (urdfdom, KDL).
#
#   cmake --install build/release --component client --prefix /usr/local
#
# A program that classifies without a server also needs the component core: the
# library Tactus::core, models and trial files.
#
#   cmake --install build/release --component core --prefix /usr/local
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(headers ${CMAKE_INSTALL_INCLUDEDIR}/tactus)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Tactus)

# What both components need, what the client adds, and what core adds.
set(base_libraries tactus_proto tactus_core_base tactus_core_skin)
set(client_libraries tactus_proto_grpc tactus_client tactus_client_frames
    tactus_client_calibration tactus_client_can tactus_client_gs_usb
    tactus_client_kinematics tactus_client_serial tactus_client_skins)
add_library(tactus_core INTERFACE)
target_link_libraries(tactus_core
  INTERFACE tactus_core_bundle tactus_core_data)
set(core_libraries tactus_core tactus_core_bundle tactus_core_checksum
    tactus_core_classify tactus_core_cues tactus_core_data tactus_core_features
    tactus_core_file_bytes tactus_core_files tactus_core_hmm tactus_core_light_touch
    tactus_core_lstm tactus_core_questions tactus_core_taxels tactus_core_trial)
foreach(library ${base_libraries} ${client_libraries} ${core_libraries})
  string(REPLACE "tactus_" "" name ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
  get_target_property(type ${library} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    target_include_directories(${library} SYSTEM
      PUBLIC $<INSTALL_INTERFACE:${headers}>)
  endif()
endforeach()
target_compile_features(tactus_client PUBLIC cxx_std_20)

target_compile_features(tactus_core INTERFACE cxx_std_20)

# All that the component client installs, for builds that need nothing else.
add_custom_target(tactus_component_client
  DEPENDS ${base_libraries} ${client_libraries})

foreach(part base client core)
  # All that core adds is of its component.
  set(component client)
  if(part STREQUAL "core")
    set(component core)
  endif()
  install(TARGETS ${${part}_libraries} EXPORT Tactus_${part}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component})
  install(EXPORT Tactus_${part} NAMESPACE Tactus::
    FILE Tactus_${part}.cmake
    DESTINATION ${package} COMPONENT ${component})
endforeach()
configure_package_config_file(cmake/TactusConfig.cmake.in
  ${PROJECT_BINARY_DIR}/TactusConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/TactusConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/TactusConfig.cmake
              ${PROJECT_BINARY_DIR}/TactusConfigVersion.cmake
  DESTINATION ${package} COMPONENT client)

# install_headers(COMPONENT folder...)
function(install_headers component)
  foreach(folder ${ARGN})
    file(GLOB public RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
      ${PROJECT_SOURCE_DIR}/${folder}/*.h)
    # The other drivers need trial files and the simulator.
    list(FILTER public EXCLUDE REGEX "(replay|sim|trial)_driver.h")
    install(FILES ${public} DESTINATION ${headers}/${folder}
      COMPONENT ${component})
  endforeach()
endfunction()
install_headers(client client/stream client/drivers client/drivers/calibration client/drivers/can
  client/drivers/icub_skin client/drivers/serial client/drivers/xela
  client/kinematics core/base
  core/features core/skin core/taxels)
install_headers(core core/bundle core/classify core/cues core/data core/files
  core/hmm
  core/light_touch core/lstm core/questions)
install(DIRECTORY ${PROJECT_BINARY_DIR}/generated/tactus
  DESTINATION ${headers} COMPONENT client FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/proto/tactus
  DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus/proto COMPONENT client
  FILES_MATCHING PATTERN "*.proto")
