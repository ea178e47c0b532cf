# SPDX-License-Identifier: MIT
"""The operator station in a browser: part of the extra `dashboard`, started by its command.

guard     checks Host, Origin and token of requests; headers of every answer
app       the page, its files and its WebSocket
hub       the open pages, and when they get a frame
frames    the robot's state as one document for each frame
advice    what is wrong with the link, why the robot is not armed, and what to try
messages  what a page may send, checked
control   who drives, and which inputs count: with going, the only file that moves the robot
going     a move to a place of the map
history   what a page that opens later still shows
panel     the simulator's panel
server    the socket, TLS, and the end
"""
