function needed(enough, call)
%NEEDED Say what a call needs, unless it has that.
%   roburoc4.internal.needed(ENOUGH, CALL) raises roburoc4:badArgument with the text CALL where
%   ENOUGH is false.
%
%   Example:
%      roburoc4.internal.needed(nargin == 2, 'spin(seconds)')
%
%   See also roburoc4.internal.number.

% SPDX-License-Identifier: MIT
if ~enough
    error('roburoc4:badArgument', 'needed: %s', call);
end
end
