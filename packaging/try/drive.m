% drive.m ADDRESS: drive half a metre forward, and fail unless the robot reports that it did.
% SPDX-License-Identifier: MIT
r = roburoc4.Robot(argv(){end}, 'fresh_ms', 1000);
r.arm();
r.move(0.5);
printf('Octave %s, x %.2f m\n', version(), r.pose(1));
assert(abs(r.pose(1) - 0.5) < 0.05);
delete(r);
