function check_raises(id, action)
%CHECK_RAISES Fail the test unless a call raises the error with this id and a message.
%
%   Example:
%      check_raises('roburoc4:closed', @() r.stop())

% SPDX-License-Identifier: MIT
try
    action();
catch problem
    check(strcmp(problem.identifier, id), '%s raised %s (%s), not %s', func2str(action), ...
        problem.identifier, problem.message, id);
    check(numel(problem.message) > 10, '%s: message is too short', func2str(action));
    return
end
error('roburoc4:check', '%s raised nothing, not %s', func2str(action), id);
end
