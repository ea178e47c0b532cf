function cleanup = guard(id)
%GUARD Stop a robot when the method that waits is left before its end, as by Ctrl-C.
%   CLEANUP = roburoc4.internal.guard(ID) marks the robot as busy. When CLEANUP goes and the mark
%   is still there, the robot is told to stop, if it was this object that drove it: one that only
%   watches never commands. A method that comes to its end takes the mark away:
%
%   Example:
%      cleanup = roburoc4.internal.guard(id);
%      ...                                               % Ctrl-C here stops the robot
%      roburoc4.internal.roburoc4_mex('busy', id, false);
%
%   See also onCleanup.

% SPDX-License-Identifier: MIT
roburoc4.internal.roburoc4_mex('busy', id, true);
cleanup = onCleanup(@() roburoc4.internal.roburoc4_mex('interrupted', id));
end
