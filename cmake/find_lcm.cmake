# SPDX-License-Identifier: MIT
#
# Sets ROBUROC4_LCM_FOUND and ROBUROC4_LCM_VERSION, and makes the target roburoc4_lcm_network (LCM's headers and library) and
# ROBUROC4_LCM_GEN (its code generator), all three from one place. Looked for, in this order:
#
#   CMAKE_PREFIX_PATH   the prefix of an LCM, or the folder site-packages that pip installed lcm in
#   python3             where `import lcm` finds PyPI's lcm, which brings all of it
#   the system          Debian: liblcm-dev and liblcm-bin, which are older

function(roburoc4_find_lcm)
    set(hints)
    # A virtual environment may have been activated since the last search found nothing.
    if("${ROBUROC4_LCM_INCLUDE}" STREQUAL "ROBUROC4_LCM_INCLUDE-NOTFOUND")
        unset(ROBUROC4_LCM_PYTHON CACHE)
    endif()
    find_program(ROBUROC4_LCM_PYTHON NAMES python3 python)
    if(ROBUROC4_LCM_PYTHON)
        execute_process(
            COMMAND ${ROBUROC4_LCM_PYTHON} -c
                "import lcm, os; print(os.path.dirname(os.path.dirname(lcm.__file__)))"
            OUTPUT_VARIABLE hints OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    endif()
    find_path(ROBUROC4_LCM_INCLUDE lcm/lcm.h HINTS ${hints}/include)
    if(ROBUROC4_LCM_INCLUDE)
        cmake_path(GET ROBUROC4_LCM_INCLUDE PARENT_PATH prefix)
        foreach(ending "" "/${CMAKE_LIBRARY_ARCHITECTURE}")
            find_library(ROBUROC4_LCM_LIBRARY NAMES lcm PATHS ${prefix}/lib${ending} NO_DEFAULT_PATH)
        endforeach()
        find_library(ROBUROC4_LCM_LIBRARY NAMES lcm)
        find_program(ROBUROC4_LCM_GEN NAMES lcm-gen PATHS ${prefix}/bin NO_DEFAULT_PATH)
        find_program(ROBUROC4_LCM_GEN NAMES lcm-gen)
    endif()
    mark_as_advanced(ROBUROC4_LCM_PYTHON ROBUROC4_LCM_INCLUDE ROBUROC4_LCM_LIBRARY ROBUROC4_LCM_GEN)
    set(ROBUROC4_LCM_FOUND OFF PARENT_SCOPE)
    if(ROBUROC4_LCM_INCLUDE AND ROBUROC4_LCM_LIBRARY AND ROBUROC4_LCM_GEN)
        add_library(roburoc4_lcm_network INTERFACE)
        target_include_directories(roburoc4_lcm_network SYSTEM INTERFACE ${ROBUROC4_LCM_INCLUDE})
        target_link_libraries(roburoc4_lcm_network INTERFACE ${ROBUROC4_LCM_LIBRARY})
        execute_process(COMMAND ${ROBUROC4_LCM_GEN} --version OUTPUT_VARIABLE version ERROR_QUIET)
        string(REGEX MATCH "[0-9]+\\.[0-9.]*[0-9]" version "${version}")
        set(ROBUROC4_LCM_VERSION "${version}" PARENT_SCOPE)
        set(ROBUROC4_LCM_FOUND ON PARENT_SCOPE)
    endif()
endfunction()

set(ROBUROC4_LCM_FOUND OFF)
if(ROBUROC4_WITH_LCM STREQUAL "ON" OR NOT CMAKE_CROSSCOMPILING)
    roburoc4_find_lcm()
endif()
if(ROBUROC4_LCM_FOUND)
    message(STATUS "LCM ${ROBUROC4_LCM_VERSION}: ${ROBUROC4_LCM_LIBRARY}, ${ROBUROC4_LCM_GEN}")
    if(ROBUROC4_LCM_VERSION VERSION_LESS 1.5)
        message(WARNING "LCM ${ROBUROC4_LCM_VERSION} dies of one malformed packet on its network. "
            "On Linux the bridge has such packets dropped, other programs do not. Prefer LCM 1.5: "
            "pip install lcm, and give its site-packages as CMAKE_PREFIX_PATH")
    endif()
elseif(ROBUROC4_WITH_LCM STREQUAL "ON")
    message(FATAL_ERROR "LCM was not found: install it (pip install lcm, and give its "
        "site-packages as CMAKE_PREFIX_PATH; or Debian's liblcm-dev and liblcm-bin), or "
        "configure with -DROBUROC4_WITH_LCM=OFF")
else()
    message(STATUS "The LCM bridge is off: LCM was not found (pip install lcm, beside Debian's libglib2.0-0, or Debian's "
        "liblcm-dev and liblcm-bin)")
endif()
