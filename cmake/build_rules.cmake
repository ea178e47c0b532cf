# SPDX-License-Identifier: MIT
#
# How libraries and programs of this project are compiled, in one place: roburoc4_library() and
# roburoc4_program().

include(CheckLinkerFlag)

if(ROBUROC4_SANITIZE)
    add_compile_options(-fsanitize=${ROBUROC4_SANITIZE} -fno-sanitize-recover=all
        -fno-omit-frame-pointer)
    # Only tests are C++, and their own undefined behaviour is not worth a third of their compiler's time.
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fno-sanitize=undefined>)
    add_link_options(-fsanitize=${ROBUROC4_SANITIZE})
endif()

set(roburoc4_warnings)
if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
    set(roburoc4_warnings -Wall -Wextra -Wpedantic -Wconversion)
    # Under a sanitizer gcc sees conversions in the code that the sanitizer adds.
    if(ROBUROC4_WERROR AND NOT (ROBUROC4_SANITIZE AND CMAKE_C_COMPILER_ID STREQUAL "GNU"))
        list(APPEND roburoc4_warnings -Werror)
    endif()
elseif(MSVC)
    set(roburoc4_warnings /W4)
    if(ROBUROC4_WERROR)
        list(APPEND roburoc4_warnings /WX)
    endif()
endif()

set(roburoc4_map "${PROJECT_BINARY_DIR}/roburoc4.map")
configure_file(cmake/roburoc4.map.in "${roburoc4_map}" @ONLY)
set(roburoc4_version_script "-Wl,--version-script=${roburoc4_map}")
if(WIN32 OR APPLE)
    set(ROBUROC4_HAS_VERSION_SCRIPT OFF)
else()
    check_linker_flag(C "${roburoc4_version_script}" ROBUROC4_HAS_VERSION_SCRIPT)
endif()

# What libraries and programs have in common.
function(roburoc4_compile target)
    set_target_properties(${target} PROPERTIES
        C_STANDARD 99
        C_STANDARD_REQUIRED ON
        C_EXTENSIONS OFF
        C_VISIBILITY_PRESET hidden)
    target_compile_options(${target} PRIVATE ${roburoc4_warnings})
endfunction()

# What a shared library shows: the functions of the headers.
function(roburoc4_export target)
    set(public "__attribute__((visibility(\"default\")))")
    if(WIN32)
        set(public "__declspec(dllexport)")
    endif()
    target_compile_definitions(${target} PRIVATE
        "ROBUROC4_API=${public}" "ROBUROC4_SIM_API=${public}")
    if(ROBUROC4_HAS_VERSION_SCRIPT)
        target_link_options(${target} PRIVATE "${roburoc4_version_script}")
        set_target_properties(${target} PROPERTIES
            LINK_DEPENDS "${roburoc4_map}")
    endif()
endfunction()

# roburoc4_library(NAME SOURCES ... HEADERS ... [USES LIBRARY] [LINK ...] [PKG_PRIVATE ...]
#                  DESCRIPTION ...)
# makes NAME, static or (BUILD_SHARED_LIBS) shared, its roburoc4:: name, install rules and a
# pkg-config file. USES is another library of this project, LINK what the system has to give,
# PKG_PRIVATE the same for pkg-config.
function(roburoc4_library name)
    cmake_parse_arguments(PARSE_ARGV 1 lib "" "USES;DESCRIPTION"
        "SOURCES;HEADERS;LINK;PKG_PRIVATE")

    string(REGEX REPLACE "^roburoc4_" "" export_name ${name})
    add_library(${name} ${lib_SOURCES})
    add_library(roburoc4::${export_name} ALIAS ${name})
    roburoc4_compile(${name})
    target_include_directories(${name} PUBLIC
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    # Bindings put the static libraries into modules of their own.
    set_target_properties(${name} PROPERTIES
        POSITION_INDEPENDENT_CODE ON
        EXPORT_NAME ${export_name}
        VERSION ${PROJECT_VERSION}
        SOVERSION ${ROBUROC4_ABI_VERSION})
    if(BUILD_SHARED_LIBS)
        roburoc4_export(${name})
    endif()

    set(requires)
    if(lib_USES)
        target_link_libraries(${name} PUBLIC ${lib_USES})
        string(REPLACE "_" "-" requires "${lib_USES}")
    endif()
    target_link_libraries(${name} PRIVATE ${lib_LINK})

    if(ROBUROC4_INSTALL)
        install(TARGETS ${name} EXPORT roburoc4
            RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
            LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_COMPONENT Development
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT Development)
        foreach(header IN LISTS lib_HEADERS)
            install(FILES ${PROJECT_SOURCE_DIR}/include/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
                COMPONENT Development)
        endforeach()
        roburoc4_pkg_config(${name} "${requires}" "${lib_DESCRIPTION}" "${lib_PKG_PRIVATE}")
    endif()
endfunction()

# PC_LIBDIR and PC_INCLUDEDIR of a pkg-config file: they start from its own place, so that an
# installed tree can be moved.
macro(roburoc4_pkg_paths)
    set(PC_LIBDIR "${CMAKE_INSTALL_FULL_LIBDIR}")
    set(PC_INCLUDEDIR "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
    if(NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" AND NOT IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
        file(RELATIVE_PATH up "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
        set(PC_LIBDIR "\${pcfiledir}/${up}${CMAKE_INSTALL_LIBDIR}")
        set(PC_INCLUDEDIR "\${pcfiledir}/${up}${CMAKE_INSTALL_INCLUDEDIR}")
    endif()
endmacro()

# The pkg-config file of a library.
function(roburoc4_pkg_config name PC_REQUIRES PC_DESCRIPTION PC_PRIVATE)
    set(PC_LIBRARY ${name})
    string(REPLACE "_" "-" PC_NAME ${name})
    string(REPLACE ";" " " PC_PRIVATE "${PC_PRIVATE}")
    set(PC_PUBLIC)
    if(NOT BUILD_SHARED_LIBS) # who links a static library has to name what it needs
        set(PC_PUBLIC " ${PC_PRIVATE}")
    endif()
    roburoc4_pkg_paths()
    configure_file(${PROJECT_SOURCE_DIR}/cmake/roburoc4.pc.in
        ${PROJECT_BINARY_DIR}/${PC_NAME}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${PC_NAME}.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT Development)
endfunction()

# roburoc4_program(NAME SOURCES ... LINK ...): with static libraries it can be copied alone.
function(roburoc4_program name)
    cmake_parse_arguments(PARSE_ARGV 1 program "" "" "SOURCES;LINK")
    add_executable(${name} ${program_SOURCES})
    roburoc4_compile(${name})
    target_link_libraries(${name} PRIVATE ${program_LINK})
endfunction()
