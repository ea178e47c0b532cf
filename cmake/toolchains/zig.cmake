# SPDX-License-Identifier: MIT
#
# Toolchain: programs for musl or macOS, by the compiler in the wheel "ziglang":
#
#     cmake --toolchain cmake/toolchains/zig.cmake -DROBUROC4_ZIG=FOLDER-OF-THE-WRAPPERS
#           -DROBUROC4_ZIG_SYSTEM=Linux|Darwin -DROBUROC4_ZIG_PROCESSOR=x86_64|aarch64 ...
#
# The folder holds three small programs, cc, ar and ranlib, that call "python3 -m ziglang ..."
# (scripts/test-portability writes them), since CMake wants one command for each.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES
    ROBUROC4_ZIG ROBUROC4_ZIG_SYSTEM ROBUROC4_ZIG_PROCESSOR)
set(CMAKE_SYSTEM_NAME ${ROBUROC4_ZIG_SYSTEM})
set(CMAKE_SYSTEM_PROCESSOR ${ROBUROC4_ZIG_PROCESSOR})
set(CMAKE_C_COMPILER ${ROBUROC4_ZIG}/cc)
set(CMAKE_AR ${ROBUROC4_ZIG}/ar CACHE FILEPATH "")
set(CMAKE_RANLIB ${ROBUROC4_ZIG}/ranlib CACHE FILEPATH "")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
