# SPDX-License-Identifier: MIT
"""The operator station in a browser: part of the extra `dashboard`, started by its command.

guard     who may ask: Host, Origin, token; what every answer carries
app       the page, its files and its WebSocket
hub       the open pages, and the beat at which they get a new frame
frames    the robot's state as one document for each frame
advice    what is wrong with the link, why the robot is not armed, and what to try
messages  what a page may send, checked
control   who drives, and which inputs count: the only file that moves the robot
history   what a page that opens later still wants to see
panel     the simulator's panel
server    the socket, TLS, and the end
"""
