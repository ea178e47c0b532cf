# SPDX-License-Identifier: MIT
#
# Sets ROBUROC4_GOOGLETEST where a C++ compiler and GoogleTest are there; else says why not.
include(CheckLanguage)
set(ROBUROC4_GOOGLETEST OFF)
# A compiler that was missing may have been installed since.
if(NOT CMAKE_CXX_COMPILER)
    unset(CMAKE_CXX_COMPILER CACHE)
endif()
check_language(CXX)
if(CMAKE_CXX_COMPILER)
    enable_language(CXX)
    find_package(GTest QUIET)
    if(GTest_FOUND)
        set(ROBUROC4_GOOGLETEST ON)
    else()
        message(STATUS "Tests are off: GoogleTest was not found (Debian: apt-get install libgtest-dev)")
    endif()
else()
    message(STATUS "Tests are off: no C++ compiler was found (Debian: apt-get install g++)")
endif()
