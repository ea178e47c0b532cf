function needed(enough, call)
%NEEDED Raise an error that shows the call's arguments, unless they are there.
%   roburoc4.internal.needed(ENOUGH, CALL) raises roburoc4:badArgument with the text CALL if ENOUGH
%   is false.
%
%   Example:
%      roburoc4.internal.needed(nargin == 2, 'sleep(seconds)')
%
%   See also roburoc4.internal.number.

% SPDX-License-Identifier: MIT
if ~enough
    error('roburoc4:badArgument', 'arguments are missing or of the wrong kind; give %s', call);
end
end
