/* SPDX-License-Identifier: MIT
 *
 * What lwIP asks of a compiler and a board: nothing is printed.
 */
#define LWIP_PLATFORM_DIAG(message)
#define LWIP_PLATFORM_ASSERT(message)
