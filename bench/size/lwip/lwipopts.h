/* SPDX-License-Identifier: MIT
 *
 * lwIP as it comes, for a firmware without an operating system, and without the transport that the
 * program does not use.
 */
#define NO_SYS 1
#define SYS_LIGHTWEIGHT_PROT 0
#define LWIP_SOCKET 0
#define LWIP_NETCONN 0
#define LWIP_STATS 0
#define LWIP_NOASSERT 1
#ifdef USES_TCP
#define LWIP_UDP 0
#else
#define LWIP_TCP 0
#endif
