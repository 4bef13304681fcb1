# What a robot's program needs from an installed Tactus (docs/api.md): the
# component
#
#   base        the headers of client/include/tactus, the protos, and what the
#               others share
#
# and of these one or more:
#
#   client      Tactus::client: a server answers
#   classifier  Tactus::classifier: this process answers; needs no gRPC
#   drivers     Tactus::drivers: skins, simulated, recorded and real; needs
#               HDF5 and libusb, and no gRPC
#
#   cmake --install build/release --component base --prefix /usr/local
#   cmake --install build/release --component client --prefix /usr/local
#
# The libraries behind these are installed as Tactus::internal_NAME; they have no
# headers there, and no program names them.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Tactus)
set(components client classifier drivers)

# tactus_libraries_of(TARGET RESULT): TARGET and all of our libraries that it
# links.
function(tactus_libraries_of target result)
  set(found ${target})
  set(waiting ${target})
  while(waiting)
    list(POP_FRONT waiting next)
    get_target_property(links ${next} INTERFACE_LINK_LIBRARIES)
    foreach(link ${links})
      if(link MATCHES "^tactus_" AND NOT link IN_LIST found)
        list(APPEND found ${link})
        list(APPEND waiting ${link})
      endif()
    endforeach()
  endwhile()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# Each library is of one of these sets: `base`, which all components need,
# `shared`, which classifier and drivers need, and those of the components.
tactus_libraries_of(tactus_front base_libraries)
tactus_libraries_of(tactus_front_client client_libraries)
tactus_libraries_of(tactus_front_classifier classifier_libraries)
tactus_libraries_of(tactus_front_drivers drivers_libraries)
foreach(component ${components})
  list(REMOVE_ITEM ${component}_libraries ${base_libraries})
endforeach()
set(shared_libraries ${classifier_libraries})
list(REMOVE_ITEM shared_libraries tactus_front_classifier)
set(classifier_libraries tactus_front_classifier)
list(REMOVE_ITEM drivers_libraries ${shared_libraries})

foreach(set base shared ${components})
  foreach(library ${${set}_libraries})
    string(REPLACE "tactus_" "internal_" name ${library})
    set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
  endforeach()
endforeach()
set_target_properties(tactus_headers PROPERTIES EXPORT_NAME headers)
foreach(component ${components})
  set_target_properties(tactus_front_${component} PROPERTIES
    EXPORT_NAME ${component})
endforeach()
target_include_directories(tactus_headers SYSTEM
  INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(tactus_headers INTERFACE cxx_std_20)

foreach(set base shared ${components})
  set(component ${set})
  if(set STREQUAL "shared")
    set(component base)
  endif()
  install(TARGETS ${${set}_libraries} EXPORT Tactus_${set}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component})
  install(EXPORT Tactus_${set} NAMESPACE Tactus:: FILE Tactus_${set}.cmake
    DESTINATION ${package} COMPONENT ${component})
endforeach()

configure_package_config_file(cmake/TactusConfig.cmake.in
  ${PROJECT_BINARY_DIR}/TactusConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/TactusConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/TactusConfig.cmake
              ${PROJECT_BINARY_DIR}/TactusConfigVersion.cmake
  DESTINATION ${package} COMPONENT base)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/client/include/tactus
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT base
  FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/proto/tactus
  DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus/proto COMPONENT base
  FILES_MATCHING PATTERN "*.proto")

# All that base and client install, for builds that need nothing else.
add_custom_target(tactus_component_client
  DEPENDS ${base_libraries} ${shared_libraries} ${client_libraries})
