# SPDX-License-Identifier: MIT
#
# Install rules of the LCM bridge; part of lcm/CMakeLists.txt.

install(TARGETS roburoc4-lcm RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES ${PROJECT_SOURCE_DIR}/docs/man/roburoc4-lcm.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
# In the usual place and form of LCM packages: share/lcmtypes/PACKAGE_TYPE.lcm.
foreach(type IN LISTS types)
    cmake_path(GET type FILENAME name)
    install(FILES ${type} DESTINATION ${CMAKE_INSTALL_DATADIR}/lcmtypes RENAME roburoc4_lcm_${name})
endforeach()
install(DIRECTORY deploy/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/lcm)

# The types for C: a static library, since LCM's generated code promises no ABI; and for C++.
install(TARGETS roburoc4_lcm_types EXPORT roburoc4
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT Development)
install(DIRECTORY ${generated}/roburoc4_lcm/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/roburoc4_lcm
    COMPONENT Development FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
roburoc4_pkg_paths()
# An LCM outside of the system's folders, as pip's.
cmake_path(GET ROBUROC4_LCM_LIBRARY PARENT_PATH lcm_folder)
set(PC_LCM "-llcm")
if(NOT lcm_folder IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
    set(PC_LCM "-L${lcm_folder} -Wl,-rpath,${lcm_folder} -llcm")
endif()
set(PC_LCM_INCLUDE "")
if(NOT ROBUROC4_LCM_INCLUDE IN_LIST CMAKE_C_IMPLICIT_INCLUDE_DIRECTORIES)
    set(PC_LCM_INCLUDE "-I${ROBUROC4_LCM_INCLUDE}")
endif()
configure_file(roburoc4-lcm.pc.in roburoc4-lcm.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/roburoc4-lcm.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT Development)

# For Python: generated once by LCM 1.5 and kept, since 1.3.1's generator writes for Python 2.
find_program(ROBUROC4_LCM_PYTHON NAMES python3 python)
set(python_folder lib/python3/site-packages)
if(ROBUROC4_LCM_PYTHON)
    execute_process(
        COMMAND ${ROBUROC4_LCM_PYTHON} -c
            "import sysconfig as s; print(s.get_path('purelib', vars={'base': ''}).lstrip('/'))"
        OUTPUT_VARIABLE python_folder OUTPUT_STRIP_TRAILING_WHITESPACE)
    string(REGEX REPLACE "^local/" "" python_folder "${python_folder}")
endif()
set(ROBUROC4_PYTHON_DIR "${python_folder}" CACHE STRING
    "Where the Python package roburoc4_lcm is installed, below the prefix")
include(${PROJECT_SOURCE_DIR}/cmake/lcm_python.cmake)
roburoc4_lcm_python(${ROBUROC4_LCM_GEN} ${CMAKE_CURRENT_SOURCE_DIR}/types ${CMAKE_CURRENT_BINARY_DIR}/python)
install(DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/python/roburoc4_lcm DESTINATION ${ROBUROC4_PYTHON_DIR}
    FILES_MATCHING PATTERN "*.py")

# For Java, and with it MATLAB and lcm-spy, where there is a JDK and LCM's own jar.
if(TARGET roburoc4_lcm_jar)
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/lcmtypes_roburoc4.jar
        DESTINATION ${CMAKE_INSTALL_DATADIR}/java)
endif()
