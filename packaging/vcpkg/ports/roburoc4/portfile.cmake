# The archive of this release, beside the recipes, until it has an address:
# vcpkg install roburoc4 --overlay-ports=build/release/recipes/vcpkg/ports
set(archive "${CURRENT_PORT_DIR}/../../../../roburoc4-source-${VERSION}.tar.gz")
file(SHA512 "${archive}" sum)
if(NOT sum STREQUAL "@SHA512@")
    message(FATAL_ERROR "${archive} is not the archive that this port was made for")
endif()
vcpkg_extract_source_archive(SOURCE_PATH ARCHIVE "${archive}")
vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}"
    OPTIONS -DROBUROC4_EXAMPLES=OFF -DROBUROC4_MATLAB=OFF -DROBUROC4_WITH_LCM=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/roburoc4)
vcpkg_fixup_pkgconfig()
vcpkg_copy_tools(TOOL_NAMES roburoc4-sim AUTO_CLEAN)
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share"
    "${CURRENT_PACKAGES_DIR}/lib/wireshark" "${CURRENT_PACKAGES_DIR}/debug/lib/wireshark"
    "${CURRENT_PACKAGES_DIR}/share/man" "${CURRENT_PACKAGES_DIR}/share/doc")
file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
