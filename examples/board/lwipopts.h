/* SPDX-License-Identifier: MIT
 *
 * lwIP without an operating system and with UDP only, whose datagrams fit into one frame; all else
 * as it comes.
 */
#define NO_SYS 1
#define SYS_LIGHTWEIGHT_PROT 0 /* lwIP is called from the main loop only */
#define LWIP_SOCKET 0
#define LWIP_NETCONN 0
#define LWIP_TCP 0
#define IP_REASSEMBLY 0
#define IP_FRAG 0
#define LWIP_STATS 0
#define LWIP_NOASSERT 1
