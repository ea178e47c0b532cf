# SPDX-License-Identifier: MIT
"""refuse.py FILE: write the port of this machine that is listened on to FILE, and answer every
request there with an error, for 30 seconds."""

import pathlib
import socket
import sys
import time

sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sock.bind(("127.0.0.1", 0))
part = pathlib.Path(sys.argv[1] + ".part")
part.write_text(str(sock.getsockname()[1]), encoding="ascii")
part.rename(sys.argv[1])
sock.settimeout(1)
end = time.monotonic() + 30
while time.monotonic() < end:
    try:
        request, peer = sock.recvfrom(2048)
    except OSError:
        continue
    sock.sendto(request[:4] + b"\x02", peer)
