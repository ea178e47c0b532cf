# SPDX-License-Identifier: MIT
#
# Toolchain: Linux programs for another processor, from Debian's packages gcc-TRIPLE and
# libc6-dev-ARCH-cross:
#
#     cmake --toolchain cmake/toolchains/debian-cross.cmake -DROBUROC4_TRIPLE=s390x-linux-gnu ...
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ROBUROC4_TRIPLE)
set(CMAKE_SYSTEM_NAME Linux)
string(REGEX REPLACE "-.*" "" CMAKE_SYSTEM_PROCESSOR "${ROBUROC4_TRIPLE}")
set(CMAKE_C_COMPILER ${ROBUROC4_TRIPLE}-gcc)
set(CMAKE_FIND_ROOT_PATH /usr/${ROBUROC4_TRIPLE})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
