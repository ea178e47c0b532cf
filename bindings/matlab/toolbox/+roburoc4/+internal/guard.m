function cleanup = guard(id)
%GUARD Stop a robot when a waiting method ends early, for example by Ctrl-C.
%   CLEANUP = roburoc4.internal.guard(ID) marks the robot as busy. If it is still marked when CLEANUP
%   is cleared, the robot is stopped, but only if this object drives it: one that only reads never
%   commands. A method that reaches its end removes the mark:
%
%   Example:
%      cleanup = roburoc4.internal.guard(id);
%      ...                                               % Ctrl-C here stops the robot
%      roburoc4_mex('busy', id, false);
%
%   See also onCleanup.

% SPDX-License-Identifier: MIT
roburoc4_mex('busy', id, true);
cleanup = onCleanup(@() roburoc4_mex('interrupted', id));
end
